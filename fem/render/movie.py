"""A run as a film: GIF through pillow, MP4 where imageio-ffmpeg is installed, in real time.

Frames that follow one another faster than an eye or a browser can, are left out evenly.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from fem.render.picture import Scene, save_whole
from fem.results.reader import OpenedRun
from fem.results.run_folder import FolderError

try:
    import imageio_ffmpeg
except ImportError:  # 173 MB, and a GIF needs it not
    imageio_ffmpeg = None

FASTEST = 0.04  #: s between the frames of a film; browsers slow down what is faster than 0.02 s
SUFFIXES = (".gif", ".mp4")
MEND_VIDEO = "python -m pip install imageio-ffmpeg"
PALETTE_FRAMES = 5  #: from which the colours of a GIF are taken


def write_movie(
    run: OpenedRun, *, path: Path | None = None, progress: Callable[[int, int], None] = lambda done, all: None
) -> Path:
    """Render the frames of a run into a film.

    Args:
        run: with fields.
        path: the file, `.gif` or `.mp4`; None takes `figures/movie.gif` of the run.
        progress: called with the number of frames done and of all.

    Raises:
        FolderError, FieldError: no fields, a frame that is damaged, a file name that is no film's.
        OSError: the file cannot be written.
    """
    target = path or run.place.figures / "movie.gif"
    require_film(target)
    chosen, interval = frames_of_film(run.fields.times)
    scene = Scene(run)
    try:
        images = _rendered(run, scene, chosen, progress)
        write = _write_gif if target.suffix.lower() == ".gif" else _write_mp4
        return save_whole(target, lambda part: write(part, images, len(chosen), interval, scene.view.size))
    finally:
        scene.close()


def require_film(path: Path) -> None:
    """Refuse a file that is not to be a film, or one that nothing here can write, before anything is rendered."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise FolderError(f"--to must end with {' or '.join(SUFFIXES)}, got {path.name!r}")
    if suffix == ".mp4" and imageio_ffmpeg is None:
        raise FolderError(f"MP4 needs imageio-ffmpeg, which is not installed: {MEND_VIDEO}; or give a .gif")


def frames_of_film(times: np.ndarray) -> tuple[range, float]:
    """Indices of the frames that are shown, and the time between them [s]: real time, at most 25 a second."""
    if len(times) < 2:
        return range(len(times)), 1.0
    interval = float(times[1] - times[0])
    stride = max(1, round(FASTEST / interval)) if interval < FASTEST else 1
    return range(0, len(times), stride), stride * interval


def _rendered(
    run: OpenedRun, scene: Scene, chosen: range, progress: Callable[[int, int], None]
) -> Iterator[Image.Image]:
    for done, index in enumerate(chosen):
        progress(done, len(chosen))
        yield scene.image(run.fields.frame(index))
    progress(len(chosen), len(chosen))


def _write_gif(path: Path, images: Iterator[Image.Image], count: int, interval: float, size: Any) -> None:
    """One palette for all frames, so that what stands still is stored once."""
    first = [next(images) for _ in range(min(PALETTE_FRAMES, count))]
    palette = _beside(first).quantize(256, method=Image.Quantize.MEDIANCUT)

    def reduced() -> Iterator[Image.Image]:
        for image in (*first, *images):
            yield image.quantize(palette=palette, dither=Image.Dither.NONE)

    film = reduced()
    next(film).save(
        path,
        format="GIF",
        save_all=True,
        append_images=film,
        duration=max(20, 10 * round(100.0 * interval)),  # GIF counts hundredths of a second
        loop=0,
        optimize=False,
    )


def _write_mp4(
    path: Path, images: Iterator[Image.Image], count: int, interval: float, size: tuple[int, int]
) -> None:
    """H.264, as every player and slide program takes it."""
    writer = imageio_ffmpeg.write_frames(str(path), size, fps=1.0 / interval, macro_block_size=2)
    writer.send(None)
    try:
        for image in images:
            writer.send(np.asarray(image).tobytes())
    finally:
        writer.close()


def _beside(images: list[Image.Image]) -> Image.Image:
    wide = Image.new("RGB", (sum(image.width for image in images), images[0].height))
    left = 0
    for image in images:
        wide.paste(image, (left, 0))
        left += image.width
    return wide
