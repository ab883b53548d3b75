"""What a sweep file may hold; what it may not is refused with the key, the reason and a way out."""

import pytest

from fem.case.case import case_hash
from fem.case.files import SWEEPS
from fem.study.file import load_sweep

HEAD = 'case = "seed_stack_plateau"\n[set]\n"solver.model" = "rigid"\n'
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


def test_a_cell_is_the_base_with_its_keys_set(sweep_of):
    # The light way of making cases against the long one; an axis on a peak acceleration replaces the amplitude.
    sweep = sweep_of(
        f'[axes]\n{FREQUENCY}"motion.peak_acceleration_m_s2" = [3.0, 5.0]\n"container.boxes" = [2, 4]\n'
        '[derived]\n"contact.mu_kinetic" = "0.5 * contact.mu_static"\n'
    )
    for cell in range(sweep.count):
        case = sweep.case(cell)
        long_way = sweep.base.with_values(sweep.make.values(sweep.point(cell)) | {"output.fields_s": 0.0})
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
    values = sweep.make.values(sweep.point(3))
    assert values["container.centroid_m"] == pytest.approx(0.8)
    assert values["initial.velocity_m_s"] == pytest.approx(1.6 + 0.2)


@pytest.mark.parametrize("name", SWEEPS.names)
def test_shipped_sweeps_can_be_read(name):
    sweep = load_sweep(name)
    assert sweep.title
    assert sweep.count > 100
    assert sweep.case(0) != sweep.case(sweep.count - 1)
