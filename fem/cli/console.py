"""What commands have in common: options that mean the same everywhere, and how a status becomes an exit code."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, Token

#: of a run, a sweep, a study: 0 computed, 3 could not be, 4 interrupted
EXIT_CODES = {"completed": 0, "overturned": 0, "failed": 3, "interrupted": 4}


def flag(text: str, *names: str) -> Parameter:
    """A switch without a negative form; by default named as the argument is."""
    return Parameter(name=names or None, negative=(), show_default=False, help=text)


def _whole(kind: type, tokens: Sequence[Token]) -> int:
    """A whole number as it stands; cyclopts would round 2.5 without a word."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"a whole number is needed, not {tokens[0].value!r}") from None


def _at_least_one(kind: type, count: int | None) -> None:
    if count is not None and count < 1:
        raise ValueError(f"at least one core is needed, not {count}")


def whole(text: str) -> Parameter:
    """A whole number; a fraction is refused."""
    return Parameter(help=text, converter=_whole)


Folder = Annotated[Path | None, Parameter(help="Folder of the results; default: outputs/NAME.")]
Overrides = Annotated[tuple[str, ...], flag("table.key=value; may be repeated.", "--set")]
Jobs = Annotated[
    int | None,
    Parameter(
        name=("--jobs", "-j"),
        show_default=False,
        help="Cores; default: all.",
        converter=_whole,
        validator=_at_least_one,
    ),
]
Force = Annotated[bool, flag("Compute anew, over what is there.")]
AsJson = Annotated[bool, flag("Print JSON.", "--json")]
Quiet = Annotated[bool, flag("No progress.", "--quiet", "-q")]
