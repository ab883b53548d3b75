"""The animation of a report: mesh, motion, deformation, stress and contact forces, small enough to be sent.

The motion has two parts: the rigid part (rotation and mass centre, from the history, every few milliseconds) and, in
every field frame, the elastic displacement in the frame that turns with the container (the mean-axis split: no
momentum, no angular momentum). So the page can enlarge the one and leave the other. Numbers are sent as integers in
units of the largest value of their kind: displacement and history with 16 bits, stress with 8. x to the right, z up,
rotation > 0 toward +x; forces on the container.
"""

import base64
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex
from numpy.typing import NDArray
from scipy.sparse import csr_array

from fem.model.model import Model
from fem.results.fields import Fields, Frame
from fem.results.history import History
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.assembly import FiniteElements
from fem.solid.edges import outline_edges
from mesh.region import Region

FIELD_BYTES = 2_400_000  #: of all frames, before base64 makes four thirds of it
LEAST_FRAMES = 40  #: where cells would leave fewer frames, the outline alone is sent
MOST_SAMPLES = 8000  #: of the history
WIDE_JOURNEY = 4.0  #: a floor that travels more widths is followed by the view
COLOURS = 64  #: of the stress scale
SHOWN_ELASTIC = 0.03  #: elastic displacement as first shown, over the height
SHOWN_ROUNDING = 0.002  #: rounding of the files that may show, over the height
TYPICAL = 90  #: per cent of the frames are shown with less than that: impacts must not set the scale
STRESS_SHARE = (
    98.0  #: per cent of all stresses within the colour scale: a corner's peak must not pale the rest
)
#: history columns of the player, by their name there
COLUMNS = {
    "rotation": "rotation_rad",
    "rate": "angular_velocity_rad_s",
    "x": "centre_x_m",
    "z": "centre_z_m",
    "base": "base_displacement_m",
    "slip": "slip_m",
    "uplift": "uplift_m",
    "normal": "normal_force_N",
    "shear": "shear_force_N",
}
#: .. of a floor that moves up and down
LIFT = {"lift": "base_vertical_displacement_m"}
SINGLE_PRECISION = 2.0**-24


@dataclass(frozen=True, kw_only=True, eq=False)
class AnimationFrame:
    """One frame, n nodes."""

    time: float  #: [s]
    centre: FloatArray  #: (2,) mass centre [m]
    rotation: float  #: mass-weighted best fit [rad]
    floor: tuple[float, float]  #: displacement of the floor, along x and upward [m]
    elastic: FloatArray  #: (n, 2) in the frame turning with the container [m]
    von_mises: FloatArray | None  #: (n,) [Pa]; None of a rigid container
    normal_force: FloatArray  #: (n_c,) at the contact nodes, compression positive [N]


@dataclass(frozen=True, kw_only=True, eq=False)
class Animation:
    """The drawn part of the mesh, and its frames."""

    centroid: FloatArray  #: (2,) of the undeformed container [m]
    points: FloatArray  #: (n, 2) of the drawn nodes, from the centroid [m]
    quads: IntArray  #: (m, 4) into `points`; none where only the outline is sent
    edges: IntArray  #: (k, 2) outline and borders between regions
    contact: IntArray  #: (n_c,) contact nodes, into `points`
    frames: list[AnimationFrame]  #: those sent; of the drawn nodes only

    @property
    def largest_stress(self) -> float:
        """Over the frames [Pa]."""
        return max((float(stress.max()) for stress in self.stresses), default=0.0)

    @property
    def stresses(self) -> list[FloatArray]:
        """Of the frames; none of a rigid container."""
        return [frame.von_mises for frame in self.frames if frame.von_mises is not None]

    @property
    def stress_scale(self) -> float:
        """The end of the colour scale [Pa]; 0 where there is no stress."""
        if self.largest_stress == 0.0:
            return 0.0
        return _round_up(float(np.percentile(self.stresses, STRESS_SHARE)))

    @property
    def largest_elastic(self) -> float:
        """Over the frames [m]."""
        return max((float(np.hypot(*frame.elastic.T).max()) for frame in self.frames), default=0.0)


