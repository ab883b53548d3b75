"""The reduced model against the full one: the same mesh, contact and stepping, free rocking over two half cycles.

Full: every node moves, total Lagrangian. Reduced: floating frame, 20 elastic and all attachment modes. The
limits are those the program sets itself: 1e-3 of the slenderness angle before the first impact and 0.01 in the
velocity ratio over it.
"""

from functools import cache

import numpy as np
import pytest
from container_runs import SHELL, SOLID, THIN_SHELL, Finished, difference, run, stack

SECTIONS = {"solid": SOLID, "shell": SHELL, "thin shell": THIN_SHELL}
CASES = [(section, kind) for section in SECTIONS for kind in ("corners", "feet", "flat")]


@cache
def rocking(section: str, kind: str, model: str) -> Finished:
    return run(stack(**SECTIONS[section], support__kind=kind, solver__model=model))


@pytest.mark.parametrize(("section", "kind"), CASES)
def test_reduced_follows_full_until_the_first_impact(section: str, kind: str) -> None:
    reduced, full = rocking(section, kind, "reduced"), rocking(section, kind, "full")
    first = min(reduced.first_impact, full.first_impact)
    assert first < 0.75
    assert difference(reduced, full, until=first) <= 1e-3
    assert reduced.first_impact == pytest.approx(full.first_impact, rel=1e-3)


@pytest.mark.parametrize(("section", "kind"), CASES)
def test_reduced_loses_as_much_at_an_impact_as_full(section: str, kind: str) -> None:
    reduced, full = rocking(section, kind, "reduced"), rocking(section, kind, "full")
    assert full.velocity_ratio < 0.97
    assert reduced.velocity_ratio == pytest.approx(full.velocity_ratio, abs=0.01)
    by_velocity = [float(each.model.run.track[0].restitution_by_velocity) for each in (reduced, full)]
    assert by_velocity[0] == pytest.approx(by_velocity[1], abs=0.01)


@pytest.mark.parametrize(("section", "kind"), CASES)
def test_reduced_stays_with_full_over_two_half_cycles(section: str, kind: str) -> None:
    # Two impacts, the second near 1.8 s: 0.01 of the slenderness angle is what counts as rocking at all.
    reduced, full = rocking(section, kind, "reduced"), rocking(section, kind, "full")
    assert int(full.model.run.track[0].impacts) == int(reduced.model.run.track[0].impacts) == 2
    assert difference(reduced, full) <= 0.01


def test_reduced_vibrates_at_the_floor_as_full_does() -> None:
    # Force of the floor while the stack rocks on a corner after its first impact: it rings by more than the weight.
    reduced, full = rocking("shell", "corners", "reduced"), rocking("shell", "corners", "full")
    window = (full.time > full.first_impact + 0.05) & (full.time < full.first_impact + 0.3)
    forces = [each.history["normal_force_N"][: window.size][window] for each in (reduced, full)]
    ringing = np.std(forces[1])
    assert ringing > 98100.0
    assert np.sqrt(np.mean((forces[0] - forces[1]) ** 2)) < 0.1 * ringing
