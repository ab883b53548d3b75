"""How sure the cells of a sweep are: which are perturbed, how, what the copies say, how wide the band is."""

import math

import numpy as np
import pytest
from small_sweep import SMALL, rows_of, sweep_in

from fem.case.case import load_case
from fem.model.model import build_model
from fem.results.outcome import Ending
from fem.run.band import key_of
from fem.run.compute import compute
from fem.run.simulation import run_without_history
from fem.study.axes import Axis
from fem.study.design import Perturbation
from fem.study.draws import held_inputs
from fem.study.sure import Copies, around, band_width, coarse_cells, left_out, near_cells
from fem.study.sweep import run_sweep
from fem.study.sweep_table import open_sweep

pytestmark = pytest.mark.usefixtures("undrawn")


@pytest.fixture
def sweep_of(tmp_path):
    return lambda text: sweep_in(tmp_path, text)


def copies_of(sweep, cell=0):
    return Copies(sweep, {}).of(cell)


def keys_of(sweep, cell=0):
    """The keys that the copies of a cell change, those of draws together."""
    return {key for copy in copies_of(sweep, cell) for key in copy.change.values}


def test_a_copy_of_a_cell_is_the_member_of_the_band_of_its_run(sweep_of):
    # Kinetic friction follows the static one, and step and penalty are those chosen for the cell.
    given = '"contact.mu_kinetic" = 0.4\n"contact.mu_static" = 0.4\n[axes]'
    sweep = sweep_of(SMALL.split("[derived]")[0].replace("[axes]", given))
    band = compute(sweep.case(0), band=True, margin=False).verdict.band
    members = {key_of(one.values): one for one in band.members if one.kind == "one"}
    found = {}
    for copy in copies_of(sweep):
        if key_of(copy.change.values) in members:
            model = build_model(sweep.make.case(sweep.item(0)._replace(more=copy.values)))
            found[key_of(copy.change.values)] = run_without_history(model, None)[0]
    assert {"contact.mu_static", "container.eccentricity_m"} <= {key for some in found for key, _ in some}
    for key, verdict in found.items():
        assert verdict.outcome == members[key].outcome
        assert verdict.rotation_ratio == members[key].rotation_ratio


@pytest.mark.parametrize(
    ("table", "gone"),
    [
        ('"uncertainty.slope_percent" = "held"', {"floor.slope_percent"}),
        ('"uncertainty.damping_ratio" = "known"', {"contact.damping_ratio"}),
        ('"uncertainty.normal_penalty_Pa_m" = "known"', {"contact.normal_penalty_Pa_m"}),
    ],
)
def test_a_known_input_is_left_out(sweep_of, table, gone):
    text = SMALL.replace("[axes]", f"{table}\n[axes]")
    assert keys_of(sweep_of(SMALL)) - keys_of(sweep_of(text)) == gone


def test_a_deformable_container_leaves_out_what_takes_long(sweep_of):
    sweep = sweep_of(SMALL.replace('model" = "rigid"', 'model" = "reduced"'))
    copies = copies_of(sweep)
    assert {copy.change.kind for copy in copies} == {"one"}
    assert "container.damping_ratio" in {key for copy in copies for key in copy.change.values}
    assert "draws" in left_out(sweep)
    assert left_out(sweep_of(SMALL)) == "contact of the base"
    assert "away from a change" in left_out(sweep_of(SMALL + '[perturbation]\ncells = "near"\n'))


def test_the_coarse_grid_leaves_no_cell_far_away():
    axes = [Axis(key=name, values=tuple(map(float, range(count)))) for name, count in (("a", 43), ("b", 46))]
    assert around(axes, coarse_cells(axes), 3).all()
    assert coarse_cells(axes).sum() == 11 * 12
    words = Axis(key="c", values=("rest", "moving"))
    assert coarse_cells([words, axes[0]]).sum() == 2 * 11


def test_a_cell_is_as_sure_as_its_copies_are_and_what_decides_it_turns_it(sweep_of, tmp_path):
    sweep = sweep_of(SMALL + '[perturbation]\ncells = "all"\n')
    info = run_sweep(sweep, tmp_path / "out")
    table = open_sweep(tmp_path / "out")
    members = rows_of(tmp_path / "out" / "members.csv")
    for cell in range(sweep.count):
        own = str(table["outcome"][cell])
        copies = [row for row in members if int(row["cell"]) == cell]
        found = {row["outcome"] for row in copies}
        fell = {one == "overturned" for one in (found | {own})}
        expected = "unsure" if len(fell) > 1 else "sure" if found <= {own} else "regime unsure"
        assert table["sure"][cell] == expected
        decided = table["decided_by"][cell].split()
        assert bool(decided) == (expected != "sure")
        if expected == "unsure":
            falls = own == "overturned"
            turned = [row["change"] for row in copies if (row["outcome"] == "overturned") != falls]
            assert all(f"{key}=" in " ".join(turned) for key in decided)
    assert np.array_equal(table["sure"] == "unsure", table["unsure"] == 1.0)
    assert sum(info["sure"].values()) == sweep.count
    assert info["sure"]["unsure"] == info["unsure"] > 0


