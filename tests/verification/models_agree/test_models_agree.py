"""The reduced model against the full one: the same mesh, contact and stepping.

Full: every node moves, total Lagrangian. Reduced: floating frame, 20 elastic and all attachment modes. In free rocking
over two half cycles the program's own limits apply: 1e-3 of the slenderness angle before the first impact and 0.01 in
the velocity ratio over it. Stresses and frequencies are held to linear statics as well: K u = -weight with the contact
springs on the supporting nodes that press, solved here.
"""

from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg
from runs import difference, run, stack
from verification.restitution import velocity_ratio

from fem.model.container import Container
from fem.model.model import Model, build_model
from fem.model.recovery import NodalFields, recovery_of

SECTIONS = ["solid", "shell"]
STANDING: dict[str, Any] = {"initial__rotation_rad": 0.0, "solver__duration_s": 0.05}


def frame_of(model: Model) -> NodalFields:
    """Fields of the present state of a model."""
    return recovery_of(model).frame(model.run.old.position, model.run.old.velocity)


def settled_displacement(model: Model) -> np.ndarray:
    """Nodal displacements (n, 2) of linear statics on unilateral springs; the middle of the base kept in x."""
    elements, contact = model.container.elements, model.run.problem.contact
    weight = np.zeros((len(elements.nodes), 2))
    weight[:, 1] = -model.case.gravity_m_s2 * (elements.mass @ np.ones(len(elements.nodes)))
    pressing = np.ones(model.container.nodes.size, dtype=bool)
    middle = elements.base_nodes[np.argmin(np.abs(elements.nodes[elements.base_nodes, 0]))]
    for _ in range(50):
        springs = np.zeros(elements.unknowns)
        springs[2 * model.container.nodes + 1] = np.where(pressing, contact.normal_stiffness, 0.0)
        springs[2 * middle] = 1e12  # symmetry leaves nothing for it to carry
        matrix = (elements.stiffness + scipy.sparse.diags_array(springs)).tocsc()
        answer = scipy.sparse.linalg.spsolve(matrix, weight.ravel()).reshape(-1, 2)
        now = answer[model.container.nodes, 1] < 0.0
        if np.array_equal(now, pressing):
            return answer
        pressing = now
    raise AssertionError("no equilibrium found")


@pytest.mark.parametrize("kind", ["corners", "feet", "flat"])
@pytest.mark.parametrize("section", SECTIONS)
def test_stresses_under_gravity_are_those_of_linear_statics(section: str, kind: str) -> None:
    case = stack(section, **STANDING, support__kind=kind)
    reduced = build_model(case)
    elements = reduced.container.elements
    expected = elements.nodal_von_mises(settled_displacement(reduced))
    at_start = frame_of(reduced)
    largest = expected.max()
    assert largest > (1e5 if section == "shell" else 1e4)
    assert np.abs(at_start.von_mises - expected).max() <= 0.01 * largest
    after = run(case).model
    assert np.abs(frame_of(after).von_mises - expected).max() <= 0.01 * largest
    full = run(case.with_values({"solver.model": "full"})).model
    assert np.abs(frame_of(full).von_mises - expected).max() <= 0.01 * largest


@pytest.mark.parametrize("section", SECTIONS)
def test_displacements_and_stresses_on_one_corner_agree_between_the_models(section: str) -> None:
    # Half a second into the fall back, tilted by 0.3 of the slenderness angle: one corner carries everything.
    case = stack(section, solver__duration_s=0.5)
    reduced, full = (
        frame_of(run(case.with_values({"solver.model": model})).model) for model in ("reduced", "full")
    )
    standing = frame_of(build_model(stack(section, **STANDING)))
    largest = full.von_mises.max()
    assert largest > 1.5 * standing.von_mises.max()
    assert np.abs(reduced.von_mises - full.von_mises).max() <= 0.01 * largest
    moved = np.abs(full.displacement).max()
    assert np.abs(reduced.displacement - full.displacement).max() <= 1e-3 * moved


def container_of(section: str) -> Container:
    return build_model(stack(section)).container


@pytest.mark.parametrize("section", SECTIONS)
def test_frequencies_of_the_modes_kept_are_those_of_all_nodes(section: str) -> None:
    # Every mode of the free mesh by a dense solution, against the twenty kept, whose basis holds attachment modes.
    container = container_of(section)
    elements = container.elements
    squares = scipy.linalg.eigh(
        elements.stiffness.toarray(), elements.vector_mass.toarray(), eigvals_only=True, driver="gvd"
    )
    assert np.abs(squares[:3]).max() < 1e-6 * squares[3]
    kept = container.basis.angular_frequencies[:20]
    assert kept == pytest.approx(np.sqrt(squares[3:23]), rel=1e-3)


def test_velocities_of_the_nodes_are_the_rates_of_their_displacements() -> None:
    model = run(stack("shell", solver__duration_s=0.5)).model
    recovery, position, velocity = recovery_of(model), model.run.old.position, model.run.old.velocity
    back, on = (recovery.frame(position + t * velocity, velocity).displacement for t in (-1e-6, 1e-6))
    speeds = recovery.frame(position, velocity).velocity
    assert (on - back) / 2e-6 == pytest.approx(speeds, abs=1e-6 * np.abs(speeds).max())


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
    first = min(reduced.track.first_impact, full.track.first_impact)
    assert first < 0.75
    assert difference(reduced, full, until=first) <= 5e-4
    assert reduced.track.first_impact == pytest.approx(full.track.first_impact, rel=1e-3)
    back = (
        -float(each.history["rotation_rad"].min()) for each in (reduced, full)
    )  # at the next turning point
    kept = [velocity_ratio(each.block, turned) for each, turned in zip((reduced, full), back, strict=True)]
    assert kept[1] < 0.97
    assert kept[0] == pytest.approx(kept[1], abs=0.01)
    by_energy = [each.restitution for each in (reduced, full)]
    assert by_energy[0] == pytest.approx(by_energy[1], abs=0.01)
    # the second impact is near 1.8 s: 0.01 of the slenderness angle is what counts as rocking at all
    assert int(full.track.impacts) == int(reduced.track.impacts) == 2
    assert difference(reduced, full) <= 0.01


def test_reduced_vibrates_at_the_floor_as_full_does() -> None:
    # Force of the floor while the stack rocks on a corner after its first impact: it rings by more than the weight.
    # without a fill, which would damp it
    keys = {"support__kind": "corners", "solver__energy_tolerance": 0.3, "container__fill": "none"}
    reduced, full = (run(stack("shell", solver__model=model, **keys)) for model in ("reduced", "full"))
    window = (full.times > full.track.first_impact + 0.05) & (full.times < full.track.first_impact + 0.3)
    forces = [each.history["normal_force_N"][: window.size][window] for each in (reduced, full)]
    ringing = np.std(forces[1])
    assert ringing > 98100.0
    assert np.sqrt(np.mean((forces[0] - forces[1]) ** 2)) < 0.1 * ringing
