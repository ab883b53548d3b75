"""Figure cache: the figures of a run in its folder, SVG files and `drawn.json` with their metadata.

Drawing takes longer than all the rest of a report, so a report reuses the figures if the metadata match: drawn by the
same program from the same results, and not changed since.
"""

import hashlib
import importlib
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fem.html.page import Drawing, require_drawing
from fem.model.container import Container
from fem.results.json_block import to_json
from fem.results.reader import OpenedRun
from fem.results.run_files import RunFiles
from fem.runtime.identity import program_identity
from fem.runtime.own_files import place_in, remove, write_atomically
from fem.runtime.user_files import read_json, read_text


def write_figures(run: OpenedRun, container: Container) -> list[Path]:
    """Draw all figures of a run into its folder `figures`, as SVG; returns the files.

    Raises:
        FolderError: the history is missing or damaged.
        OSError: the folder or a file cannot be written.
    """
    files, drawings = run.place, _draw(run, container)
    remove(place_in(files.path, "figures/drawn.json"))
    for drawing in drawings:
        write_atomically(_svg(files, drawing.name), drawing.svg)
    metadata = _identity(files) | {"figures": [_metadata(drawing) for drawing in drawings]}
    write_atomically(files.drawn, to_json(metadata))
    return [_svg(files, drawing.name) for drawing in drawings]


def drawings_of(run: OpenedRun, container: Container) -> dict[str, Drawing]:
    """Figures of a run by name, in the order of reading: from the cache, or else drawn; FolderError as `figures_of`."""
    drawings = _cached(run.place)
    if drawings is None:
        drawings = _draw(run, container)
    return {drawing.name: drawing for drawing in drawings}


def _draw(run: OpenedRun, container: Container) -> list[Drawing]:
    # Importing matplotlib takes most of a second, which a cached figure does not need.
    drawings: list[Drawing] = importlib.import_module("fem.figures.run").draw_all(run, container)
    return drawings


def _cached(files: RunFiles) -> list[Drawing] | None:
    """The drawings in a folder; None if one is missing, changed or out of date."""
    try:
        metadata = read_json(files.drawn)
        figures = metadata.pop("figures")
        # A name becomes a path, and ids in a page.
        if metadata != _identity(files) or not all(figure["name"].isidentifier() for figure in figures):
            return None
        drawings = []
        for figure in figures:
            svg = read_text(_svg(files, figure["name"]))
            require_drawing(svg)
            drawings.append(Drawing(**(figure | {"svg": svg})))
        return drawings if [_metadata(drawing) for drawing in drawings] == figures else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _identity(files: RunFiles) -> dict[str, Any]:
    """Identity of the program and digests of the files from which the figures are drawn."""
    sources = (files.result, files.resolved, files.history, files.rigid_check)
    return {"program": program_identity(), "drawn_from": {path.name: _digest(path) for path in sources}}


def _metadata(drawing: Drawing) -> dict[str, Any]:
    """Metadata of a drawing: the digest of its SVG in place of the text."""
    return asdict(drawing) | {"svg": hashlib.sha256(drawing.svg.encode()).hexdigest()}


def _svg(files: RunFiles, name: str) -> Path:
    return files.figures / f"{name}.svg"


def _digest(path: Path) -> str | None:
    """SHA-256 of a file; None if it is missing."""
    if not path.is_file():
        return None
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
