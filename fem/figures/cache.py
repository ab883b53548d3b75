"""The figures of a run in its folder: SVG files, and a page that says of which results they are.

A report takes the drawings that lie there as they are: to draw them again would cost more than everything else in
it. It does so only where the page vouches for them - the same program drew them of the same results, and nobody has
changed them since - and draws them anew otherwise.
"""

import hashlib
import importlib
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fem.figures.style import Drawing
from fem.html.page import require_drawing
from fem.model.container import Container
from fem.results.reader import OpenedRun
from fem.results.run_folder import RunFolder, to_json, write_atomically
from fem.runtime.identity import program_identity


def write_figures(run: OpenedRun, container: Container) -> list[Path]:
    """Draw every figure of a run into its folder `figures`, as SVG.

    Args:
        run: finished or not.
        container: of its case.

    Returns:
        The files of the figures.

    Raises:
        FolderError: the history is missing or damaged.
        OSError: the folder or a file cannot be written.
    """
    place, drawings = run.place, _drawn(run, container)
    place.figures.mkdir(parents=True, exist_ok=True)
    place.drawn.unlink(missing_ok=True)
    for one in drawings:
        write_atomically(_file(place, one.name), one.svg)
    write_atomically(place.drawn, to_json(_identity(place) | {"figures": [_told(one) for one in drawings]}))
    return [_file(place, one.name) for one in drawings]


def drawings_of(run: OpenedRun, container: Container) -> dict[str, Drawing]:
    """The figures of a run by name, in the order of reading: those in its folder, or else drawn now.

    Args:
        run: finished or not.
        container: of its case.

    Raises:
        FolderError: the history is missing or damaged.
    """
    drawings = _kept(run.place)
    return {one.name: one for one in (_drawn(run, container) if drawings is None else drawings)}


def _drawn(run: OpenedRun, container: Container) -> list[Drawing]:
    # matplotlib takes most of a second to import; who finds the figures drawn does without it.
    drawn: list[Drawing] = importlib.import_module("fem.figures.run").draw_all(run, container)
    return drawn


def _kept(place: RunFolder) -> list[Drawing] | None:
    """The drawings in a folder; None unless they are all there, and of the results beside them."""
    try:
        page = json.loads(place.drawn.read_text(encoding="utf-8"))
        told = page.pop("figures")
        if page != _identity(place):
            return None
        drawings = []
        for one in told:
            if not one["name"].isidentifier():  # it becomes a path, and ids in a page
                return None
            svg = _file(place, one["name"]).read_text(encoding="utf-8")
            require_drawing(svg)
            drawings.append(Drawing(name=one["name"], title=one["title"], followed=one["followed"], svg=svg))
        return drawings if [_told(one) for one in drawings] == told else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _identity(place: RunFolder) -> dict[str, Any]:
    """Of the program and of the files that figures are drawn from."""
    files = (place.result, place.resolved, place.history, place.rigid_check)
    return {"program": program_identity(), "drawn_from": {path.name: _digest(path) for path in files}}


def _told(drawing: Drawing) -> dict[str, Any]:
    """What the page says of a drawing."""
    told = asdict(drawing)
    return told | {"svg": hashlib.sha256(told["svg"].encode()).hexdigest()}


def _file(place: RunFolder, name: str) -> Path:
    return place.figures / f"{name}.svg"


def _digest(path: Path) -> str | None:
    """SHA-256 of a file; None where there is none."""
    if not path.is_file():
        return None
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
