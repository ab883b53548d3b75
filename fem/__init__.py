"""What the container is and what the user touches: bodies, case, run, output, command line.

In a script or a notebook, `fem.load_case(name)` and `fem.case_from(mapping)` give a case, `case.replace({key: value})`
changes it, `fem.compute(case)` and `fem.compute_many(cases)` run it in memory, and `fem.open_run(folder)` opens the
results of `python -m fem run`. Without a case, `fem.slide_in_plane(..)` gives the path of a sliding body under two
horizontal components. `fem.compute_sweep`, `compute_ensemble`, `compute_list`, `compute_response` and `assess_site`
write the folder of a study and give its table. What is wrong with the input is a `ValueError` in words
(`fem.case.case.CaseError`).
"""

import importlib
import sys
from typing import TYPE_CHECKING, Any

from fem.runtime.left import left_words
from fem.runtime.signals import exit_on_signal

if TYPE_CHECKING:
    from fem.case.case import case_from, load_case
    from fem.cli.python import assess_site, compute_ensemble, compute_list, compute_response, compute_sweep
    from fem.run.compute import compute
    from fem.run.opened import open_run
    from fem.seismic.two_directions import slide_in_plane
    from fem.study.runner import compute_many

__all__ = [
    "assess_site", "case_from", "compute", "compute_ensemble", "compute_list", "compute_many", "compute_response",
    "compute_sweep", "load_case", "open_run", "slide_in_plane",
]  # fmt: skip

#: name -> where it is
PLACES = dict.fromkeys(__all__, "fem.cli.python") | {
    "case_from": "fem.case.case",
    "compute": "fem.run.compute",
    "compute_many": "fem.study.runner",
    "load_case": "fem.case.case",
    "open_run": "fem.run.opened",
    "slide_in_plane": "fem.seismic.two_directions",
}

# so it is while Python looks for the module of `python -m fem`, and never in a library
if sys.argv[:1] == ["-m"]:
    exit_on_signal()


def __getattr__(name: str) -> Any:
    """What the package gives away, loaded when it is first asked for: the command line answers without it."""
    if name not in PLACES:
        left = left_words(f"fem.{name}")
        raise AttributeError(
            f"fem.{name} {left}" if left else f"module {__name__!r} has no attribute {name!r}"
        )
    return getattr(importlib.import_module(PLACES[name]), name)


def __dir__() -> list[str]:
    """The names that the package gives away."""
    return [*__all__, "__all__", "__doc__", "__file__", "__name__", "__path__"]
