"""A run that may stop once it is still: what is left of its record cannot move a container at rest."""

import numpy as np
import pytest

from fem.case.case import Case, case_from
from fem.model.model import build_model
from fem.run.compute import compute
from fem.run.simulation import run_without_history

STEP = 0.01
BOX = {
    "schema": 1,
    "container": {"width_m": 1.0, "height_m": 2.0, "mass_kg": 1000.0},
    "contact": {"mu_static": 0.7},
    "motion": {"kind": "none"},
    "solver": {"model": "rigid"},
    "output": {"fields_s": 0.0},
}


def shaken(coda: float, again: float = 0.0, **keys: object) -> Case:
    """A box under a strong half-cycle, 6 s of shaking at `coda` and a half-cycle at `again` of what lifts its side."""
    time = np.arange(0.0, 8.0, STEP)
    lifts = 9.81 * 0.5
    acceleration = 1.5 * lifts * np.sin(np.pi * time / 0.5) * (time < 0.5)
    acceleration += coda * lifts * np.sin(2.0 * np.pi * time) * (time > 1.0) * (time < 7.0)
    acceleration -= again * lifts * np.sin(np.pi * (time - 6.0) / 0.5) * (time > 6.0) * (time < 6.5)
    case = case_from(BOX).with_motion(time, acceleration)
    return case.with_values({f"output.{k}": v for k, v in keys.items()})


def test_a_run_that_stops_when_still_moves_as_one_whose_contents_are_followed():
    case = shaken(0.3, stop_when_still=True)
    brief, error = run_without_history(build_model(case), None)
    assert error is None and brief.max_acceleration_m_s2 is None and brief.max_top_displacement_m is None
    followed = compute(shaken(0.3), band=False, margin=False).verdict
    assert followed.max_acceleration_m_s2 > 1.0
    for name in ("outcome", "max_rotation_rad", "max_slip_m", "max_uplift_m", "impacts"):
        assert getattr(brief, name) == getattr(followed, name)


def ended(case: Case) -> tuple[float, float, float]:
    run = compute(case, band=False, margin=False)
    return float(run.history["time_s"][-1]), run.verdict.rotation_ratio, run.verdict.max_slip_m


def test_a_run_that_stops_when_still_finds_what_a_run_to_the_end_finds():
    whole = ended(shaken(0.3))
    brief = ended(shaken(0.3, stop_when_still=True))
    assert brief[1:] == whole[1:] and whole[1] > 0.05
    assert brief[0] < 6.0 < 7.9 < whole[0]


@pytest.mark.parametrize(
    ("coda", "again", "keys"), [(0.95, 0.0, {}), (0.8, 0.0, {"solver.model": "reduced"}), (0.0, 1.7, {})]
)
def test_it_goes_on_where_the_rest_of_the_record_might_move_it(coda, again, keys):
    """Above 0.9 of what lifts a side, and with an elastic container, which answers more than the floor moves."""
    last, *_ = ended(shaken(coda, again, stop_when_still=True).with_values(keys))
    assert last > 6.5
