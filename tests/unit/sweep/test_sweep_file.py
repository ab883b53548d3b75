"""What a sweep file may hold; what it may not is refused with the key, the reason and a way out."""

import pytest

from fem.case.case import CaseError, case_hash
from fem.case.files import SWEEPS
from fem.sweep.file import load_sweep

HEAD = 'case = "seed_stack_plateau"\n[set]\n"solver.model" = "rigid"\n'
PAIR = '"contact.mu_static" = [0.2, 0.3]\n'
FREQUENCY = '"motion.angular_frequency_rad_s" = { from = 2.0, to = 4.0, count = 3 }\n'


@pytest.fixture
def sweep_of(tmp_path):
    def read(body, head=HEAD):
        path = tmp_path / "try.toml"
        path.write_text(head + body, encoding="utf-8")
        return load_sweep(path)

    return read


def test_the_last_axis_is_the_fastest(sweep_of):
    sweep = sweep_of(f'[axes]\n{FREQUENCY}"contact.mu_static" = [0.2, 0.3]\n')
    assert (sweep.shape, sweep.count) == ((3, 2), 6)
    assert [sweep.point(cell)["contact.mu_static"] for cell in range(3)] == [0.2, 0.3, 0.2]
    assert sweep.point(5) == {"motion.angular_frequency_rad_s": 4.0, "contact.mu_static": 0.3}


def test_log_ranges_keep_their_ratio_and_their_ends(sweep_of):
    sweep = sweep_of(
        '[axes]\n"motion.peak_acceleration_m_s2" = { from = 1.0, to = 8.0, count = 4, scale = "log" }\n'
    )
    assert sweep.axes[0].values == pytest.approx((1.0, 2.0, 4.0, 8.0))
    assert sweep.axes[0].values[0] == 1.0 and sweep.axes[0].values[-1] == 8.0


def test_a_cell_is_the_base_with_its_keys_set(sweep_of):
    # The light way of making cases against the long one; an axis on a peak acceleration replaces the amplitude.
    sweep = sweep_of(
        f'[axes]\n{FREQUENCY}"motion.peak_acceleration_m_s2" = [3.0, 5.0]\n"container.boxes" = [2, 4]\n'
        '[derived]\n"contact.mu_kinetic" = "0.5 * contact.mu_static"\n'
    )
    for cell in range(sweep.count):
        case = sweep.case(cell)
        long_way = sweep.base.with_values(sweep.values(sweep.point(cell)) | {"output.fields_s": 0.0})
        assert case == long_way
        assert case.given() == long_way.given()
        assert case_hash(case) == case_hash(long_way)
        assert case.motion.amplitude_m is None


def test_derived_keys_follow_axes_defaults_and_one_another(sweep_of):
    sweep = sweep_of(
        '[axes]\n"contact.mu_static" = [0.2, 0.6]\n"container.height_m" = [1.0, 2.0]\n[derived]\n'
        '"container.centroid_m" = "0.4 * container.height_m"\n'
        '"initial.velocity_m_s" = "2 * container.centroid_m + contact.mu_kinetic"\n'
    )
    # mu_kinetic is given by neither: its default follows mu_static, cell by cell
    assert sweep.base.contact.mu_kinetic == 0.2
    values = sweep.values(sweep.point(3))
    assert values["container.centroid_m"] == pytest.approx(0.8)
    assert values["initial.velocity_m_s"] == pytest.approx(1.6 + 0.2)


