"""A run as a movie in real time, by the writers of pyvista: GIF, or MP4 where imageio-ffmpeg is installed."""

from contextlib import closing
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from fem.render.picture import Scene
from fem.results.errors import FolderError
from fem.results.reader import OpenedRun
from fem.runtime.own_files import write_atomically

WRITERS = {".gif": "imageio", ".mp4": "imageio_ffmpeg"}


def write_movie(run: OpenedRun, path: Path, *, begin: float, until: float, rate: float) -> None:
    """Render the frames of a run between two times [s], at most `rate` of them a second.

    Raises:
        FolderError, FieldError: no fields, none in this part, a damaged frame, a file name with another ending.
        OSError: the file cannot be written.
    """
    times, suffix = run.fields.times, path.suffix.lower()
    chosen = np.flatnonzero((times >= begin - 1e-9) & (times <= until + 1e-9))
    if suffix not in WRITERS:
        raise FolderError(f"--to must end with {' or '.join(WRITERS)}, got {path.name!r}")
    if find_spec(WRITERS[suffix]) is None:
        raise FolderError(f"a {suffix} needs the package imageio: python -m pip install 'imageio[ffmpeg]'")
    if not 0.1 <= rate <= 60.0:  # also refuses nan
        raise FolderError(f"--fps must lie within 0.1 and 60, got {rate:g}")
    if not chosen.size:
        span = f"{times[0]:g} to {times[-1]:g} s"
        raise FolderError(f"no frame from {begin:g} to {until:g} s; they lie from {span}")
    interval = float(times[chosen[1]] - times[chosen[0]]) if chosen.size > 1 else 1.0
    stride = max(1, round(1.0 / (rate * interval)))
    with TemporaryDirectory() as folder, closing(Scene(run)) as scene:
        movie, fps = Path(folder) / f"movie{suffix}", 1.0 / round(stride * interval, 6)
        open_writer: Any = scene.plotter.open_gif if suffix == ".gif" else scene.plotter.open_movie
        open_writer(
            movie, **({"fps": fps} if suffix == ".gif" else {"framerate": fps, "macro_block_size": 2})
        )
        for index in chosen[::stride]:
            scene.show(run.fields.frame(index))
            scene.plotter.write_frame()
        scene.close()  # ends the file
        write_atomically(path, movie.read_bytes())
