"""A container too soft for its weight or its motion is told, never computed on; and how a step that failed is told."""

import numpy as np
import pytest

from fem.assessment.verdict import audit
from fem.case.case import CaseError, load_case
from fem.model.crushing import LEAST_STRETCH, least_principal_strain, least_volume_ratio
from fem.model.model import build_model
from fem.run.recorder import Recorder
from fem.run.simulation import simulate, stepping_failure
from fem.solid.elasticity import LamePair, first_stress

COARSE = ("solver.element_size_m=0.5", "output.fields_s=0", "solver.duration_s=0.5")
SOFT = ("container.youngs_modulus_Pa=1e6", *COARSE)


def gradient(xx, xz, zx, zz):
    return np.array([[[[xx]], [[xz]]], [[[zx]], [[zz]]]])


def test_the_nominal_stress_of_a_pressed_bar_is_largest_at_the_least_stretch():
    stretches = np.linspace(0.3, 0.9, 6001)
    zero = np.zeros_like(stretches)
    bar = LamePair(first=0.0, shear=0.5)  # no cross-contraction, Young's modulus 1
    stress = first_stress(np.array([[zero, zero], [zero, stretches - 1.0]]), bar)[1, 1]
    assert stretches[np.argmin(stress)] == pytest.approx(LEAST_STRETCH, abs=1e-4)


def test_compression_and_volume_of_simple_deformations():
    assert least_principal_strain(gradient(0.1, 0.0, 0.0, -0.3)) == pytest.approx(-0.3)
    assert least_principal_strain(gradient(0.0, 0.2, 0.2, 0.0)) == pytest.approx(-0.2)  # pure shear
    assert least_principal_strain(gradient(0.0, 0.2, -0.2, 0.0)) == pytest.approx(0.0)  # a small turn
    turn = np.cos(1.0) - 1.0
    assert least_volume_ratio(gradient(turn, np.sin(1.0), -np.sin(1.0), turn)) == pytest.approx(1.0)
    assert least_volume_ratio(gradient(0.1, 0.0, 0.0, -1.5)) == pytest.approx(-0.55)


@pytest.mark.parametrize("model", ["reduced", "full"])
def test_a_container_that_its_own_weight_crushes_is_refused(model):
    with pytest.raises(
        CaseError, match=r"its own weight would press the container together by \d+ %.*stiffer"
    ):
        build_model(load_case("seed_stack_plateau", [f"solver.model={model}", *SOFT]))
    build_model(load_case("seed_stack_plateau", ["solver.model=rigid", *SOFT]))


def test_what_presses_is_the_weight_over_the_walls():
    """The strain told of a shell on its whole base is about its weight over the area of its walls and E."""
    case = load_case(
        "seed_box", ["support.kind=flat", "container.youngs_modulus_Pa=1e6", "solver.model=reduced", *COARSE]
    )
    with pytest.raises(CaseError) as refused:
        build_model(case)
    told = float(str(refused.value).split("together by ")[1].split(" %")[0]) / 100.0
    box = case.container
    walls = 2.0 * box.wall_m * (box.width_m + (box.depth_m or box.width_m))
    assert 0.5 < told / (24525.0 / walls / 1e6) < 3.0


def test_a_run_that_turns_a_cell_inside_out_fails_and_says_where():
    case = load_case("seed_stack_plateau", ["solver.model=full", "container.section=solid", *SOFT])
    model = build_model(case)
    ending = simulate(model, Recorder(model))
    assert ending.status == "failed"
    assert ending.error is not None and "inside out" in ending.error and "youngs_modulus_Pa" in ending.error
    assert 0.0 < model.run.clock[0].time < 0.5


def test_a_step_that_fails_says_what_failed():
    model = build_model(load_case("seed_box", ["solver.model=rigid"]))
    weight = model.container.mesh.mass * model.case.gravity_m_s2
    told = {
        residual: stepping_failure(model, residual) for residual in (np.nan, np.inf, 1e-12 * weight, weight)
    }
    for message in told.values():
        assert message.startswith("step 1, t = 0 s: ") and "at the smallest step (" in message
        assert "try a" in message and "nan" not in message and "inf" not in message
    assert "grew beyond all numbers" in told[np.nan]
    assert "did not settle" in told[1e-12 * weight]
    assert f"out of balance by {weight:.2g} N" in told[weight]


def test_a_ledger_that_is_no_number_does_not_pass_the_audit():
    model = build_model(load_case("seed_box", ["solver.model=rigid"]))
    assert audit(model) is None
    model.run.ledger[0] = np.nan
    error = audit(model)
    assert error is not None and "no longer made of numbers" in error