def test_a_free_variable_is_an_axis_that_only_derived_keys_know(sweep_of):
    sweep = sweep_of(
        '[axes]\n"free.aspect_ratio" = [3.0, 4.0]\n[derived]\n"container.height_m" = "0.275 * free.aspect_ratio"\n'
    )
    assert sweep.values(sweep.point(1)) == {"container.height_m": pytest.approx(1.1)}
    assert sweep.case(1).container.height_m == pytest.approx(1.1)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (
            f'[axes]\n{FREQUENCY}[derived]\n"container.height_m" = "free.aspect_ratio"\n',
            ["free.aspect_ratio", "is no axis"],
        ),
        ('[axes]\n"contact.mu_statik" = [0.2]\n', ["contact.mu_statik", "did you mean 'mu_static'"]),
        ('[axes]\n"contacts.mu_static" = [0.2]\n', ["names no table", "did you mean 'contact'"]),
        ("[axes]\nmu_static = [0.2]\n", ["write 'contact.mu_static or joints.mu_static or"]),
        ("[axes]\n", ["one to 4 keys, got 0", "for instance"]),
        ('[axes]\n"contact.mu_static" = []\n', ["the list is empty"]),
        ('[axes]\n"contact.mu_static" = { from = 0.2, count = 3 }\n', ["has no 'to'", "a range is"]),
        ('[axes]\n"contact.mu_static" = { from = 0.2, to = 0.4, count = 1 }\n', ["empty range", "[0.2]"]),
        (
            '[axes]\n"contact.mu_static" = { from = 0.2, to = 0.4, count = 3.5 }\n',
            ["count must be a whole number, got 3.5", "a range is"],
        ),
        ('[axes]\n"contact.mu_static" = { from = 0.4, to = 0.2, count = 3 }\n', ["must be less than to"]),
        ('[axes]\n"contact.mu_static" = { from = 0.4, to = 0.4, count = 3 }\n', ["empty range"]),
        (
            '[axes]\n"contact.mu_static" = { from = 0.0, to = 0.4, count = 3, scale = "log" }\n',
            ["through zero on a log scale", 'scale = "linear"'],
        ),
        ('[axes]\n"contact.mu_static" = [0.2, 0.2]\n', ["0.2 twice"]),
        ('[axes]\n"contact.mu_static" = [20]\n', ["between 0 and 5", "per cent: 0.2"]),
        ('[axes]\n"container.boxes" = { from = 1, to = 2, count = 4 }\n', ["whole numbers"]),
        ('[axes]\n"solver.model" = ["rigid", "ful"]\n', ["did you mean 'full'"]),
        ('[axes]\n"output.fields_s" = [0.1, 0.2]\n', ["cannot vary: no fields are kept"]),
        ('[axes]\n"solver.elastic_modes" = [5, 10]\n', ["has no effect"]),
        ('[axes]\n"motion.pulse_s" = [0.5, 1.0]\n', ["has no effect"]),
        ('[axes]\n"contact.mu_kinetic" = [0.2, 0.5]\n', ["at most mu_static", "make this cell"]),
        (f'[axes]\n{FREQUENCY}[derived]\n"contact.mu_kinetic" = "0.5 * contact.mu"\n', ["refers to"]),
        (
            f'[axes]\n{FREQUENCY}[derived]\n"contact.mu_kinetic" = "motion.pulse_s / 2"\n',
            ["refers to 'motion.pulse_s'", "no number"],
        ),
        (
            f'[axes]\n{FREQUENCY}[derived]\n"contact.mu_kinetic" = "contact.mu_kinetic / 2"\n',
            ["refers to itself"],
        ),
        (
            f'[axes]\n{FREQUENCY}[derived]\n"contact.mu_kinetic" = "contact.mu_static / 2"\n'
            '"contact.mu_static" = "2 * contact.mu_kinetic"\n',
            ["refer to one another"],
        ),
        (f'[axes]\n{FREQUENCY}[derived]\n"contact.mu_static" = "__import__(1)"\n', ["no function"]),
        (f'[axes]\n{FREQUENCY}[derived]\n"contact.mu_static" = 0.3\n', ["expression in quotes", "[set]"]),
        (f'[axes]\n{FREQUENCY}[derived]\n{FREQUENCY.split("=")[0]} = "1.0"\n', ["varies already"]),
        (f"[axes]\n{FREQUENCY}[threshold]\naxis = 'contact.mu_static'\n", ["none of the axes"]),
        (f"[axes]\n{FREQUENCY}[perturbation]\nmue = 0.02\n", ["unknown key 'mue'", "did you mean 'mu'"]),
        (
            f"[axes]\n{FREQUENCY}[perturbation]\ncontact_damping_ratios = [0.5, -1.0]\n",
            ["[perturbation] contact_damping_ratios", "-1"],
        ),
        (f"[axes]\n{FREQUENCY}[maps]\nx = 'contact.mu_static'\n", ["[maps]", "none of the axes"]),
        (f"[axes]\n{FREQUENCY}[maps]\nfixed = {{ 'contact.mu_static' = 0.25 }}\n", ["none of the axes"]),
        (
            f"[axes]\n{FREQUENCY}{PAIR}[maps]\nfixed = {{ 'contact.mu_static' = 0.25 }}\n",
            ["values: 0.2, 0.3"],
        ),
        (f"[axes]\n{FREQUENCY}{PAIR}[maps]\nfixed = {{ 'contact.mu_static' = 0.3 }}\n", ["two axes"]),
        (f"[axes]\n{FREQUENCY}{PAIR}[maps]\nx = 'contact.mu_static'\ny = 'contact.mu_static'\n", ["twice"]),
        (f"[axis]\n{FREQUENCY}", ["unknown table", "did you mean 'axes'"]),
    ],
)
def test_bad_input_is_refused_with_a_way_out(sweep_of, body, words):
    with pytest.raises(CaseError) as refused:
        sweep_of(body)
    message = str(refused.value)
    assert [word for word in words if word not in message] == []
    assert all(line.strip() for line in message.splitlines())


def test_a_base_case_outside_the_folder_is_refused(sweep_of):
    with pytest.raises(CaseError, match="copy the file there"):
        sweep_of(f"[axes]\n{FREQUENCY}", 'case = "../other.toml"\n')
    with pytest.raises(CaseError, match="no shipped case; did you mean 'seed_stack'"):
        sweep_of(f"[axes]\n{FREQUENCY}", 'case = "seed_stak"\n')


@pytest.mark.parametrize("name", SWEEPS.names)
def test_shipped_sweeps_can_be_read(name):
    sweep = load_sweep(name)
    assert sweep.title
    assert sweep.count > 100
    assert sweep.case(0) != sweep.case(sweep.count - 1)
