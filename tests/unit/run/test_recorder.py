"""What a run leaves behind: samples and frames as people write them, its largest stress, what its joints must carry."""

from types import SimpleNamespace

import numpy as np
import pytest
from cases import named_case

import fem
from fem.case.columns import ALWAYS, JOINTS
from fem.model.joints import edge_forces
from fem.model.model import build_model
from fem.model.recovery import recovery_of
from fem.results.history import History, numbers_of
from fem.run.recorder import Recorder, as_written
from fem.run.simulation import simulate
from fem.run.verdict import joint_demands


@pytest.mark.parametrize("interval", ["0.05", "0.005", "0.03", "1e-4", "2.5"])
def test_times_on_a_decimal_grid_have_no_tail(interval):
    times = as_written(np.arange(4001) * float(interval))
    decimals = max(len(interval.partition(".")[2]), 4)
    assert times.tolist() == [float(f"{k * float(interval):.{decimals}f}") for k in range(4001)]
    assert (np.diff(times) > 0.0).all()


def test_no_sample_and_no_frame_of_a_run_has_a_tail_or_a_minus_zero():
    case = fem.load_case("seed_box", ["solver.model=rigid", "solver.duration_s=0.4", "output.fields_s=0.05"])
    model = build_model(case)
    told, rows = [], []
    recorder = Recorder(
        model, recovery_of(model), lambda new, _: rows.extend(new), lambda frame: told.append(frame.time)
    )
    simulate(model, recorder)
    values = np.array(rows)
    assert told == [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4]
    assert values[:, 0].tolist() == [k / 200 for k in range(81)]
    assert not np.signbit(values[values == 0.0]).any()
    assert np.array_equal(recorder.history().samples, values)


@pytest.mark.slow
def test_the_largest_stress_of_the_full_model_is_that_of_its_steps_whatever_is_recorded():
    """It begins with small steps: a large one would lift the container off the floor, at thirty times the stress."""
    coarse = ("container.fill=none", "solver.element_size_m=0.4", "solver.duration_s=0.3")
    case = fem.load_case("rocking", ["solver.model=full", *coarse])
    kept = (
        {"output.fields_s": f, "output.history_s": h} for f, h in ((0.0, 0.05), (0.05, 0.005), (0.005, 0.001))
    )
    found = [fem.compute(case.replace(one), band=False).verdict.max_von_mises_Pa for one in kept]
    assert found[0] == found[1]
    assert found[0] <= found[2] <= 1.02 * found[0]  # frames between the steps
    still = fem.compute(case.replace({"motion.kind": "none", "output.fields_s": 0.3}), band=False)
    frame = still.frame(0.0)
    low, high = frame.points.min(axis=0), frame.points.max(axis=0)
    beyond = np.minimum(frame.points - low, high - frame.points).max(axis=1) > 0.199  # the castings
    assert still.verdict.max_von_mises_Pa == pytest.approx(float(frame.von_mises[beyond].max()), rel=0.05)


#: normal, shear, moment at 0, 1, 2 and 3 s: pressed in the middle; beyond a sixth of the width; beyond its edge, the
#: left one open; lifted off
FORCES = np.array([[100.0, 10.0, 0.0], [100.0, -50.0, 20.0], [100.0, 20.0, -65.0], [-8.0, 1.0, 0.0]])


def stack(overturned_at: float = np.inf):
    """As much of a model as is asked for: two boxes of 1 m x 1 m, mu_static 0.4."""
    return SimpleNamespace(
        case=named_case("least", {"container.width_m": 1.0, "container.boxes": 2}),
        run=SimpleNamespace(track=[SimpleNamespace(overturned_at=overturned_at)]),
    )


def demands(forces: np.ndarray, overturned_at: float = np.inf):
    numbers = (*numbers_of(ALWAYS.names((0,))), *JOINTS.names((1,)))
    values = np.zeros((len(forces), len(numbers)))
    values[:, 0], values[:, -3:] = np.arange(len(forces)), forces
    history = History(numbers=numbers, samples=values, modes=("rock",) * len(forces))
    return joint_demands(stack(overturned_at), history)


def test_edges_balance_normal_force_and_moment():
    left, right = edge_forces(np.array([100.0]), np.array([-65.0]), 2.0)
    assert left + right == 100.0
    assert (left - right) * 0.5 * 2.0 == -65.0  # a force up at the left edge turns toward +x


def test_bolts_carry_what_the_edges_cannot_press():
    (joint,) = demands(FORCES)
    # 65 Nm toward -x on 1 m: N/2 - 65 = -15 N at the left edge, +115 N at the right; lifted off: 4 N at each.
    assert joint.bolt_tension_left_N == pytest.approx(15.0)
    assert joint.bolt_tension_right_N == pytest.approx(4.0)
    assert (joint.partly_opens_at_s, joint.opens_at_s) == (1.0, 2.0)
    assert (joint.min_normal_N, joint.max_normal_N, joint.max_moment_Nm) == (-8.0, 100.0, 65.0)
    assert joint.friction_needed is None  # no friction holds a joint that is lifted off


def test_friction_that_holds_a_joint():
    (joint,) = demands(FORCES[:3])
    assert joint.friction_needed == pytest.approx(0.5)
    assert joint.bolt_shear_N == pytest.approx(50.0 - 0.4 * 100.0)
    assert (joint.max_shear_N, joint.slides_at_s) == (50.0, 1.0)


def test_a_joint_that_holds_without_bolts_says_so():
    (joint,) = demands(FORCES[:1])
    assert joint.opens_at_s is joint.partly_opens_at_s is joint.slides_at_s is None
    assert joint.bolt_tension_left_N == joint.bolt_shear_N == 0.0


def test_the_impact_of_an_overturned_stack_does_not_count():
    (joint,) = demands(FORCES, overturned_at=1.0)
    assert joint.opens_at_s is None


def test_a_single_box_has_no_joints():
    assert joint_demands(stack(), History.empty()) is None
