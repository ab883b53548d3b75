"""A start that the contact cannot carry is refused; one that it can carry begins with its energy in order."""

import pytest

from fem.case.case import CaseError, load_case
from fem.cli.check import preview_of
from fem.model.model import build_model
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

TILTED = (
    "solver.model=rigid",
    "solver.duration_s=0.2",
    "initial.rotation_rad=0.1",
    "solver.element_size_m=0.5",
)
SOFT = ("container.section=solid", "container.youngs_modulus_Pa=1e6", "support.kind=flat")


def test_a_corner_that_sinks_in_so_far_that_its_spring_throws_the_container_is_refused():
    with pytest.raises(
        CaseError, match=r"rotation_rad = 0.1 rad: the corner .* would sink in by .* of the width"
    ):
        build_model(load_case("rocking", [*TILTED, *SOFT]))
    build_model(load_case("rocking", [*TILTED, *SOFT, "container.youngs_modulus_Pa=2.1e11"]))


def test_a_floor_into_which_the_container_sinks_by_itself_is_refused_by_check_and_run():
    case = load_case("rocking", ["solver.model=rigid", "contact.normal_penalty_Pa_m=1e4"])
    reason = r"normal_penalty_Pa_m = 1e\+04 Pa/m: the container would sink in by 8.11 m under its weight"
    with pytest.raises(CaseError, match=reason):
        build_model(case)
    with pytest.raises(CaseError, match=reason):
        preview_of(case).to_json()


def test_friction_without_springs_begins_without_their_energy():
    # Its springs, stretched by the friction of the tilted stance, held 2 % of the energy to overturn, and lost them.
    overrides = ["contact.friction=regularised", "contact.tangential_ratio=0.01", "initial.rotation_rad=0.02"]
    model = build_model(load_case("rocking", [*TILTED, *overrides]))
    assert not model.run.old.stick.any()
    assert simulate(model, Recorder(model)).status == "completed"
