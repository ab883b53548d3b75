"""Text of a picture: case, time, state and rotation above it; scale, symbols and stress bar beside it.

Positions in pixels from the lower left corner. The font comes with matplotlib, so it is the same everywhere.
"""

import math
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pyvista

from fem.case.columns import NEIGHBOURS
from fem.html.units import one_two_five, rounded
from fem.model.floor_numbers import drawn_level
from fem.render.scene import BAR, BOTTOM, SIDE, View
from fem.results.errors import FolderError
from fem.results.fields import Frame
from fem.results.history import ANALYTIC_COLUMN
from fem.results.reader import OpenedRun
from fem.runtime.arrays import FloatArray
from fem.runtime.units import RATIO

INK, FAINT = "#222222", "#666666"
LONGEST = 62  #: characters of a title
BAR_SIZE = (18, 300)  #: width and largest height of the stress bar [pixels]
RULER = 120  #: longest ruler [pixels]
FONTS = Path(matplotlib.get_data_path()) / "fonts" / "ttf"


def rotations_at(run: OpenedRun, times: FloatArray) -> FloatArray:
    """Rotation at some times (n,) of the container, or of each loose box, from the history, shape (b, n) [rad].

    Of a row that of the container itself.

    Raises:
        FolderError: the history is missing, damaged or empty.
    """
    history = run.history
    if not len(history.modes):
        raise FolderError(f"{run.place.history}: holds no sample yet")
    others = (ANALYTIC_COLUMN, *NEIGHBOURS.names(NEIGHBOURS.numbers(run.case)))
    names = [name for name in history.numbers if name.endswith("rotation_rad") and name not in others]
    return np.array([np.interp(times, history["time_s"], history[name]) for name in names])


def caption(run: OpenedRun, frame: Frame) -> tuple[str, str]:
    """Title of a picture, and the lines below it: time and state, rotation and rotation ratio, a floor that slopes.

    Of a loose stack the box that has turned most is named.
    """
    rotations = rotations_at(run, np.array([frame.time]))[:, 0]
    most = int(np.argmax(np.abs(rotations)))
    rotation = float(rotations[most])
    sample = min(int(np.searchsorted(run.history["time_s"], frame.time - 1e-9)), len(run.history.modes) - 1)
    title = run.typed_result.title or run.name
    title = title if len(title) <= LONGEST else f"{title[: LONGEST - 3]}..."
    status = "" if run.status in ("completed", "overturned") else f" ({run.status})"
    degrees = f"{round(math.degrees(rotation), 2) + 0.0:.2f}".replace("-", "−")  # no minus zero
    ratio = RATIO.text(abs(rotation) / run.slenderness_angle)
    box = f" (box {most + 1})" if len(rotations) > 1 and not ratio.startswith("<") and ratio != "0" else ""
    lines = (
        f"t = {frame.time:.3f} s    {run.history.modes[sample]}",
        f"rotation {degrees}°{box}, rotation ratio {ratio}",
        drawn_level(run.case.floor.slope_percent),
    )
    return title + status, "\n".join(filter(None, lines))


def symbols(frame: Frame) -> str:
    """Meaning of the symbols on the floor."""
    highest = 1e-6 * float(frame.contact_pressure.max())
    arrows = (
        f"↑ contact pressure, up to {rounded(highest)} MPa" if highest > 0.0 else "no contact at this instant"
    )
    return f"▲ initial middle of the base    {arrows}"


class Captions:
    """The text on a picture; the first three change with the frame.

    Args:
        plotter: of the scene; view: that it shows.
        colours: pyvista's mapper of the stresses; None without them.
        stress_limit: end of their scale [Pa].
    """

    def __init__(self, plotter: pyvista.Plotter, view: View, colours: Any, stress_limit: float) -> None:
        self._plotter = plotter
        width, height = view.size
        self.title = self._write("", SIDE, height - 12, size=18, bold=True, align="top")
        self.lines = self._write("", SIDE, height - 41, size=17, align="top")
        self.symbols = self._write("", width - SIDE, 16, size=14, justify="right")
        self._draw_ruler(view)
        floor = BOTTOM + int(view.below * view.pixels_per_metre) + 12
        if colours is not None:
            tall = min(BAR_SIZE[1], int(0.6 * (height - floor)))
            self._draw_stress_bar(colours, stress_limit, view, floor, tall)
            text, colour, above = "von Mises\nstress [MPa]", INK, floor + tall + 18
        else:
            text, colour, above = "rigid:\nno stress\nis computed", FAINT, floor
        self._write(text, width - BAR - 4, above, size=14, colour=colour, align="bottom")

    def _write(
        self,
        text: str,
        x: float,
        y: float,
        *,
        size: int,
        colour: str = INK,
        bold: bool = False,
        justify: str = "left",
        align: str = "center",
    ) -> pyvista.Text:
        font = FONTS / f"DejaVuSans{'-Bold' if bold else ''}.ttf"
        written = pyvista.Text(text, position=(x, y))
        prop = written.prop
        prop.font_size, prop.color = size, colour
        prop.set_font_file(str(font))
        prop.SetLineSpacing(1.2)
        prop.justification_horizontal, prop.justification_vertical = justify, align
        self._plotter.add_actor(written)
        return written

    def _draw_ruler(self, view: View) -> None:
        """A ruler of 1, 2 or 5 times a power of ten in the lower left corner; it does not move with the floor."""
        left, _, low, _ = view.edges
        pixel = 1.0 / view.pixels_per_metre
        length = one_two_five(RULER * pixel, up=False)
        start, foot, tick = left + SIDE * pixel, low + 16 * pixel, 5 * pixel
        ends = (start, start + length)
        lines = [*((x, foot) for x in ends), *((x, foot + z) for x in ends for z in (-tick, tick))]
        self._plotter.add_lines(np.array([(*line, 4.0) for line in lines]), color=INK, width=2)
        self._write(f"{length:g} m", SIDE + length / pixel + 8, 16, size=14)

    def _draw_stress_bar(self, mapper: Any, limit: float, view: View, floor: int, tall: int) -> None:
        """Vertical bar of von Mises stress from 0 to the limit [Pa], above the floor."""
        width, height = view.size
        shares = (0.0, 0.25, 0.5, 0.75, 1.0)
        bar = self._plotter.add_scalar_bar(  # type: ignore[call-arg]
            title="",
            mapper=mapper,
            n_labels=0,
            vertical=True,
            position_x=1.0 - BAR / width,
            position_y=floor / height,
            width=BAR_SIZE[0] / width,
            height=tall / height,
        )
        bar.SetBarRatio(1.0)
        for share in shares:
            over = "≥ " if share == 1.0 else ""
            y = floor + share * tall
            self._write(over + rounded(1e-6 * share * limit), width - BAR + BAR_SIZE[0] + 9, y, size=14)
