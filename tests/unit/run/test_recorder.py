"""What a run leaves behind reads as people write it: no rounding of the grid's multiplication, no minus zero."""

import numpy as np
import pytest

import fem
from fem.case.case import load_case
from fem.model.model import build_model
from fem.model.recovery import recovery_of
from fem.run.recorder import Recorder, as_written
from fem.run.simulation import simulate


@pytest.mark.parametrize("interval", ["0.05", "0.005", "0.03", "1e-4", "2.5"])
def test_times_on_a_decimal_grid_have_no_tail(interval):
    times = as_written(np.arange(4001) * float(interval))
    decimals = max(len(interval.partition(".")[2]), 4)
    assert times.tolist() == [float(f"{k * float(interval):.{decimals}f}") for k in range(4001)]
    assert (np.diff(times) > 0.0).all()


def test_no_sample_and_no_frame_of_a_run_has_a_tail_or_a_minus_zero():
    case = load_case("seed_box", ["solver.model=rigid", "solver.duration_s=0.4", "output.fields_s=0.05"])
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
    coarse = [
        "solver.model=full",
        "container.fill=none",
        "solver.element_size_m=0.4",
        "solver.duration_s=0.3",
    ]
    found = [
        fem.compute(
            fem.load_case("rocking", [*coarse, f"output.fields_s={fields}", f"output.history_s={history}"]),
            band=False,
        ).verdict.max_von_mises_Pa
        for fields, history in ((0.0, 0.05), (0.05, 0.005), (0.005, 0.001))
    ]
    assert found[0] == found[1]
    assert found[0] <= found[2] <= 1.02 * found[0]  # frames between the steps
    still = fem.compute(
        fem.load_case(
            "rocking", [*coarse, "motion.kind=none", "output.fields_s=0.3", "solver.duration_s=0.3"]
        ),
        band=False,
    )
    frame = still.frame(0.0)
    low, high = frame.points.min(axis=0), frame.points.max(axis=0)
    beyond = np.minimum(frame.points - low, high - frame.points).max(axis=1) > 0.199  # the castings
    assert still.verdict.max_von_mises_Pa == pytest.approx(float(frame.von_mises[beyond].max()), rel=0.05)
