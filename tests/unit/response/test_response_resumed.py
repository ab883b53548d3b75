"""A response curve that is stopped or killed continues to the same bytes, whatever its friction has been through."""

import os
import signal

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


class Stopping(Reporter):
    """Does something once, at its so-manieth period."""

    def __init__(self, periods, act):
        self.periods, self.act = periods, act

    def update(self, time, rotation_ratio, mode):
        self.periods -= 1
        if self.periods == 0:
            self.act()


def killed():
    raise KeyboardInterrupt


def interrupted():
    os.kill(os.getpid(), signal.SIGINT)


def files_of(folder):
    return {
        path.name: path.read_bytes() for path in folder.rglob("*") if path.suffix in (".csv", ".json", ".svg")
    }


@pytest.fixture(scope="module")
def asked():
    case = load_case("seed_stack_plateau", SLIPPING)
    return ResponseRequest(case=case, first_Hz=0.8, last_Hz=2.0, count=3, settle=4, observe=8, starts=2)


@pytest.fixture(scope="module")
def whole(asked, tmp_path_factory):
    """The folder of the undisturbed curve."""
    folder = tmp_path_factory.mktemp("whole")
    points = run_response(asked, folder=folder)["points"]
    assert max(point["slip_stroke_m"] for point in points) > 0.01  # it breaks loose
    return folder


@pytest.mark.parametrize("act", [killed, interrupted])
def test_a_slipping_curve_stopped_again_and_again_continues_to_the_same_bytes(tmp_path, asked, whole, act):
    folder, stopped = tmp_path / "stopped", 0
    for _ in range(30):
        try:
            if (
                run_response(asked, folder=folder, resume=True, reporter=Stopping(90, act))["status"]
                == "completed"
            ):
                break
        except KeyboardInterrupt:
            assert act is killed
        stopped += 1
    assert stopped >= 2
    assert files_of(folder) == files_of(whole)
