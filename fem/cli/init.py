"""`init`: a commented case, sweep, ensemble or site file to start from."""

import tomllib
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.case.case import CaseError, load_case
from fem.case.files import CASES, COLLECTIONS, COMMANDS
from fem.case.template import case_template
from fem.runtime.own_files import created
from fem.runtime.terminal import say


def init(
    name: str | None = None,
    /,
    *,
    to: Annotated[Path | None, Parameter(help="The file; default: NAME.toml, or case.toml.")] = None,
) -> None:
    """Write a commented case, sweep, ensemble or site file to start from; an existing file is never overwritten.

    Parameters
    ----------
    name:
        A shipped case, sweep, ensemble or site (see `python -m fem list`); default: a case file with every key.
    """
    of = next((each for each in COLLECTIONS if name in each.names), CASES)
    text = case_template(load_case()) if name is None else of.text(name)
    if name is not None and of is CASES:
        text = _for_another_box(text)
    path = to if to is not None else Path(f"{name or 'case'}.toml")
    try:
        with created(path) as stream:
            stream.write(text.encode())
    except FileExistsError:
        raise CaseError(f"{path} exists and is not overwritten; give another name with --to") from None
    except OSError as error:
        raise CaseError(
            f"{path}: cannot be written ({error.strerror or error}); choose another place with --to"
        ) from None
    say(f"{path} written; next:")
    if of is CASES:
        say(f"  python -m fem check {path}    static checks and settings, nothing is computed")
    say(f"  python -m fem {COMMANDS[of.kind]} {path}")


def _for_another_box(text: str) -> str:
    """Without [static] and what the box of the file alone has below it: a freight container keeps its corners."""
    left = {"static", "floor.corner_patch_m"}
    if "corner_post_N" not in tomllib.loads(text)["container"]:  # posts and castings by ISO 1496-1
        left |= {"support", "container.post_m"}
    table, kept = "", []
    for line in text.splitlines(keepends=True):
        if line.startswith("["):
            table = line[1:].partition("]")[0]
        if left.isdisjoint((table, f"{table}.{line.partition('=')[0].strip()}")):
            kept.append(line)
    return "".join(kept)
