"""`movie`: a run as GIF or MP4."""

import importlib
import math
import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.cli.console import ELSEWHERE_TO, Quiet, RunFolder
from fem.render.opengl import require_rendering
from fem.results.disk import BYTES_BESIDE
from fem.results.errors import require_writable, writing_into
from fem.results.reader import open_run
from fem.run.expected import say_expected
from fem.runtime.progress import ScreenReporter

OF_A_FRAME_S = 0.09  #: to draw it, without a graphics card [s]


def movie(
    run: RunFolder,
    /,
    *,
    to: Annotated[
        Path | None, Parameter(help="The file, .gif or .mp4; default: figures/movie.gif of the run.")
    ] = None,
    begin: Annotated[float, Parameter(name="--from", help="Begin at this time of the run [s].")] = 0.0,
    until: Annotated[
        float, Parameter(help="End at this time [s]; default: the end of the run.", show_default=False)
    ] = math.inf,
    fps: Annotated[float, Parameter(help="Most frames a second.")] = 25.0,
    width: Annotated[
        int | None, Parameter(help="Width of the movie in pixels; default: as rendered.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Animate the frames of a run in real time; MP4 needs imageio-ffmpeg."""
    opened = open_run(run)
    _ = opened.fields  # raises where there are no frames to draw
    require_writable(to.parent if to else run, ELSEWHERE_TO, BYTES_BESIDE)
    require_rendering()
    # Loads pyvista.
    film = importlib.import_module("fem.render.movie")
    with writing_into(to.parent if to else run, ELSEWHERE_TO):
        cut = film.Cut(begin=begin, until=until, rate=fps, width=width)
        count = len(cut.frames(opened.fields.times)[0])
        if not quiet:
            say_expected(ScreenReporter(), f"{count} frames", OF_A_FRAME_S * count)
        print(film.write_movie(opened, path=to, cut=cut, progress=_ignore if quiet else _show))


def _show(done: int, count: int) -> None:
    """Progress on a terminal, nothing elsewhere."""
    if sys.stderr.isatty():
        print(f"\r{done} of {count} frames", end="" if done < count else "\n", file=sys.stderr, flush=True)


def _ignore(done: int, count: int) -> None:
    pass
