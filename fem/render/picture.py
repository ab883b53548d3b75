"""Pictures of a run, through pyvista off screen: the container where it is, its stresses, the floor under it.

A scene is set up once for a run and moved from frame to frame, seen from the same place throughout, in parallel
projection. Displacements are true to scale. The floor slab carries hatches and a mark that move with it; the scale
at its foot stands still. Arrows below the base show the contact pressure.
"""

import math
import os
from collections.abc import Callable
from pathlib import Path

import matplotlib
import numpy as np
import pyvista
from PIL import Image

from fem.render.caption import (
    STRESS_MAP,
    caption,
    draw_foot,
    draw_no_stress,
    draw_stress_scale,
    rotation_at,
    write_caption,
)
from fem.render.scene import (
    BAR,
    BOTTOM,
    SIDE,
    arrow_points,
    arrows,
    body_of,
    hatches_of,
    mark_of,
    outline_of,
    spatial,
    survey,
)
from fem.results.fields import Frame
from fem.results.reader import OpenedRun
from fem.results.run_folder import FolderError

BODY, EDGE, SLAB, HATCH, ARROW, MARK = "#A9C1D6", "#333333", "#E4E1DC", "#A39E96", "#0072B2", "#222222"
SMOOTH = 8  #: samples a pixel, against stairs in slanted lines


class Scene:
    """The moving parts of a picture, ready to be set to a frame and rendered.

    Args:
        run: with fields.

    Raises:
        FolderError, FieldError: no fields, or a frame that is damaged.
    """

    def __init__(self, run: OpenedRun) -> None:
        first, seen = run.fields.frame(0), survey(run.fields)
        self._run = run
        self.view = seen.view
        self._pressed, self._usual_pressure = seen.pressed, seen.usual_pressure
        # Of a usual frame, not of an impact, beside which all other colours would be pale.
        self._stress_limit = _round_up(seen.usual_stress)
        # VTK says so when there is no display, and goes on without one.
        pyvista.vtk_verbosity("error")
        self._plotter = pyvista.Plotter(off_screen=True, window_size=list(self.view.size))
        self._plotter.set_background("white")  # type: ignore[arg-type]
        self._plotter.enable_anti_aliasing("msaa", multi_samples=SMOOTH)
        self._body, self._outline = body_of(first), outline_of(first, run.case.container.boxes)
        self._hatches, self._mark = hatches_of(self.view), mark_of(self.view)
        self._arrows = arrows(len(self._pressed))
        self._resting = {
            id(self._hatches): self._hatches.points.copy(),
            id(self._mark): self._mark.points.copy(),
        }
        self._compose()
        self._stand()

    def image(self, frame: Frame) -> Image.Image:
        """The picture of a frame."""
        places = spatial(frame.points + frame.displacement)
        self._body.points = places
        self._outline.points = places + np.array([0.0, 0.0, 0.5])  # before the body
        if self._stress_limit > 0.0 and frame.von_mises is not None:
            self._body.point_data["stress"] = 1e-6 * frame.von_mises
        for part in (self._hatches, self._mark):
            part.points = self._resting[id(part)] + (frame.floor_displacement, 0.0, 0.0)
        self._arrows.points = arrow_points(
            places[self._pressed],
            frame.contact_pressure[self._pressed] / self._usual_pressure,
            depth=self.view.depth,
        )
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
        plotter.add_mesh(self._outline, color=EDGE, line_width=3, lighting=False, render_lines_as_tubes=True)
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
        surface = image.height - BOTTOM - int(view.depth * view.pixels_per_metre)
        if self._stress_limit > 0.0:
            draw_stress_scale(image, self._stress_limit, right=BAR, bottom=surface - 12)
        else:
            draw_no_stress(image, right=BAR, bottom=surface - 12)
        pressure = float(frame.contact_pressure.max())
        draw_foot(image, view.pixels_per_metre, pressure=pressure, left=SIDE)


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


def _round_up(value: float) -> float:
    """The next of 1, 2, 5, 10, .. from a value; 0 of 0."""
    if not value > 0.0:
        return 0.0
    step = 10.0 ** math.floor(math.log10(value))
    return step * next(factor for factor in (1.0, 2.0, 5.0, 10.0) if factor * step >= value * (1.0 - 1e-9))
