"""A run as a movie in real time: GIF through pillow, MP4 where imageio-ffmpeg is installed.

Of frames closer in time than is asked for, or than a browser can show, every second, third, .. one is taken.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
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
TINY = 1e-9  #: [s]
LEAST_WIDTH, MOST_WIDTH = 100, 4000  #: pixels
SUFFIXES = (".gif", ".mp4")
MEND_VIDEO = "python -m pip install imageio-ffmpeg"
PALETTE_FRAMES = 5  #: first frames, from which the colours of a GIF are taken


@dataclass(frozen=True, kw_only=True)
class Cut:
    """What of a run is shown, and how.

    Raises:
        FolderError: a rate or a width outside its range.
    """

    begin: float = 0.0  #: [s]
    until: float = math.inf  #: [s]
    rate: float = 1.0 / SHORTEST  #: most frames a second of the movie
    width: int | None = None  #: of the movie in pixels; None: as rendered

    def __post_init__(self) -> None:
        if not 0.1 <= self.rate <= 60.0:  # also refuses nan
            raise FolderError(f"--fps must lie within 0.1 and 60, got {self.rate:g}")
        if self.width is not None and not LEAST_WIDTH <= self.width <= MOST_WIDTH:
            raise FolderError(f"--width must lie within {LEAST_WIDTH} and {MOST_WIDTH}, got {self.width}")

    def frames(self, times: np.ndarray) -> tuple[range, float]:
        """Indices of the frames shown, and the time between them [s], which is that of the motion.

        Raises:
            FolderError: no frame within the times asked for.
        """
        first, last = np.searchsorted(times, (self.begin - TINY, self.until + TINY))
        if first >= last:
            end = f"to {self.until:g} s" if math.isfinite(self.until) else "s on"
            span = f"{times[0]:g} to {times[-1]:g} s"
            raise FolderError(f"no frame from {self.begin:g} {end}; frames lie from {span}")
        if last - first < 2:
            return range(first, last), 1.0
        interval = float(times[first + 1] - times[first])
        stride = max(1, round(1.0 / (self.rate * interval)))
        return range(first, last, stride), stride * interval

    def sized(self, image: Image.Image) -> Image.Image:
        """The image at the width asked for; even numbers of pixels, as H.264 needs."""
        if self.width is None:
            return image
        height = self.width * image.height / image.width
        return image.resize((2 * round(self.width / 2), 2 * round(height / 2)), Image.Resampling.LANCZOS)


def write_movie(
    run: OpenedRun,
    *,
    path: Path | None = None,
    cut: Cut | None = None,
    progress: Callable[[int, int], None] = lambda done, all: None,
) -> Path:
    """Render the frames of a run into a movie.

    Args:
        run: with fields.
        path: the file, `.gif` or `.mp4`; None takes `figures/movie.gif` of the run.
        cut: part, rate and width; None takes the whole run.
        progress: called with the number of frames done and of all.

    Raises:
        FolderError, FieldError: no fields, none in this part, a damaged frame, a file name with another ending.
        OSError: the file cannot be written.
    """
    target, cut = path or run.place.figures / "movie.gif", cut or Cut()
    require_movie_file(target)
    chosen, interval = cut.frames(run.fields.times)
    scene = Scene(run)
    write = _write_gif if target.suffix.lower() == ".gif" else _write_mp4
    try:
        with TemporaryDirectory() as folder:
            movie = Path(folder) / target.name
            write(movie, map(cut.sized, _rendered(run, scene, chosen, progress)), interval)
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
