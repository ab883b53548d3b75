"""Pictures of a run, through pyvista off screen: the container where it is, its stresses, the floor under it.

A scene is set up once for a run and moved from frame to frame, seen from the same place throughout, in parallel
projection. Displacements are true to scale. The floor slab carries hatches and a mark that move with it; the scale
at its foot stands still. Arrows below the base show the contact pressure.
"""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
import pyvista
from numpy.typing import NDArray
from PIL import Image

from fem.captions import (
    STRESS_MAP,
    caption,
    draw_foot,
    draw_stress_scale,
    rotation_at,
    write_caption,
)
from fem.fields import Frame
from fem.opening import OpenedRun
from fem.outline import outline_edges
from fem.run_folder import FolderError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: VTK's cells by their number of nodes
CELL_TYPES = {4: pyvista.CellType.QUAD, 9: pyvista.CellType.BIQUADRATIC_QUAD}
#: the bilinear quads that a cell is drawn as, by its number of nodes
PARTS = {4: ((0, 1, 2, 3),), 9: ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3))}

BODY, EDGE, SLAB, HATCH, ARROW, MARK = "#A9C1D6", "#333333", "#E4E1DC", "#A39E96", "#0072B2", "#222222"
STRESSED = 0.995  #: share of the nodes of a usual frame that the stress colours tell apart
SMOOTH = 8  #: samples a pixel, against stairs in slanted lines
CONTENT, LEAST_WIDTH = (1200, 760), 720  #: of the picture [pixels]
TOP, BOTTOM, SIDE, BAR = 112, 16, 24, 110  #: margins: text above, below, at the sides, scale bar [pixels]
SLAB_SHARE = 0.16  #: depth of the slab over the container's height or width
HATCH_SHARE = 0.2  #: distance of the hatches over the slab's depth, times their own length


