"""A container that stands stays where it stands: every support, rigid and elastic, settled before t = 0."""

import numpy as np
import pytest

from contact.stepping.outcome import advance_compiled
from fem.case.case import load_case
from fem.model.model import Model, build_model

SUPPORTS = ["corners", "feet", "flat"]


def standing(model: str, support: str, section: str) -> Model:
    case = load_case("seed_stack").with_values(
        {
            "motion.kind": "none",
            "floor.kind": "rigid",
            "solver.model": model,
            "solver.element_size_m": 0.275,
            "solver.duration_s": 2.0,
            "support.kind": support,
            "container.section": section,
            "output.history_s": 0.02,
            "output.fields_s": 0.0,
        }
    )
    return build_model(case)


@pytest.mark.parametrize("section", ["solid", "shell"])
@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize("model", ["rigid", "reduced"])
def test_a_settled_container_does_not_move(model, support, section):
    standing_model = standing(model, support, section)
    run = standing_model.run
    before, forces = run.old.position.copy(), run.old.force.copy()
    penetration = standing_model.static.weight / standing_model.base_stiffness
    assert np.abs(run.old.acceleration[:3]).max() <= 1e-9 * 9.81
    assert advance_compiled(standing_model.body, run, 2.0) == 0
    assert run.clock[0].time >= 2.0
    assert np.abs(run.old.position[:3] - before[:3]).max() <= 1e-6 * penetration
    assert run.old.force == pytest.approx(forces, abs=1e-6 * standing_model.static.weight)
    assert run.ledger == pytest.approx(np.zeros(7), abs=1e-9 * run.problem.control.reference_energy)
    assert run.clock[0].rejected == 0
    assert run.joints[0].slip_travel == 0.0
    assert run.joints[0].max_slip <= 1e-6 * penetration
    assert run.track[0].modes == 1  # at rest, and nothing else


@pytest.mark.parametrize("support", SUPPORTS)
def test_the_forces_of_a_settled_container_carry_its_weight_evenly(support):
    model = standing("reduced", support, "solid")
    tangential, normal = model.run.old.force.T
    assert normal.sum() == pytest.approx(model.static.weight, rel=1e-12)
    assert normal == pytest.approx(normal[::-1], rel=1e-6)
    assert not tangential.any()
