"""`movie`: a run as GIF or MP4."""

import importlib
import math
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.cli.console import ELSEWHERE_TO, Quiet, RunFolder
from fem.render.opengl import require_rendering
from fem.results.disk import BYTES_BESIDE
from fem.results.errors import require_writable, writing_into
from fem.results.reader import open_run
from fem.run.expected import say_expected
from fem.runtime.own_files import make_folder, place_in
from fem.runtime.progress import ScreenReporter
from fem.runtime.terminal import say

OF_A_FRAME_S = 0.09  #: to draw it, without a graphics card [s]


def movie(
    run: RunFolder,
    /,
    *,
    to: Annotated[Path | None, Parameter(help="A .gif or .mp4; default: its figures/movie.gif.")] = None,
    begin: Annotated[float, Parameter(name="--from", help="Begin at this time of the run [s].")] = 0.0,
    until: Annotated[float, Parameter(help="End at this time of the run [s].")] = math.inf,
    fps: Annotated[float, Parameter(help="Most frames a second.")] = 25.0,
    quiet: Quiet = False,
) -> None:
    """Animate the frames of a run in real time; MP4 needs imageio-ffmpeg."""
    opened, path = open_run(run), to or run / "figures/movie.gif"
    count = len(opened.fields)  # raises where there are no frames to draw
    require_writable(to.parent if to else run, ELSEWHERE_TO, BYTES_BESIDE)
    require_rendering()
    say_expected(ScreenReporter(quiet=quiet), f"up to {count} frames", OF_A_FRAME_S * count)
    with writing_into(path.parent, ELSEWHERE_TO):
        if to is None:
            place_in(run, "figures/movie.gif")
        else:
            make_folder(path.parent)
        film = importlib.import_module("fem.render.movie")  # loads pyvista
        film.write_movie(opened, path, begin=begin, until=until, rate=fps)
    say(path)