@pytest.mark.parametrize(
    ("changes", "varied", "words"),
    [
        ("", (), "with mu_k = mu_s/2 falling at once, no ramp"),
        ("contact.weakening_m=0.001", ("motion.start",), "with mu_k = mu_s/2 falling over 1 mm, no ramp"),
        ("contact.mu_kinetic=0.4", ("motion.ramp_cycles",), "with mu_k = mu_s"),
        ("motion.kind=pulse motion.shape=sine motion.pulse_s=1.0", ("contact.mu_kinetic",), "falling"),
    ],
)
def test_what_is_held_is_said(changes, varied, words):
    held = held_inputs([load_case("seed_stack_plateau", changes.split())], varied)
    assert words in held


X = Axis(key="contact.mu_static", values=(0.1, 0.2, 0.3, 0.4, 0.5), scale="linear")
Y = Axis(key="motion.peak_acceleration_m_s2", values=(1.0, 2.0, 4.0, 8.0), scale="log", unit="m/s2")


def members(case):
    return [change.values for change in Perturbation().changes(case)]


def test_cells_beside_another_kind_are_near_diagonals_too_and_a_close_call_is_by_itself():
    kind, ratio = np.full((5, 4), Ending.STANDING), np.zeros((5, 4))
    kind[0, 0], ratio[3, 2] = Ending.OVERTURNED, 0.6
    near = near_cells((X, Y), kind, ratio, 0.5)
    assert sorted(map(tuple, np.argwhere(near))) == [(0, 0), (0, 1), (1, 0), (1, 1), (3, 2)]


def test_the_band_is_as_wide_as_its_stretch_of_cells():
    unsure = np.zeros((5, 4), dtype=bool)
    unsure[1:3, 1] = True
    unsure[4, 1] = True
    along_x = band_width((X, Y), unsure, 0)
    assert along_x[:, 1] == pytest.approx([0.0, 0.2, 0.2, 0.0, 0.05])
    along_y = band_width((X, Y), unsure, 1)
    assert along_y[1] == pytest.approx([0.0, math.sqrt(8.0) - math.sqrt(2.0), 0.0, 0.0])
    assert along_x[:, [0, 2, 3]].max() == 0.0


def test_each_member_changes_one_thing():
    keys = ["floor.kind=rigid", "contact.damping_ratio=1.0", "motion.phase_rad=6.2"]
    case = load_case("seed_stack_plateau", keys)
    found = members(case)
    peak = case.motion.peak_acceleration_m_s2 or case.motion.amplitude * case.motion.angular_frequency**2
    changed = [case.with_values(member) for member in found]
    peaks = [one.motion.amplitude * one.motion.angular_frequency**2 for one in changed]
    assert sorted(round(p / peak, 9) for p in peaks) == [0.98] + [1.0] * 6 + [1.02]
    assert all(one.motion.angular_frequency == case.motion.angular_frequency for one in changed)
    friction = {(one.contact.mu_static, one.contact.mu_kinetic) for one in changed}
    mu, kinetic = case.contact.mu_static, case.contact.mu_kinetic
    steps = [(round(a - mu, 9), round(b - kinetic, 9)) for a, b in friction]
    assert sorted(steps) == [(-0.02, -0.02), (0.0, 0.0), (0.02, 0.02)]
    assert sorted({one.contact.damping_ratio for one in changed}) == [0.5, 1.0, 2.0]
    shifts = {round(math.remainder(one.motion.phase_rad - 6.2, math.tau), 9) for one in changed}
    assert shifts == {-0.3142, 0.0, 0.3142}


def test_a_pulse_has_no_phase_and_a_floor_at_rest_no_amplitude():
    still = members(load_case("free_rocking"))
    assert not any(key.startswith("motion.") for member in still for key in member)
    peak = "motion.peak_acceleration_m_s2"
    pulse = ["motion.kind=pulse", "motion.shape=sine", "motion.pulse_s=0.5", f"{peak}=-4.0"]
    found = [member[peak] for member in members(load_case("seed_stack", pulse)) if peak in member]
    assert found == pytest.approx([-3.92, -4.08])
