"""What the container is and what the user touches: bodies, case, run, output, command line.

`fem.open_run(folder)` opens the results of a run in a script or a notebook.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fem.opening import OpenedRun, open_run

__all__ = ["OpenedRun", "open_run"]


def __getattr__(name: str) -> Any:
    """What the package gives away, loaded when it is first asked for: the command line answers without it."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module("fem.opening"), name)