@dataclass(frozen=True, kw_only=True)
class View:
    """What a scene encloses, fixed for all its frames."""

    left: float  #: of all that moves [m]
    right: float
    top: float
    depth: float  #: of the slab [m]
    floor: tuple[float, float]  #: range of the floor's displacement [m]

    @property
    def pixels_per_metre(self) -> float:
        """Scale of the picture."""
        return min(CONTENT[0] / (self.right - self.left), CONTENT[1] / (self.top + self.depth))

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture, even, as video wants them [pixels]."""
        width = (self.right - self.left) * self.pixels_per_metre + 2 * SIDE + BAR
        height = (self.top + self.depth) * self.pixels_per_metre + TOP + BOTTOM
        return 2 * math.ceil(0.5 * max(width, LEAST_WIDTH)), 2 * math.ceil(0.5 * height)

    @property
    def edges(self) -> tuple[float, float, float, float]:
        """Left, right, lower and upper edge of the picture [m]."""
        (width, height), scale = self.size, self.pixels_per_metre
        spare = (width - 2 * SIDE - BAR) / scale - (self.right - self.left)
        left = self.left - 0.5 * spare - SIDE / scale
        low = -self.depth - BOTTOM / scale
        return left, left + width / scale, low, low + height / scale


class Scene:
    """The moving parts of a picture, ready to be set to a frame and rendered.

    Args:
        run: with fields.

    Raises:
        FolderError, FieldError: no fields, or a frame that is damaged.
    """

    def __init__(self, run: OpenedRun) -> None:
        frames = list(run.fields)
        first = frames[0]
        self._run = run
        self.view = view_of(frames)
        self._pressed = np.flatnonzero(np.any([frame.contact_pressure > 0.0 for frame in frames], axis=0))
        largest = [frame.contact_pressure.max() for frame in frames]
        self._usual_pressure = float(np.median([p for p in largest if p > 0.0] or [1.0]))
        # Of a usual frame, not of an impact, beside which all other colours would be pale.
        stresses = [np.quantile(frame.von_mises, STRESSED) for frame in frames]
        self._stress_limit = _round_up(float(np.median(stresses)))
        # VTK says so when there is no display, and goes on without one.
        pyvista.vtk_verbosity("error")
        self._plotter = pyvista.Plotter(off_screen=True, window_size=list(self.view.size))
        self._plotter.set_background("white")  # type: ignore[arg-type]
        self._plotter.enable_anti_aliasing("msaa", multi_samples=SMOOTH)
        self._body, self._outline = body_of(first), outline_of(first, run.case.container.boxes)
        self._hatches, self._mark = hatches_of(self.view), mark_of(self.view)
        self._arrows = _arrows(len(self._pressed))
        self._resting = {
            id(self._hatches): self._hatches.points.copy(),
            id(self._mark): self._mark.points.copy(),
        }
        self._compose()
        self._stand()

    def image(self, frame: Frame) -> Image.Image:
        """The picture of a frame."""
        places = _spatial(frame.points + frame.displacement)
        self._body.points = places
        self._outline.points = places
        if self._stress_limit > 0.0:
            self._body.point_data["stress"] = 1e-6 * frame.von_mises
        for part in (self._hatches, self._mark):
            part.points = self._resting[id(part)] + (frame.floor_displacement, 0.0, 0.0)
        self._arrows.points = self._arrow_points(places[self._pressed], frame.contact_pressure[self._pressed])
        self._plotter.render()
        image = Image.fromarray(np.asarray(self._plotter.screenshot(return_img=True)))
        self._annotate(image, frame)
        return image

    def close(self) -> None:
        """Release the renderer."""
        self._plotter.close()

    def _compose(self) -> None:
        """Put everything into the picture, back to front."""
        plotter, view = self._plotter, self.view
        left, right, low, _ = view.edges
        slab = pyvista.PolyData(
            np.array([[left, low, -3], [right, low, -3], [right, 0, -3], [left, 0, -3]], dtype=float),
            [4, 0, 1, 2, 3],
        )
        plotter.add_mesh(slab, color=SLAB, lighting=False)
        plotter.add_mesh(self._hatches, color=HATCH, line_width=1.5, lighting=False)
        plotter.add_mesh(self._mark, color=MARK, lighting=False)
        plotter.add_lines(np.array([[left, 0, -2], [right, 0, -2]], dtype=float), color=EDGE, width=2)
        if self._stress_limit > 0.0:
            self._body.point_data["stress"] = np.zeros(self._body.n_points)
            plotter.add_mesh(
                self._body,
                scalars="stress",
                cmap=matplotlib.colormaps[STRESS_MAP],
                clim=(0.0, 1e-6 * self._stress_limit),
                lighting=False,
                show_scalar_bar=False,
            )
        else:
            plotter.add_mesh(self._body, color=BODY, lighting=False)
        plotter.add_mesh(self._outline, color=EDGE, line_width=2, lighting=False)
        plotter.add_mesh(self._arrows, color=ARROW, lighting=False)

    def _stand(self) -> None:
        """Look at the elevation from the front, at the scale of the view."""
        left, right, low, high = self.view.edges
        centre = (0.5 * (left + right), 0.5 * (low + high))
        camera = self._plotter.camera
        camera.parallel_projection = True
        camera.focal_point = (*centre, 0.0)
        camera.position = (*centre, 10.0)
        camera.up = (0.0, 1.0, 0.0)
        camera.parallel_scale = 0.5 * (high - low)
        camera.clipping_range = (1.0, 20.0)

    def _annotate(self, image: Image.Image, frame: Frame) -> None:
        """Write what the picture shows on it."""
        view = self.view
        write_caption(image, caption(self._run, frame), SIDE)
        if self._stress_limit > 0.0:
            surface = image.height - BOTTOM - int(view.depth * view.pixels_per_metre)
            draw_stress_scale(image, self._stress_limit, right=BAR, bottom=surface - 12)
        pressure = float(frame.contact_pressure.max())
        draw_foot(image, view.pixels_per_metre, pressure=pressure, left=SIDE)

    def _arrow_points(self, tips: FloatArray, pressure: FloatArray) -> FloatArray:
        """Corners of one arrow a pressed node, pointing up at it; as long as it is pressed, none where it is not."""
        depth = self.view.depth
        length = depth * np.minimum(0.42 * pressure / self._usual_pressure, 0.92)
        head = np.minimum(0.3 * depth, length)
        wide = 0.08 * depth * (length > 0.0)
        thin = 0.3 * wide
        tip, neck, tail = tips[:, 1], tips[:, 1] - head, tips[:, 1] - length
        x = tips[:, 0]
        corners = np.stack(
            [
                np.column_stack([across, up, np.full(len(x), 2.0)])
                for across, up in (
                    (x, tip),
                    (x - wide, neck),
                    (x + wide, neck),
                    (x - thin, neck),
                    (x + thin, neck),
                    (x + thin, tail),
                    (x - thin, tail),
                )
            ],
            axis=1,
        )
        return corners.reshape(-1, 3)


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
    return save_whole(target, lambda part: image.save(part, format="PNG", optimize=True))


def save_whole(path: Path, save: Callable[[Path], None]) -> Path:
    """Let a file be written beside its place and renamed: what is there is whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        save(part)
        os.replace(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
    return path


def time_of_largest_rotation(run: OpenedRun) -> float:
    """Time of the frame in which the container is turned most [s]."""
    return float(run.fields.times[np.argmax(np.abs(rotation_at(run, run.fields.times)))])


def view_of(frames: list[Frame]) -> View:
    """What encloses the whole motion of a series of frames."""
    low = np.min([(frame.points + frame.displacement).min(axis=0) for frame in frames], axis=0)
    high = np.max([(frame.points + frame.displacement).max(axis=0) for frame in frames], axis=0)
    size = float(np.ptp(frames[0].points, axis=0).max())
    floors = [frame.floor_displacement for frame in frames]
    return View(
        left=float(low[0]),
        right=float(high[0]),
        top=float(high[1]) + 0.02 * size,
        depth=SLAB_SHARE * size,
        floor=(min(floors), max(floors)),
    )


def grid_of(frame: Frame) -> pyvista.UnstructuredGrid:
    """A frame as a grid in the x-y plane, where the container stood, with its fields by their names in the files.

    `grid.warp_by_vector("displacement_m")` shows it where it is.
    """
    count, size = frame.cells.shape
    cells = np.column_stack([np.full(count, size), frame.cells]).ravel()
    grid = pyvista.UnstructuredGrid(cells, np.full(count, CELL_TYPES[size]), _spatial(frame.points))
    grid.point_data["displacement_m"] = _spatial(frame.displacement)
    grid.point_data["velocity_m_s"] = _spatial(frame.velocity)
    grid.point_data["von_mises_Pa"] = frame.von_mises
    grid.point_data["contact_pressure_Pa"] = frame.contact_pressure
    grid.cell_data["region"] = frame.region
    return grid


def body_of(frame: Frame) -> pyvista.PolyData:
    """The cells of a frame as flat faces on its nodes."""
    parts = frame.cells[:, PARTS[frame.cells.shape[1]]].reshape(-1, 4)
    return pyvista.PolyData(_spatial(frame.points), np.column_stack([np.full(len(parts), 4), parts]).ravel())


def outline_of(frame: Frame, boxes: int) -> pyvista.PolyData:
    """Outer edges of the container and the joints of its boxes, as lines on its nodes."""
    edges = outline_edges(frame.points, frame.cells, boxes)
    lines = np.column_stack([np.full(len(edges), 2), edges])
    return pyvista.PolyData(_spatial(frame.points), lines=lines.ravel())


def hatches_of(view: View) -> pyvista.PolyData:
    """Strokes below the surface of the floor, as far as it ever comes into the view."""
    left, right, _, _ = view.edges
    length = 0.5 * view.depth
    first = math.floor((left - view.floor[1]) / length)
    last = math.ceil((right - view.floor[0]) / length) + 1
    x = length * np.arange(first, last + 1)
    upper = np.column_stack([x, np.zeros(len(x)), np.full(len(x), -2.5)])
    lower = upper - (0.6 * length, 0.6 * length, 0.0)
    lines = np.column_stack([np.full(len(x), 2), np.arange(len(x)), np.arange(len(x)) + len(x)])
    return pyvista.PolyData(np.concatenate([upper, lower]), lines=lines.ravel())


def mark_of(view: View) -> pyvista.PolyData:
    """A mark on the floor where the middle of the container stood at first: slip shows as its distance."""
    size = 0.2 * view.depth
    points = [[0.0, 0.0, 1.5], [-0.6 * size, -size, 1.5], [0.6 * size, -size, 1.5]]
    return pyvista.PolyData(np.array(points), [3, 0, 1, 2])


def _arrows(count: int) -> pyvista.PolyData:
    """So many arrows, of no length yet."""
    corner = 7 * np.arange(count)[:, None]
    heads = np.column_stack([np.full(count, 3), corner + np.arange(3)])
    shafts = np.column_stack([np.full(count, 4), corner + np.arange(3, 7)])
    return pyvista.PolyData(np.zeros((7 * count, 3)), np.concatenate([heads.ravel(), shafts.ravel()]))


def _round_up(value: float) -> float:
    """The next of 1, 2, 5, 10, .. from a value; 0 of 0."""
    if not value > 0.0:
        return 0.0
    step = 10.0 ** math.floor(math.log10(value))
    return step * next(factor for factor in (1.0, 2.0, 5.0, 10.0) if factor * step >= value * (1.0 - 1e-9))


def _spatial(vectors: FloatArray) -> FloatArray:
    """(x, z) as (x, z, 0)."""
    return np.column_stack([vectors, np.zeros(len(vectors))])
