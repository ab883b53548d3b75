"""Restitution of the first impact, by the energy of rocking: a number where there is one, else None."""

import numpy as np
import pytest
from runs import run

import fem
from fem.case.case import load_case
from fem.figures.run import phase_portrait_figure
from fem.results.run_result import Verdict
from fem.run.verdict import verdict_of

HOUSNER = 0.8945
SHELL = ("container.section=shell", "container.wall_m=0.008", "container.fill=none")
SHELL += ("container.youngs_modulus_Pa=2.1e11",)
FLAT = ("support.kind=flat", "contact.mu_kinetic=0.4")


def verdict(name: str, *changes: str) -> Verdict:
    done = run(load_case(name, ("floor.kind=rigid", "output.fields_s=0", *changes)))
    return verdict_of(done.model, done.history, None)


@pytest.mark.parametrize(
    ("changes", "expected", "within"),
    [
        ((), HOUSNER, 2e-3),
        (SHELL, 0.894, 2e-3),  # by the peaks around it
        ((*SHELL, "contact.mu_static=0.3"), 0.896, 2e-3),
        ((*SHELL, "support.kind=feet"), 0.925, 2e-3),
        ((*SHELL, "support.kind=flat"), 0.950, 2e-3),
    ],
)
def test_free_rocking_keeps_what_the_peaks_say(changes, expected, within):
    found = verdict("free_rocking", "solver.duration_s=2", *changes)
    assert found.restitution_first == pytest.approx(expected, abs=within)


@pytest.mark.parametrize(
    ("model", "expected", "within"), [("rigid", HOUSNER, 1e-3), ("reduced", 0.885, 1e-2)]
)
def test_ringing_does_not_enter_under_a_moving_floor(model, expected, within):
    # The mean angular velocity after the impact of the shell gave 0.81; a block with 0.876 has the shell's ratio.
    found = verdict("rocking", "solver.duration_s=2", f"solver.model={model}")
    assert found.restitution_first == pytest.approx(expected, abs=within)


def test_the_phase_portrait_keeps_the_orbit_of_a_free_block_and_an_impact_takes_what_housner_says():
    free = ("solver.model=rigid", "floor.kind=rigid", "output.fields_s=0", "solver.duration_s=4")
    found = fem.compute(load_case("free_rocking", free), band=False, margin=False)
    angle, parameter = found.slenderness_angle, found.typed_result.static.frequency_parameter_1_s
    (line,) = (one for one in phase_portrait_figure(found).axes[0].lines if one.get_label() == "on the floor")
    points = np.radians([line.get_xdata(), line.get_ydata()])
    arcs = np.split(points, np.flatnonzero(np.isnan(points[0])), axis=1)
    energies = []  # over m g R: omega^2/(2 p^2) + cos(alpha - |theta|), constant between impacts
    for rotation, rate in (arc[:, ~np.isnan(arc[0])] for arc in arcs if arc.shape[1] > 2):
        energy = rate**2 / (2.0 * parameter**2) + np.cos(angle - np.abs(rotation)) - np.cos(angle)
        energies.append(energy.mean())
        assert np.ptp(energy) < 2e-3 * energies[0]  # next to an impact the springs of both corners bear
    assert energies[0] == pytest.approx(np.cos(0.5 * angle) - np.cos(angle), rel=1e-3)
    assert np.divide(energies[1:], energies[:-1]) == pytest.approx(HOUSNER**2, rel=0.02)
    assert len(energies) > 3


@pytest.mark.parametrize("changes", [("contact.mu_kinetic=0.4",), ("container.section=solid",)])
def test_a_container_that_slides_at_the_impact_has_no_restitution(changes):
    found = verdict("seed_stack_plateau", "solver.duration_s=2", *changes)
    assert found.impacts > 0
    assert found.first_impact_s == pytest.approx(0.625, abs=2e-3)
    assert found.restitution_first is None


def test_flutter_of_an_edge_before_rocking_is_no_impact():
    found = verdict("seed_stack_plateau", *FLAT, "motion.peak_acceleration_m_s2=2.563", "solver.duration_s=3")
    assert found.first_impact_s > 1.0
    assert found.restitution_first is None or 0.9 < found.restitution_first < 1.0


def test_a_run_that_rests_has_no_impacts():
    changes = ("motion.peak_acceleration_m_s2=2.428", "solver.model=rigid", "solver.duration_s=8")
    found = verdict("seed_stack_plateau", *FLAT, *changes)
    assert found.outcome == "rest"
    assert found.max_uplift_m > 0.0
    assert found.impacts == 0
    assert found.first_impact_s is None
    assert found.restitution_first is None
