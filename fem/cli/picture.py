"""`picture`: one instant of a run as PNG."""

import importlib
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.cli.console import ELSEWHERE_TO, RunFolder
from fem.render.opengl import require_rendering
from fem.results.errors import writing_into
from fem.results.reader import open_run


def picture(
    run: RunFolder,
    /,
    *,
    time: Annotated[
        float | None, Parameter(help="Instant [s]; default: the frame of the largest rotation.")
    ] = None,
    to: Annotated[
        Path | None, Parameter(help="The PNG; default: figures/picture_TIME.png of the run.")
    ] = None,
) -> None:
    """Draw the deformed container on its floor: stress, contact pressure, time and rotation ratio."""
    opened = open_run(run)
    _ = opened.fields  # raises where there are no frames to draw
    require_rendering()
    # Loads pyvista.
    pictures = importlib.import_module("fem.render.picture")
    with writing_into(to.parent if to else run, ELSEWHERE_TO):
        print(pictures.write_picture(opened, time=time, path=to))
