"""`picture`: one instant of a run as PNG."""

import importlib
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.render.opengl import require_rendering
from fem.results.reader import open_run
from fem.results.run_folder import naming_what_cannot_be_written


def picture(
    run: Path,
    /,
    *,
    time: Annotated[
        float | None, Parameter(help="Instant in s; default: the frame of the largest rotation.")
    ] = None,
    to: Annotated[
        Path | None, Parameter(help="The PNG; default: figures/picture_TIME.png of the run.")
    ] = None,
) -> None:
    """Render the deformed container on its floor: stress, contact pressure, time and rotation ratio.

    Parameters
    ----------
    run:
        The folder of a run, such as outputs/NAME.
    """
    opened = open_run(run)
    _ = opened.fields  # without fields there is nothing to probe for
    require_rendering()
    # pyvista is loaded only where it can work.
    pictures = importlib.import_module("fem.render.picture")
    with naming_what_cannot_be_written(to.parent if to else run, "ask again, or elsewhere with --to FILE"):
        print(pictures.write_picture(opened, time=time, path=to))
