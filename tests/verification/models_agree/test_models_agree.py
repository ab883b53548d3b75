"""The reduced model against the full one: the same mesh, contact and stepping, free rocking over two half cycles.

Full: every node moves, total Lagrangian. Reduced: floating frame, 20 elastic and all attachment modes. The
program's own limits apply: 1e-3 of the slenderness angle before the first impact and 0.01 in the velocity ratio
over it.
"""

import numpy as np
import pytest
from container_runs import difference, first_impact, stack, times, velocity_ratio
from runs import run

CASES = [
    ("solid", "corners"),
    pytest.param("shell", "feet", marks=pytest.mark.slow),
    ("shell", "flat"),
    ("thin shell", "corners"),
]


@pytest.mark.parametrize(("section", "kind"), CASES)
def test_reduced_follows_full_through_two_impacts_and_loses_as_much(section: str, kind: str) -> None:
    # Their steps differ: at a tolerance of 1 those of the thin shell alone make 0.0015 of difference.
    reduced, full = (
        run(stack(section, support__kind=kind, solver__model=model, solver__energy_tolerance=0.3))
        for model in ("reduced", "full")
    )
    first = min(first_impact(reduced), first_impact(full))
    assert first < 0.75
    assert difference(reduced, full, until=first) <= 5e-4
    assert first_impact(reduced) == pytest.approx(first_impact(full), rel=1e-3)
    assert velocity_ratio(full) < 0.97
    assert velocity_ratio(reduced) == pytest.approx(velocity_ratio(full), abs=0.01)
    by_energy = [float(each.track.restitution) for each in (reduced, full)]
    assert by_energy[0] == pytest.approx(by_energy[1], abs=0.01)
    # the second impact is near 1.8 s: 0.01 of the slenderness angle is what counts as rocking at all
    assert int(full.track.impacts) == int(reduced.track.impacts) == 2
    assert difference(reduced, full) <= 0.01


def test_reduced_vibrates_at_the_floor_as_full_does() -> None:
    # Force of the floor while the stack rocks on a corner after its first impact: it rings by more than the weight.
    # without a fill, which would damp it
    keys = {"support__kind": "corners", "solver__energy_tolerance": 0.3, "container__fill": "none"}
    reduced, full = (run(stack("shell", solver__model=model, **keys)) for model in ("reduced", "full"))
    window = (times(full) > first_impact(full) + 0.05) & (times(full) < first_impact(full) + 0.3)
    forces = [each.history["normal_force_N"][: window.size][window] for each in (reduced, full)]
    ringing = np.std(forces[1])
    assert ringing > 98100.0
    assert np.sqrt(np.mean((forces[0] - forces[1]) ** 2)) < 0.1 * ringing
