"""A response curve that is stopped continues to the same bytes, whatever its friction has been through."""

import os
import signal

import pytest

from fem.case.case import load_case
from fem.response.request import ResponseRequest
from fem.response.run import run_response
from fem.runtime.progress import SilentReporter

SLIPPING = (
    *("solver.model=rigid", "solver.element_size_m=1"),
    *("contact.mu_static=0.3", "contact.mu_kinetic=0.15", "contact.weakening_m=0.005"),
)

pytestmark = pytest.mark.usefixtures("undrawn")


class Stopping(SilentReporter):
    """Does something once, when the curve has come to a time [s]."""

    def __init__(self, time, act):
        self.time, self.act = time, act

    def update(self, time, rotation_ratio, mode):
        if time >= self.time:
            self.time = float("inf")
            self.act()


def killed():
    raise KeyboardInterrupt


def interrupted():
    os.kill(os.getpid(), signal.SIGINT)


def files_of(folder):
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.suffix in (".csv", ".json")}


@pytest.fixture(scope="module")
def asked():
    case = load_case("seed_stack_plateau", SLIPPING)
    return ResponseRequest(case=case, first_Hz=0.8, last_Hz=2.0, count=3, settle=4, observe=8)


@pytest.fixture(scope="module")
def whole(asked, tmp_path_factory):
    """The folder of the undisturbed curve."""
    folder = tmp_path_factory.mktemp("whole")
    points = run_response(asked, folder=folder)["points"]
    assert max(point["slip_stroke_m"] for point in points) > 0.01  # it breaks loose
    return folder


@pytest.mark.parametrize("act", [killed, interrupted])
def test_a_slipping_curve_stopped_at_every_point_continues_to_the_same_bytes(tmp_path, asked, whole, act):
    time, folder = 0.0, tmp_path / "stopped"
    for frequency in [0.8, 1.4, 2.0, 2.0, 1.4]:
        # killed within the point behind this one, or stopped by Ctrl-C within it, and so at its end
        reporter = Stopping(time + (0.0 if act is interrupted else 12.0) / frequency + 1.0, act)
        try:
            assert (
                run_response(asked, folder=folder, resume=True, reporter=reporter)["status"] == "interrupted"
            )
        except KeyboardInterrupt:
            assert act is killed
        time += 12.0 / frequency
    run_response(asked, folder=folder, resume=True)
    assert files_of(folder) == files_of(whole)
