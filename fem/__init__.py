"""What the container is and what the user touches: bodies, case, run, output, command line.

`fem.open_run(folder)` opens the results of a run in a script or a notebook.
"""

import importlib
import sys
from typing import TYPE_CHECKING, Any

from fem.runtime.signals import exit_on_signal

if TYPE_CHECKING:
    from fem.results.reader import OpenedRun, open_run

__all__ = ["OpenedRun", "open_run"]

if sys.argv[:1] == [
    "-m"
]:  # so it is while Python looks for the module of `python -m fem`, and never in a library
    exit_on_signal()


def __getattr__(name: str) -> Any:
    """What the package gives away, loaded when it is first asked for: the command line answers without it."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module("fem.results.reader"), name)
