"""A run as a movie in real time: GIF through pillow, MP4 where imageio-ffmpeg is installed.

Of frames closer in time than a browser can show, only every second, third, .. one is taken.
"""

from collections.abc import Callable, Iterator
from itertools import chain, islice
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image

from fem.render.picture import Scene
from fem.results.errors import FolderError
from fem.results.files import write_atomically
from fem.results.reader import OpenedRun

try:
    import imageio_ffmpeg
except ImportError:  # optional: 173 MB, not needed for a GIF
    imageio_ffmpeg = None

SHORTEST = 0.04  #: time between frames [s]; browsers slow down anything faster than 0.02 s
SUFFIXES = (".gif", ".mp4")
MEND_VIDEO = "python -m pip install imageio-ffmpeg"
PALETTE_FRAMES = 5  #: first frames, from which the colours of a GIF are taken


def write_movie(
    run: OpenedRun, *, path: Path | None = None, progress: Callable[[int, int], None] = lambda done, all: None
) -> Path:
    """Render the frames of a run into a movie.

    Args:
        run: with fields.
        path: the file, `.gif` or `.mp4`; None takes `figures/movie.gif` of the run.
        progress: called with the number of frames done and of all.

    Raises:
        FolderError, FieldError: no fields, a damaged frame, a file name with another ending.
        OSError: the file cannot be written.
    """
    target = path or run.place.figures / "movie.gif"
    require_movie_file(target)
    chosen, interval = select_frames(run.fields.times)
    scene = Scene(run)
    write = _write_gif if target.suffix.lower() == ".gif" else _write_mp4
    try:
        with TemporaryDirectory() as folder:
            movie = Path(folder) / target.name
            write(movie, _rendered(run, scene, chosen, progress), interval)
            target.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(target, movie.read_bytes())
    finally:
        scene.close()
    return target


def require_movie_file(path: Path) -> None:
    """Refuse a file name that is no movie, or MP4 without its encoder, before anything is rendered."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise FolderError(f"--to must end with {' or '.join(SUFFIXES)}, got {path.name!r}")
    if suffix == ".mp4" and imageio_ffmpeg is None:
        raise FolderError(f"MP4 needs imageio-ffmpeg, which is not installed: {MEND_VIDEO}; or give a .gif")


def select_frames(times: np.ndarray) -> tuple[range, float]:
    """Indices of the frames shown, and the time between them [s]: real time, at most 25 a second."""
    if len(times) < 2:
        return range(len(times)), 1.0
    interval = float(times[1] - times[0])
    stride = max(1, round(SHORTEST / interval)) if interval < SHORTEST else 1
    return range(0, len(times), stride), stride * interval


def _rendered(
    run: OpenedRun, scene: Scene, chosen: range, progress: Callable[[int, int], None]
) -> Iterator[Image.Image]:
    for done, index in enumerate(chosen):
        progress(done, len(chosen))
        yield scene.image(run.fields.frame(index))
    progress(len(chosen), len(chosen))


def _write_gif(path: Path, images: Iterator[Image.Image], interval: float) -> None:
    """One palette for all frames, so that parts that do not move are stored once."""
    first = list(islice(images, PALETTE_FRAMES))
    side_by_side = Image.fromarray(np.concatenate([np.asarray(image) for image in first], axis=1))
    palette = side_by_side.quantize(256, method=Image.Quantize.MEDIANCUT)
    frames = (image.quantize(palette=palette, dither=Image.Dither.NONE) for image in chain(first, images))
    next(frames).save(
        path,
        format="GIF",
        save_all=True,
        append_images=frames,
        duration=max(20, 10 * round(100.0 * interval)),  # GIF counts hundredths of a second
        loop=0,
        optimize=False,
    )


def _write_mp4(path: Path, images: Iterator[Image.Image], interval: float) -> None:
    """H.264, which every player and slide program reads."""
    first = next(images)
    writer = imageio_ffmpeg.write_frames(str(path), first.size, fps=1.0 / interval, macro_block_size=2)
    writer.send(None)
    try:
        for image in chain([first], images):
            writer.send(np.asarray(image).tobytes())
    finally:
        writer.close()
