"""The animation of a report: mesh, motion, deformation, stress and contact forces, small enough to be sent.

The container is one body, or each box of a loose stack is. The motion of a body has two parts: the rigid part (rotation
and mass centre, from the history, every few milliseconds) and, in every field frame, the elastic displacement in the
frame that turns with it (the mean-axis split: no momentum, no angular momentum). So the page can enlarge the one and
leave the other. Numbers are sent as integers in units of the largest value of their kind: displacement and history with
16 bits, stress with 8. x to the right, z up, rotation > 0 toward +x; forces on the container.
"""

import base64
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from fem.html.units import one_two_five
from fem.model.model import Model
from fem.results.fields import Fields, Frame
from fem.results.history import History
from fem.run.drawn_links import DrawnLink, held_nodes
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
#: per cent of all stresses within the colour scale: a corner's peak must not pale the rest
STRESS_SHARE = 98.0
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
#: columns of a floor that moves up and down
LIFT = {"lift": "base_vertical_displacement_m"}
#: columns of a further box of a loose stack, whose number takes the place of the braces
BOX = {
    "rotation_{}": "{1}_{0}_rotation_rad",
    "slip_{}": "{1}_{0}_slip_m",
    "x_{}": "{1}_{0}_x_m",
    "z_{}": "{1}_{0}_z_m",
}
SINGLE_PRECISION = 2.0**-24
LASTING = 1e9  #: of a link that does not break; JSON has no infinity [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class AnimationFrame:
    """One frame, n nodes of b bodies."""

    time: float  #: [s]
    centre: FloatArray  #: (b, 2) mass centres [m]
    rotation: FloatArray  #: (b,) mass-weighted best fits [rad]
    floor: tuple[float, float]  #: displacement of the floor, along x and upward [m]
    elastic: FloatArray  #: (n, 2) in the frame turning with its body [m]
    von_mises: FloatArray | None  #: (n,) [Pa]; None of a rigid container
    normal_force: FloatArray  #: (n_c,) at the contact nodes, compression positive [N]


@dataclass(frozen=True, kw_only=True, eq=False)
class Animation:
    """The drawn part of the mesh, and its frames; b bodies from the floor up, one unless the boxes are loose."""

    centroid: FloatArray  #: (b, 2) of the undeformed bodies [m]
    body: IntArray  #: (n,) of each drawn node, from 0
    points: FloatArray  #: (n, 2) of the drawn nodes, from the centroid of their body [m]
    corners: IntArray  #: (b, 4) of each body, into `points`: lower left and right, upper left and right
    rests: FloatArray  #: (k, 4) rectangles that the undeformed boxes fill: left, bottom, right, top [m]
    quads: IntArray  #: (m, 4) into `points`; none where only the outline is sent
    edges: IntArray  #: (k, 2) outline and borders between regions
    contact: IntArray  #: (n_c,) contact nodes, into `points`
    frames: list[AnimationFrame]  #: those sent; of the drawn nodes only
    in_a_row: bool = False  #: each body stands on the floor
    links: tuple[DrawnLink, ...] = ()  #: stops and ties
    #: (k,) their points, into `points`
    held: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

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
        return one_two_five(float(np.percentile(self.stresses, STRESS_SHARE)), up=True)


