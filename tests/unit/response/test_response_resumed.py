"""A response curve that is stopped or killed continues to the same bytes, whatever its friction has been through."""

import pytest

from fem.case.case import load_case
from fem.response.request import ResponseRequest
from fem.response.run import run_response
from fem.runtime.progress import Reporter

SLIPPING = (
    *("solver.model=rigid", "solver.element_size_m=1"),
    *("contact.mu_static=0.3", "contact.mu_kinetic=0.15", "contact.weakening_m=0.005"),
)

pytestmark = pytest.mark.usefixtures("undrawn")


class Killing(Reporter):
    """Ends the curve at its so-manieth period."""

    def __init__(self, periods):
        self.periods = periods

    def update(self, time, rotation_ratio, mode):
        self.periods -= 1
        if self.periods == 0:
            raise KeyboardInterrupt


def files_of(folder):
    return {
        path.name: path.read_bytes() for path in folder.rglob("*") if path.suffix in (".csv", ".json", ".svg")
    }


def test_a_slipping_curve_killed_again_and_again_continues_to_the_same_bytes(tmp_path):
    case = load_case("seed_stack_plateau", SLIPPING)
    asked = ResponseRequest(case=case, first_Hz=0.8, last_Hz=2.0, count=3, settle=4, observe=8, starts=2)
    points = run_response(asked, folder=tmp_path / "whole")["points"]
    assert max(point["slip_stroke_m"] for point in points) > 0.01  # it breaks loose
    killed = 0
    while killed < 30:
        try:
            run_response(asked, folder=tmp_path / "killed", resume=True, reporter=Killing(90))
            break
        except KeyboardInterrupt:
            killed += 1
    assert 2 <= killed < 30
    assert files_of(tmp_path / "killed") == files_of(tmp_path / "whole")
