"""`movie`: a run as GIF or MP4."""

import importlib
import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.cli.console import Quiet
from fem.render.opengl import require_rendering
from fem.results.reader import open_run
from fem.results.run_folder import naming_what_cannot_be_written


def movie(
    run: Path,
    /,
    *,
    to: Annotated[
        Path | None, Parameter(help="The film, .gif or .mp4; default: figures/movie.gif of the run.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Render the frames of a run into a film in real time; MP4 needs imageio-ffmpeg.

    Parameters
    ----------
    run:
        The folder of a run, such as outputs/NAME.
    """
    opened = open_run(run)
    _ = opened.fields  # without fields there is nothing to probe for
    require_rendering()
    # pyvista is loaded only where it can work.
    film = importlib.import_module("fem.render.movie")
    with naming_what_cannot_be_written(to.parent if to else run, "ask again, or elsewhere with --to FILE"):
        print(film.write_movie(opened, path=to, progress=_ignore if quiet else _tell))


def _tell(done: int, count: int) -> None:
    """One line on a terminal, and nothing elsewhere."""
    if sys.stderr.isatty():
        print(f"\r{done} of {count} frames", end="" if done < count else "\n", file=sys.stderr, flush=True)


def _ignore(done: int, count: int) -> None:
    pass