def animation_of(model: Model, fields: Fields | None) -> Animation:
    """The frames of a run, thinned out to what a page can carry.

    Raises:
        ValueError, OSError: a frame that cannot be read, or does not belong to the model's mesh.
    """
    elements = model.container.elements
    contact = model.container.nodes[: model.container.support.index.size]
    count = len(fields) if fields else 0
    corners = np.asarray(elements.cells)[:, :4]
    edges = outline_edges(corners, len(Region) * elements.box + elements.region)
    whole = np.unique(np.concatenate([corners.ravel(), contact]))
    enough = FIELD_BYTES // min(max(count, 1), LEAST_FRAMES)
    quads = corners if 5 * whole.size <= enough else corners[:0]
    drawn = whole if len(quads) else np.unique(np.concatenate([edges.ravel(), contact]))
    stride = max(1, math.ceil(count * 5 * drawn.size / FIELD_BYTES))
    place = np.full(len(elements.nodes), -1)
    place[drawn] = np.arange(drawn.size)
    centroid = np.asarray(model.container.mesh.centroid)
    return Animation(
        centroid=centroid,
        points=elements.nodes[drawn] - centroid,
        quads=place[quads],
        edges=place[edges],
        contact=place[contact],
        frames=[_frame(model, fields.frame(k), drawn, contact) for k in range(0, count, stride)]
        if fields
        else [],
    )


def rigid_and_elastic(elements: FiniteElements, frame: Frame) -> tuple[FloatArray, float, FloatArray]:
    """Mass centre (2,) [m], rotation [rad] and elastic displacement (n, 2) [m] of a frame.

    The rotation is the mass-weighted best fit; the elastic part has no momentum and, in the best fit, no angular
    momentum.
    """
    if len(frame.displacement) != len(elements.nodes):
        raise ValueError(f"a frame of {len(frame.displacement)} nodes on a mesh of {len(elements.nodes)}")
    mass: csr_array = elements.mass
    share = mass @ np.ones(len(elements.nodes))
    share = share / share.sum()
    arm = elements.nodes - share @ elements.nodes
    position = elements.nodes + np.asarray(frame.displacement, dtype=float)
    centre = share @ position
    turned, weighted = position - centre, mass @ arm
    moment = np.sum(turned[:, 0] * weighted[:, 1] - turned[:, 1] * weighted[:, 0])
    rotation = math.atan2(moment, np.sum(turned * weighted))
    cosine, sine = math.cos(rotation), math.sin(rotation)
    back = turned @ np.array([[cosine, sine], [-sine, cosine]])
    return centre, rotation, back - arm


def player_data(shown: Animation, history: History, *, model: Model) -> dict[str, Any]:
    """What the script `player.js` reads, of a run with samples."""
    stride = max(1, math.ceil(len(history) / MOST_SAMPLES))
    names = COLUMNS | (LIFT if history.vertical else {})
    columns = {name: history[column][::stride] for name, column in names.items()}
    journey = max(float(np.ptp(columns[name])) for name in ("base", "lift") if name in columns)
    modes = sorted(set(history.modes))
    mesh, angle, scale = model.container.mesh, model.static.slenderness_angle, shown.stress_scale
    wide = len(shown.points) >= 65536
    index = "<u4" if wide else "<u2"
    # The page opens at the largest rotation that is not yet a fall: that is what one looks for.
    rotation = np.abs(history["rotation_rad"])
    opening = int(np.argmax(np.where(rotation < angle, rotation, -1.0)))
    return {
        "step": model.case.output.history_s * stride,
        "samples": len(columns["x"]),
        "columns": {name: packed_floats(values) for name, values in columns.items()},
        "modes": modes,
        "mode": packed(np.array([modes.index(mode) for mode in history.modes[::stride]]), "u1"),
        "angle": angle,
        "weight": model.static.weight,
        "width": mesh.width,
        "height": mesh.height,
        "centroid": shown.centroid.tolist(),
        "follow": journey > WIDE_JOURNEY * mesh.width,
        "points": packed_floats(shown.points.ravel()),
        "quads": packed(shown.quads.ravel(), index),
        "edges": packed(shown.edges.ravel(), index),
        "wide": wide,
        "contact": shown.contact.tolist(),
        "times": [frame.time for frame in shown.frames],
        "elastic": packed_floats(np.array([frame.elastic for frame in shown.frames]).ravel()),
        "stress": packed(_on_scale(shown.stresses, scale), "u1"),
        "stress_scale": scale,
        "normal": packed_floats(np.array([frame.normal_force for frame in shown.frames]).ravel()),
        "colours": colour_scale("YlGnBu", COLOURS),
        "first": float(history["time_s"][opening]),
    }


