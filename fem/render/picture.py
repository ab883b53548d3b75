"""Pictures and movies of a run, through pyvista off screen: the container in place, its stresses, the floor under it.

A scene is built once for a run and updated for every frame, from one point of view, in parallel projection.
Displacements are true to scale. The floor carries hatches and a mark that move with it; the ruler does not move.
Arrows below the base show the contact pressure. Text stands above (case, time, state, rotation) and beside it (scale,
symbols, stress bar), in pixels from the lower left corner, in the font of matplotlib, the same everywhere. Movies are
in real time, by the writers of pyvista: GIF, or MP4 where imageio-ffmpeg is installed.
"""

import io
import math
from contextlib import closing
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import matplotlib
import numpy as np
import pyvista
from PIL import Image

from fem.case.columns import NEIGHBOURS
from fem.html.units import one_two_five, rounded
from fem.model.floor_numbers import drawn_level
from fem.render.scene import (
    BAR,
    BOTTOM,
    SIDE,
    View,
    arrow_points,
    arrows,
    body_of,
    hatches_of,
    links_of,
    mark_of,
    outline_of,
    slab_of,
    spatial,
    summarise_frames,
    surface_of,
)
from fem.results.errors import FolderError
from fem.results.fields import Frame
from fem.results.history import ANALYTIC_COLUMN
from fem.results.reader import OpenedRun
from fem.runtime.arrays import FloatArray
from fem.runtime.own_files import make_folder, place_in, write_atomically
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
        bar = self._plotter.add_scalar_bar(  # type: ignore[call-arg]  # as declared, it lacks its `self`
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


BODY, EDGE, SLAB, HATCH, ARROW, MARK = "#A9C1D6", "#333333", "#E4E1DC", "#A39E96", "#0072B2", "#222222"
STRESS_MAP = "YlOrRd"  #: light at low stress, distinguishable by the colour-blind, grey in print
SMOOTH = 8  #: samples a pixel, against stairs in slanted lines


class Scene:
    """The picture of a run, ready to be set to a frame and rendered.

    Raises:
        FolderError, FieldError: no fields, or a frame that is damaged.
    """

    def __init__(self, run: OpenedRun) -> None:
        first, summary = run.fields.frame(0), summarise_frames(run.fields)
        self._run = run
        self.view = summary.view
        self._pressed, self._usual_pressure = summary.pressed, summary.usual_pressure
        # Of a usual frame: at the stress of an impact all other frames would be pale.
        self._stress_limit = one_two_five(summary.usual_stress, up=True)
        pyvista.vtk_verbosity("error")  # VTK warns of a missing display, and renders without one
        self.plotter = pyvista.Plotter(off_screen=True, window_size=list(self.view.size))
        self.plotter.set_background("white")  # type: ignore[arg-type]
        self.plotter.enable_anti_aliasing("msaa", multi_samples=SMOOTH)
        self._body, self._links, self._outline = body_of(first), links_of(first), outline_of(first)
        self._arrows = arrows(len(self._pressed))
        moving = hatches_of(self.view), mark_of(self.view)
        rising = slab_of(self.view), surface_of(self.view)  # they reach across the picture
        self._on_floor = [(mesh, mesh.points.copy(), 1.0) for mesh in moving]
        self._on_floor += [(mesh, mesh.points.copy(), 0.0) for mesh in rising]
        colours = self._add_meshes(*moving, *rising)
        self._captions = Captions(self.plotter, self.view, colours, self._stress_limit)
        left, right, low, high = self.view.edges
        centre, camera = (0.5 * (left + right), 0.5 * (low + high)), self.plotter.camera
        camera.parallel_projection = True  # from the front, at the scale of the view
        camera.focal_point = (*centre, 0.0)
        camera.position = (*centre, 10.0)
        camera.up = (0.0, 1.0, 0.0)
        camera.parallel_scale = 0.5 * (high - low)
        camera.clipping_range = (1.0, 20.0)

    def show(self, frame: Frame) -> None:
        """Set the scene to a frame."""
        places = spatial(frame.points + frame.displacement)
        self._body.points = places
        self._links.points = places - np.array([0.0, 0.0, 0.5])  # behind the body
        self._outline.points = places + np.array([0.0, 0.0, 0.5])  # before the body
        if self._stress_limit > 0.0 and frame.von_mises is not None:
            self._body.point_data["stress"] = 1e-6 * frame.von_mises
        for mesh, resting, follows in self._on_floor:
            mesh.points = resting + np.array([follows * frame.floor_displacement, frame.floor_lift, 0.0])
        self._arrows.points = arrow_points(
            places[self._pressed],
            frame.contact_pressure[self._pressed] / self._usual_pressure,
            depth=self.view.depth,
        )
        self._captions.title.input, self._captions.lines.input = caption(self._run, frame)
        self._captions.symbols.input = symbols(frame)
        self.plotter.render()

    def image(self, frame: Frame) -> Image.Image:
        """The picture of a frame."""
        self.show(frame)
        return Image.fromarray(np.asarray(self.plotter.screenshot(return_img=True)))

    def close(self) -> None:
        """Release the renderer."""
        self.plotter.close()

    def _add_meshes(
        self,
        hatches: pyvista.PolyData,
        mark: pyvista.PolyData,
        slab: pyvista.PolyData,
        surface: pyvista.PolyData,
    ) -> Any:
        """Add all meshes, back to front; return the mapper of the stresses, if any."""
        plotter = self.plotter
        plotter.add_mesh(slab, color=SLAB, lighting=False)
        plotter.add_mesh(hatches, color=HATCH, line_width=1.5, lighting=False)
        plotter.add_mesh(mark, color=MARK, lighting=False)
        plotter.add_mesh(surface, color=EDGE, line_width=2, lighting=False)
        colours = None
        if self._stress_limit > 0.0:
            self._body.point_data["stress"] = np.zeros(self._body.n_points)
            colours = plotter.add_mesh(
                self._body,
                scalars="stress",
                cmap=matplotlib.colormaps[STRESS_MAP],
                clim=(0.0, 1e-6 * self._stress_limit),
                lighting=False,
                show_scalar_bar=False,
            ).mapper
        else:
            plotter.add_mesh(self._body, color=BODY, lighting=False)
        if self._links.n_cells:
            plotter.add_mesh(self._links, color=HATCH, lighting=False)
        plotter.add_mesh(self._outline, color=EDGE, line_width=3, lighting=False, render_lines_as_tubes=True)
        plotter.add_mesh(self._arrows, color=ARROW, lighting=False)
        return colours


def write_picture(run: OpenedRun, *, time: float | None = None, path: Path | None = None) -> Path:
    """Render the frame nearest to a time into a PNG.

    Args:
        run: with fields.
        time: [s]; None takes the frame of the largest rotation.
        path: the file; None takes `figures/picture_TIME.png` of the run.

    Raises:
        FolderError, FieldError: no fields, a time outside them, a frame that is damaged.
        OSError: the file cannot be written.
    """
    if path is not None and path.suffix.lower() != ".png":
        raise FolderError(f"--to must end with .png, got {path.name!r}")
    instant = time_of_largest_rotation(run) if time is None else time
    times = run.fields.times
    if not times[0] <= instant <= times[-1]:
        raise FolderError(
            f"--time must lie within the frames, {times[0]:g} to {times[-1]:g} s, got {instant:g} s"
        )
    frame = run.frame(instant)
    target = path or run.place.figures / f"picture_{frame.time:.3f}s.png"
    scene = Scene(run)
    try:
        image = scene.image(frame)
    finally:
        scene.close()
    content = io.BytesIO()
    image.save(content, format="PNG", optimize=True)
    if path is None:
        place_in(run.folder, f"figures/{target.name}")
    else:
        make_folder(path.parent)
    write_atomically(target, content.getvalue())
    return target


def time_of_largest_rotation(run: OpenedRun) -> float:
    """Time of the frame with the largest rotation, of any box of a loose stack [s]."""
    rotations = np.abs(rotations_at(run, run.fields.times)).max(axis=0)
    return float(run.fields.times[np.argmax(rotations)])


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
