"""Pictures of a run, through pyvista off screen: the container in place, its stresses, the floor under it.

A scene is built once for a run and updated for every frame, from one point of view, in parallel projection.
Displacements are true to scale. The floor carries hatches and a mark that move with it; the ruler does not move.
Arrows below the base show the contact pressure.
"""

import io
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pyvista
from PIL import Image

from fem.html.units import one_two_five
from fem.render.caption import Captions, caption, rotations_at, symbols
from fem.render.scene import (
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
from fem.results.reader import OpenedRun
from fem.runtime.own_files import make_folder, place_in, write_atomically

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