def exaggeration(shown: Animation, height: float) -> float:
    """Factor on the elastic displacement as first shown; 0 where there is none.

    Most frames then deform visibly. Frames are in single precision: a factor that would show its rounding as
    deformation is not taken.
    """
    if shown.largest_elastic == 0.0:
        return 0.0
    typical = float(np.percentile([np.hypot(*frame.elastic.T).max() for frame in shown.frames], TYPICAL))
    reach = max(float(np.abs(frame.centre).max()) for frame in shown.frames) + height
    most = SHOWN_ROUNDING * height / (SINGLE_PRECISION * reach)
    return max(1.0, round_down(min(SHOWN_ELASTIC * height / typical if typical else most, most)))


def exaggerations(shown: Animation, height: float) -> list[float]:
    """Factors to choose from; none where the container is rigid."""
    fit = exaggeration(shown, height)
    if fit == 0.0:
        return []
    return sorted({1.0, *(round_down(fit * factor) for factor in (0.1, 0.3, 1.0, 3.0) if fit * factor > 1.0)})


def colour_scale(name: str, count: int) -> list[str]:
    """A colour map of matplotlib from low to high, as hexadecimal codes."""
    return [str(to_hex(colour)) for colour in colormaps[name](np.linspace(0.0, 1.0, count))]


def packed_floats(values: NDArray[np.floating]) -> dict[str, Any]:
    """Numbers as 16-bit integers of the largest of them, in base64."""
    values = np.asarray(values, dtype=float)
    largest = float(np.abs(values).max()) if values.size else 0.0
    scaled = np.round(values * (32767.0 / largest)) if largest > 0.0 else np.zeros(values.shape)
    return {"largest": largest, "values": packed(scaled, "<i2")}


def packed(values: NDArray[Any], kind: str) -> str:
    """Integers of a numpy type in base64, little-endian."""
    return base64.b64encode(np.asarray(values).astype(kind).tobytes()).decode()


def _frame(model: Model, frame: Frame, drawn: IntArray, contact: IntArray) -> AnimationFrame:
    area = model.run.contact.normal_stiffness[: contact.size] / model.penalty
    centre, rotation, elastic = rigid_and_elastic(model.container.elements, frame)
    if model.case.solver.model == "rigid":  # what is left is the rounding of the files
        elastic = np.zeros_like(elastic)
    return AnimationFrame(
        time=frame.time,
        centre=centre,
        rotation=rotation,
        floor=(frame.floor_displacement, frame.floor_lift),
        elastic=elastic[drawn],
        von_mises=None if frame.von_mises is None else np.asarray(frame.von_mises, dtype=float)[drawn],
        normal_force=np.asarray(frame.contact_pressure, dtype=float)[contact] * area,
    )


def _on_scale(stresses: list[FloatArray], scale: float) -> NDArray[np.uint8]:
    if scale == 0.0:
        return np.zeros(0, dtype=np.uint8)
    return np.clip(np.round(255.0 * np.array(stresses).ravel() / scale), 0, 255).astype(np.uint8)


def _round_up(value: float) -> float:
    """1, 2, 5 times a power of ten, not below the value."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= value * (1.0 - 1e-9))


def round_down(value: float) -> float:
    """1, 2, 5 times a power of ten, not above the value."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= value * (1.0 + 1e-9))
