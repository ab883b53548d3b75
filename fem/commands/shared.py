"""What commands have in common: options that mean the same everywhere, and how a status becomes an exit code."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.case import CaseError

#: of a run, a sweep, a study: 0 computed, 3 could not be, 4 interrupted
EXIT_CODES = {"completed": 0, "overturned": 0, "failed": 3, "interrupted": 4}


def flag(text: str, *names: str) -> Parameter:
    """A switch without a negative form; by default named as the argument is."""
    return Parameter(name=names or None, negative=(), show_default=False, help=text)


Folder = Annotated[Path | None, Parameter(help="Folder of the results; default: outputs/NAME.")]
Overrides = Annotated[tuple[str, ...], flag("table.key=value; may be repeated.", "--set")]
Jobs = Annotated[
    int | None, Parameter(name=("--jobs", "-j"), show_default=False, help="Cores; default: all.")
]
Force = Annotated[bool, flag("Compute anew, over what is there.")]
AsJson = Annotated[bool, flag("Print JSON.", "--json")]
Quiet = Annotated[bool, flag("No progress.", "--quiet", "-q")]


def require_cores(jobs: int | None) -> None:
    """Refuse a number of cores that computes nothing.

    Raises:
        CaseError: less than one.
    """
    if jobs is not None and jobs < 1:
        raise CaseError(f"-j {jobs}: at least one core is needed")
