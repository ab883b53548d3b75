"""`init`: a commented case, sweep or ensemble file to start from."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.case.case import CaseError, load_case
from fem.case.files import CASES, ENSEMBLES, SWEEPS
from fem.case.template import case_template


def init(
    name: str | None = None,
    /,
    *,
    to: Annotated[Path | None, Parameter(help="The file to write; default: NAME.toml, or case.toml.")] = None,
) -> None:
    """Write a commented case, sweep or ensemble file to start from; a file that is already there is never overwritten.

    Parameters
    ----------
    name:
        A shipped case, sweep or ensemble (see `python -m fem list`); without it, a case file with every key there is.
    """
    computed_by = ""
    if name is None:
        text = case_template(load_case())
    elif name in SWEEPS.names:
        text, computed_by = SWEEPS.text(name), "sweep"
    elif name in ENSEMBLES.names:
        text, computed_by = ENSEMBLES.text(name), "ensemble"
    else:
        text = CASES.text(name)
    path = to if to is not None else Path(f"{name or 'case'}.toml")
    try:
        with path.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise CaseError(
            f"{path} is already there and is not overwritten; give another name with --to"
        ) from None
    except OSError as error:
        raise CaseError(
            f"{path}: cannot be written ({error.strerror or error}); give another place with --to"
        ) from None
    if computed_by:
        print(f"{path} written; python -m fem {computed_by} {path} computes it")
        return
    print(f"{path} written; python -m fem check {path} looks at it, python -m fem run {path} computes it")
