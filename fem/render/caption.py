"""What is written on a picture: case, time, state, rotation, stress scale, a metre; drawn over the rendered scene.

Positions in pixels from the upper left corner. The fonts are those that come with matplotlib.
"""

import math
from functools import cache
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fem.assessment.summary import ratio_in_words
from fem.assessment.verdict import rotation_ratio
from fem.figures.style import number
from fem.results.fields import Frame
from fem.results.reader import OpenedRun
from fem.results.run_folder import FolderError
from fem.runtime.arrays import FloatArray

STRESS_MAP = "YlOrRd"  #: light where little is stressed, told apart by the colour-blind, grey in print
INK, FAINT = "#222222", "#666666"
LONGEST = 62  #: characters of a title
BAR = (18, 300)  #: width and largest height of the stress scale [pixels]
METRE = 120  #: longest ruler [pixels]


def rotation_at(run: OpenedRun, times: FloatArray | float) -> FloatArray:
    """Rotation at some times, from the history [rad].

    Raises:
        FolderError: the history is missing, damaged or empty.
    """
    history = run.history
    if not len(history):
        raise FolderError(f"{run.place.history}: holds no sample yet")
    return np.asarray(np.interp(times, history["time_s"], history["rotation_rad"]))


def caption(run: OpenedRun, frame: Frame) -> tuple[str, str, str]:
    """What stands above a picture: the case; time and state; rotation and rotation ratio."""
    rotation = float(rotation_at(run, frame.time))
    sample = min(int(np.searchsorted(run.history["time_s"], frame.time - 1e-9)), len(run.history) - 1)
    title = str(run.result.get("title") or run.name)
    title = title if len(title) <= LONGEST else f"{title[: LONGEST - 3]}..."
    whole = "" if run.status in ("completed", "overturned") else f" ({run.status})"
    degrees = f"{round(math.degrees(rotation), 2) + 0.0:.2f}".replace("-", "−")  # no minus zero
    ratio = ratio_in_words(rotation_ratio(rotation, run.slenderness_angle))
    return (
        title + whole,
        f"t = {frame.time:.3f} s    {run.history.modes[sample]}",
        f"rotation {degrees}°, rotation ratio {ratio}",
    )


def write_caption(image: Image.Image, lines: tuple[str, str, str], left: int) -> None:
    """Title and two lines below it in the upper left corner."""
    pen, top = ImageDraw.Draw(image), 12
    for text, font, step in zip(
        lines, (_font(18, bold=True), _font(17), _font(17)), (30, 25, 25), strict=True
    ):
        pen.text((left, top), text, fill=INK, font=font)
        top += step


def draw_stress_scale(image: Image.Image, limit: float, *, right: int, bottom: int) -> None:
    """A vertical scale of von Mises stress from 0 to the limit [Pa], its foot at `bottom`."""
    pen, font = ImageDraw.Draw(image), _font(14)
    width, height = BAR[0], min(BAR[1], int(0.6 * bottom))
    left, top = image.width - right, bottom - height
    shades = 255.0 * matplotlib.colormaps[STRESS_MAP](np.linspace(1.0, 0.0, height))[:, None, :3]
    bar = np.broadcast_to(shades, (height, width, 3)).round().astype(np.uint8)
    image.paste(Image.fromarray(bar), (left, top))
    pen.rectangle((left - 1, top - 1, left + width, bottom), outline=FAINT)
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        place = bottom - 1 - share * (height - 1)
        pen.line((left + width, place, left + width + 5, place), fill=FAINT)
        over = "≥ " if share == 1.0 else ""
        pen.text((left + width + 9, place), over + number(1e-6 * share * limit), INK, font, anchor="lm")
    pen.text((left - 4, top - 34), "von Mises\nstress [MPa]", fill=INK, font=font, anchor="ls", spacing=2)


def draw_no_stress(image: Image.Image, *, right: int, bottom: int) -> None:
    """Where the scale would stand: that there is none, its foot at `bottom`."""
    pen = ImageDraw.Draw(image)
    text = "rigid:\nno stress\nis known"
    pen.text((image.width - right - 4, bottom), text, fill=FAINT, font=_font(14), anchor="ld", spacing=2)


def draw_foot(image: Image.Image, pixels_per_metre: float, *, pressure: float, left: int) -> None:
    """In the lower corners: a ruler, which stands still, and what the signs on the floor mean.

    Args:
        image: drawn on.
        pixels_per_metre: scale of the picture.
        pressure: largest contact pressure at this instant [Pa].
        left: margin [pixels].
    """
    pen, font = ImageDraw.Draw(image), _font(14)
    longest = METRE / pixels_per_metre
    length = 10.0 ** math.floor(math.log10(longest))
    length *= max(step for step in (1.0, 2.0, 5.0) if step * length <= longest)
    end, foot = left + length * pixels_per_metre, image.height - 16
    pen.line((left, foot, end, foot), fill=INK, width=2)
    for x in (left, end):
        pen.line((x, foot - 5, x, foot + 5), fill=INK, width=2)
    pen.text((end + 8, foot), f"{length:g} m", fill=INK, font=font, anchor="lm")
    meaning = f"▲ middle of the base at first    ↑ contact pressure, up to {number(1e-6 * pressure)} MPa"
    pen.text((image.width - left, foot), meaning, fill=INK, font=font, anchor="rm")


@cache
def _font(size: int, *, bold: bool = False) -> ImageFont.FreeTypeFont:
    folder = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    return ImageFont.truetype(folder / f"DejaVuSans{'-Bold' if bold else ''}.ttf", size)
