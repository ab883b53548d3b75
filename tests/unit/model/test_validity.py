"""A model that could not be valid is refused with the reason, and a computation that fails says why."""

import numpy as np
import pytest

import fem.model.validity
from fem.case.case import CaseError, load_case
from fem.model.container import discretise
from fem.model.model import build_model
from fem.model.validity import LEAST_STRETCH, required_memory, runs_in_memory
from fem.run.recorder import Recorder
from fem.run.simulation import simulate, stepping_failure
from fem.solid.elasticity import stress_and_energy

COARSE = ("solver.element_size_m=0.5", "output.fields_s=0", "solver.duration_s=0.5")
SOFT = ("container.youngs_modulus_Pa=1e6", *COARSE)
TILTED = (*COARSE, "floor.kind=rigid", "solver.model=rigid", "initial.rotation_rad=0.1")
FLAT = ("container.section=solid", "container.youngs_modulus_Pa=1e6", "support.kind=flat")


def test_a_corner_whose_spring_would_throw_the_container_is_refused():
    with pytest.raises(CaseError, match=r"rotation_rad = 0.1 rad: the corner .* sink in by .* of the width"):
        build_model(load_case("rocking", [*TILTED, *FLAT]))
    build_model(load_case("rocking", [*TILTED, *FLAT, "container.youngs_modulus_Pa=2.1e11"]))


def test_friction_without_springs_begins_without_their_energy():
    # Its springs, stretched by the friction of the tilted stance, held 2 % of the energy to overturn, and lost them.
    overrides = ["contact.friction=regularised", "contact.tangential_ratio=0.01", "initial.rotation_rad=0.02"]
    model = build_model(load_case("rocking", [*TILTED, *overrides]))
    assert not model.run.old.stick.any()
    assert simulate(model, Recorder(model)).status == "completed"


def test_the_nominal_stress_of_a_compressed_bar_is_largest_at_the_least_stretch():
    stretches = np.linspace(0.3, 0.9, 6001)
    # No cross-contraction, Young's modulus 1.
    stress = stress_and_energy(0.0, 0.0, 0.0, stretches - 1.0, first=0.0, shear=0.5)[3]
    assert stretches[np.argmin(stress)] == pytest.approx(LEAST_STRETCH, abs=1e-4)


def test_a_run_that_inverts_an_element_fails_and_says_where():
    case = load_case("seed_stack_plateau", ["solver.model=full", "container.section=solid", *SOFT])
    model = build_model(case)
    ending = simulate(model, Recorder(model))
    assert ending.status == "failed"
    assert ending.error is not None and "inverted" in ending.error and "youngs_modulus_Pa" in ending.error
    assert 0.0 < model.run.clock[0].time < 0.5


def test_a_step_that_fails_says_what_failed():
    model = build_model(load_case("seed_box", ["solver.model=rigid"]))
    weight = model.container.mesh.mass * model.case.gravity_m_s2
    residuals = (np.nan, np.inf, 1e-12 * weight, weight)
    messages = {residual: stepping_failure(model, residual) for residual in residuals}
    for message in messages.values():
        assert message.startswith("step 1, t = 0 s: ") and "at the smallest step (" in message
        assert "try a" in message and "nan" not in message and "inf" not in message
    assert "trial solution is not finite" in messages[np.nan]
    assert "did not converge" in messages[1e-12 * weight]
    assert f"out of balance by {weight:.2g} N" in messages[weight]


def test_a_container_too_large_for_the_memory_is_refused_before_it_is_assembled(monkeypatch):
    monkeypatch.setattr(fem.model.validity, "_machine_memory", lambda: 1e9)
    assert runs_in_memory(5, 0.15e9) == 5 and runs_in_memory(5, 0.3e9) == 2 and runs_in_memory(5, 2e9) == 1
    with pytest.raises(CaseError, match=r"need about .* GB; this machine has 1 GB: use larger elements"):
        discretise(load_case("rocking", ["solver.element_size_m=0.005", "support.kind=flat"]))


def test_the_memory_required_is_about_the_memory_used():
    """Peak memory of processes that made these (MB)."""
    for nodes, contact_nodes, model, modes, measured in (
        (46217, 2, "rigid", 20, 381),
        (46217, 2, "reduced", 200, 986),
        (21637, 77, "reduced", 20, 429),
    ):
        case = load_case("rocking", [f"solver.model={model}", f"solver.elastic_modes={modes}"])
        assert 0.8 < required_memory(case, nodes, contact_nodes) / (1e6 * measured) < 1.7