def animation_of(model: Model, fields: Fields | None, links: tuple[DrawnLink, ...] = ()) -> Animation:
    """The frames of a run, thinned out to what a page can carry.

    Args:
        model: its containers.
        fields: its frames; None: it has none.
        links: its stops and ties, with when they broke.

    Raises:
        ValueError, OSError: a frame that cannot be read, or does not belong to the model's mesh.
    """
    elements, loose = model.container.elements, model.case.container.is_loose
    contact = model.container.nodes[: model.container.support.index.size]
    count = len(fields) if fields else 0
    quads = np.asarray(elements.cells)[:, :4]
    edges = outline_edges(quads, len(Region) * elements.box + elements.region)
    whole = np.unique(np.concatenate([quads.ravel(), contact]))
    enough = FIELD_BYTES // min(max(count, 1), LEAST_FRAMES)
    quads = quads if 5 * whole.size <= enough else quads[:0]
    drawn = whole if len(quads) else np.unique(np.concatenate([edges.ravel(), contact]))
    stride = max(1, math.ceil(count * 5 * drawn.size / FIELD_BYTES))
    drawn_index = np.full(len(elements.nodes), -1)
    drawn_index[drawn] = np.arange(drawn.size)
    bodies = (
        [_body(elements, nodes) for nodes in model.container.box_nodes]
        if model.container.row
        else bodies_of(elements, loose=loose)
    )
    centroid = np.array([fit.centre for fit in bodies])
    rests: list[list[float]] = []  # bolted boxes with the same sides are one
    for box in np.unique(elements.box):
        nodes = elements.nodes[np.unique(elements.cells[elements.box == box])]
        (left, bottom), (right, top) = nodes.min(axis=0).tolist(), nodes.max(axis=0).tolist()
        if rests and not loose and np.allclose(rests[-1][::2], (left, right)):
            rests[-1][3] = top
        else:
            rests.append([left, bottom, right, top])
    body = np.zeros(len(elements.nodes), dtype=np.int64)
    for k, fit in enumerate(bodies):
        body[fit.nodes] = k
    return Animation(
        centroid=centroid,
        body=body[drawn],
        points=elements.nodes[drawn] - centroid[body[drawn]],
        corners=drawn_index[[_corners(fit) for fit in bodies]],
        rests=np.array(rests),
        quads=drawn_index[quads],
        edges=drawn_index[edges],
        contact=drawn_index[contact],
        frames=[_frame(model, bodies, fields.frame(k), drawn, contact) for k in range(0, count, stride)]
        if fields
        else [],
        in_a_row=bool(model.container.row),
        links=links,
        held=held_nodes(links, elements.nodes[drawn]),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class BodyFit:
    """Splits the displacement of a body's n nodes into its rigid and its elastic part."""

    nodes: IntArray  #: (n,)
    rest: FloatArray  #: (n, 2) undeformed positions [m]
    share: FloatArray  #: (n,) of the mass
    centre: FloatArray  #: (2,) undeformed mass centre [m]
    weighted: FloatArray  #: (n, 2) mass times distance from the mass centre [kg m]

    def split(self, displacement: FloatArray) -> tuple[FloatArray, float, FloatArray]:
        """Mass centre (2,) [m], rotation [rad] and elastic displacement (n, 2) [m], from that of all nodes.

        The rotation is the mass-weighted best fit; the elastic part has no momentum and, in the best fit, no angular
        momentum.
        """
        position = self.rest + np.asarray(displacement, dtype=float)[self.nodes]
        centre = self.share @ position
        turned = position - centre
        moment = np.sum(turned[:, 0] * self.weighted[:, 1] - turned[:, 1] * self.weighted[:, 0])
        rotation = math.atan2(moment, np.sum(turned * self.weighted))
        cosine, sine = math.cos(rotation), math.sin(rotation)
        back = turned @ np.array([[cosine, sine], [-sine, cosine]])
        return centre, rotation, back - (self.rest - self.centre)


def bodies_of(elements: FiniteElements, *, loose: bool) -> list[BodyFit]:
    """The bodies from the floor up: the container, or each box of a loose stack."""
    boxes = [elements.box == k for k in np.unique(elements.box)] if loose else [slice(None)]
    return [_body(elements, np.unique(elements.cells[cells])) for cells in boxes]


def _body(elements: FiniteElements, nodes: IntArray) -> BodyFit:
    mass = elements.mass[nodes][:, nodes]
    share = mass @ np.ones(len(nodes))
    share = share / share.sum()
    rest = elements.nodes[nodes]
    centre = share @ rest
    return BodyFit(nodes=nodes, rest=rest, share=share, centre=centre, weighted=mass @ (rest - centre))


def _corners(body: BodyFit) -> IntArray:
    """Lower left and right, upper left and right node."""
    x, z = body.rest.T
    slack = 1e-6 * np.ptp(z)
    ends = [np.flatnonzero(z <= z.min() + slack), np.flatnonzero(z >= z.max() - slack)]
    return np.array([body.nodes[end[pick(x[end])]] for end in ends for pick in (np.argmin, np.argmax)])


def player_data(animation: Animation, history: History, *, model: Model) -> dict[str, Any]:
    """What the script `player.js` reads, of a run with samples."""
    stride = max(1, math.ceil(len(history.modes) / MOST_SAMPLES))
    names = COLUMNS | (LIFT if history.vertical else {})
    further = range(2, len(animation.centroid) + 1)
    for k in further:
        beside = (k - 1, "neighbour") if model.container.row else (k, "box")
        names |= {name.format(k): column.format(*beside) for name, column in BOX.items()}
    columns = {name: history[column][::stride] for name, column in names.items()}
    journey = max(float(np.ptp(columns[name])) for name in ("base", "lift") if name in columns)
    modes = sorted(set(history.modes))
    mesh, angle, scale = model.container.mesh, model.static.slenderness_angle, animation.stress_scale
    stresses = 255.0 * np.array(animation.stresses).ravel() / scale if scale else np.zeros(0)
    bodies = [animation.points[animation.body == k] for k in range(len(animation.centroid))]
    wide = len(animation.points) >= 65536
    index = "<u4" if wide else "<u2"
    # The page opens at the largest rotation that is not yet a fall: that is what one looks for.
    rotation = np.max([np.abs(history[names[name]]) for name in names if name.startswith("rotation")], axis=0)
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
        "bodies": [
            {
                "suffix": "" if k == 0 else f"_{k + 1}",
                "corners": animation.corners[k].tolist(),
                "hull": points[ConvexHull(points).vertices].tolist(),  # its corners
            }
            for k, points in enumerate(bodies)
        ],
        "body": packed(animation.body, "u1"),
        "rests": animation.rests.tolist(),
        "links": [
            {
                "x": link.x,
                "outer": link.outer,
                "height": link.height,
                "anchor": link.anchor,
                "until": min(link.until, LASTING),
                "node": int(node),
            }
            for link, node in zip(animation.links, animation.held, strict=True)
        ],
        "row": animation.in_a_row,
        "follow": journey > WIDE_JOURNEY * mesh.width,
        "points": packed_floats(animation.points.ravel()),
        "quads": packed(animation.quads.ravel(), index),
        "edges": packed(animation.edges.ravel(), index),
        "wide": wide,
        "contact": animation.contact.tolist(),
        "times": [frame.time for frame in animation.frames],
        "elastic": packed_floats(np.array([frame.elastic for frame in animation.frames]).ravel()),
        "stress": packed(np.clip(np.round(stresses), 0, 255), "u1"),
        "stress_scale": scale,
        "normal": packed_floats(np.array([frame.normal_force for frame in animation.frames]).ravel()),
        "colours": colour_scale("YlGnBu", COLOURS),
        "first": float(history["time_s"][opening]),
    }


