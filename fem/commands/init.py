"""`init`: a commented case or sweep file to start from."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.case import CaseError, load_case
from fem.case_files import shipped_text
from fem.case_template import case_template
from fem.sweep.shipped import SHIPPED_SWEEPS, shipped_sweep_text


def init(
    name: str | None = None,
    /,
    *,
    to: Annotated[Path | None, Parameter(help="The file to write; default: NAME.toml, or case.toml.")] = None,
) -> None:
    """Write a commented case or sweep file to start from; a file that is already there is never overwritten.

    Parameters
    ----------
    name:
        A shipped case or sweep (see `python -m fem list`); without it, a case file with every key there is.
    """
    is_sweep = name in SHIPPED_SWEEPS
    if name is None:
        text = case_template(load_case())
    else:
        text = shipped_sweep_text(name) if is_sweep else shipped_text(name)
    path = to if to is not None else Path(f"{name or 'case'}.toml")
    try:
        with path.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise CaseError(
            f"{path} is already there and is not overwritten; give another name with --to"
        ) from None
    if is_sweep:
        print(f"{path} written; python -m fem sweep {path} computes it")
        return
    print(f"{path} written; python -m fem check {path} looks at it, python -m fem run {path} computes it")