def exaggeration(animation: Animation, height: float) -> float:
    """Factor on the elastic displacement as first shown; 0 where there is none.

    Most frames then deform visibly. Frames are in single precision: a factor that would show its rounding as
    deformation is not taken.
    """
    largest = [float(np.hypot(*frame.elastic.T).max()) for frame in animation.frames]
    if max(largest, default=0.0) == 0.0:
        return 0.0
    typical = float(np.percentile(largest, TYPICAL))
    reach = max(float(np.abs(frame.centre).max()) for frame in animation.frames) + height
    most = SHOWN_ROUNDING * height / (SINGLE_PRECISION * reach)
    return max(1.0, one_two_five(min(SHOWN_ELASTIC * height / typical if typical else most, most), up=False))


def exaggerations(animation: Animation, height: float) -> list[float]:
    """Factors to choose from; none where the container is rigid."""
    fit = exaggeration(animation, height)
    if fit == 0.0:
        return []
    factors = [fit * factor for factor in (0.1, 0.3, 1.0, 3.0)]
    return sorted({1.0, *(one_two_five(one, up=False) for one in factors if one > 1.0)})


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


def _frame(
    model: Model, bodies: Sequence[BodyFit], frame: Frame, drawn: IntArray, contact: IntArray
) -> AnimationFrame:
    nodes, frame = model.container.elements.nodes, frame.without_links()
    if len(frame.displacement) != len(nodes):
        raise ValueError(f"a frame of {len(frame.displacement)} nodes on a mesh of {len(nodes)}")
    area = model.contact_areas[: contact.size]
    elastic = np.zeros(nodes.shape)
    centre, rotation = np.zeros((len(bodies), 2)), np.zeros(len(bodies))
    for k, body in enumerate(bodies):
        centre[k], rotation[k], elastic[body.nodes] = body.split(frame.displacement)
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
