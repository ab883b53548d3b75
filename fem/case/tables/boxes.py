"""The boxes of a container, from the floor up, and the rules that hold for boxes that differ.

Each box of [[container.box]] takes what it leaves out from [container]; without such tables all boxes are equal.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from contact.stepping.modes import SLIDING
from fem.case.tables import quantities as q
from fem.case.tables.problem import Rule, left_out, refused

MICROSLIP = SLIDING  #: over the width, up to which a base still sticks


@dataclass(frozen=True, kw_only=True)
class Box:
    """One box with its fill, and its place in the stack."""

    width: float  #: along x [m]
    height: float  #: [m]
    mass: float  #: [kg]
    centroid: float  #: height of the mass centre above the bottom of the box [m]
    wall: float | None  #: thickness; None: a solid block [m]
    axis: float  #: x of its axis, from that of the lowest box [m]
    bottom: float  #: above the floor [m]

    @property
    def top(self) -> float:
        """Height of its upper face above the floor [m]."""
        return self.bottom + self.height

    @property
    def sides(self) -> tuple[float, float]:
        """x of its left and right side [m]."""
        return self.axis - 0.5 * self.width, self.axis + 0.5 * self.width


def plan_share(container: Any) -> float:
    """Area of the plan of a container over its width times its depth [-]."""
    return 0.25 * math.pi if container.is_round else 1.0


def centroid_at(container: Any, height: float) -> float:
    """Height of the mass centre in a box of another height for which none is given [m].

    Half the height is the default of [container]; there it is half of the other height, too.
    """
    half = container.centroid_m == 0.5 * container.height_m
    return 0.5 * height if half else float(container.centroid_m)


def least_weakening(case: Any) -> float:
    """The slip over which friction falls at the least [m]: what slips less still sticks, and then it falls at once."""
    return float(MICROSLIP * max(box.width for box in case.stack))


def _falls_within_microslip(place: str) -> Rule:
    """A fall of friction with slip, or the upper end of its range, is 0 or long enough to be one."""
    table, _, key = place.partition(".")

    def reason(case: Any) -> str:
        stated, least = getattr(getattr(case, table), key), least_weakening(case)
        longest = stated[-1] if isinstance(stated, list) else stated
        if not isinstance(longest, float) or not 0.0 < longest < (1.0 - 1e-9) * least:
            return ""
        return (
            f"{'ends at' if isinstance(stated, list) else '='} {longest:g} m, less than {least:g} m ({MICROSLIP:g} of "
            f"the width): a base that slipped so little still sticks, and its friction falls at once; give "
            f"{least:g} m or more, or 0 for a fall at once"
        )

    return refused(place, reason)


WEAKENING_RULES = tuple(
    _falls_within_microslip(f"{table}weakening_m")
    for table in ("contact.", "joints.", "uncertainty.", "uncertainty.joints_")
)


def shared_face(lower: Box, upper: Box) -> tuple[float, float]:
    """x of the left and right end of the face that two boxes share [m]; the left end is the larger one without any."""
    (low, high), (left, right) = lower.sides, upper.sides
    return max(low, left), min(high, right)


def centre_above(boxes: tuple[Box, ...], number: int) -> float:
    """x of the mass centre of the box of this number, from 0, and all boxes above it [m]."""
    above = boxes[number:]
    return sum(box.mass * box.axis for box in above) / sum(box.mass for box in above)


#: of each box of [[container.box]]: what must hold of it, and the reason where it does not; see `_each`
BOX_FAULTS: tuple[tuple[Callable[[dict[str, Any]], bool], str], ...] = (
    (
        lambda box: 0.02 * (1.0 - 1e-9) <= box["ratio"] <= 20.0 * (1.0 + 1e-9),
        "width_m over height_m must lie between 0.02 and 20, got {width:g} m / {height:g} m = {ratio:g}",
    ),
    (
        lambda box: box["centroid"] < box["height"],
        "centroid_m must be less than its height_m = {height:g} m, got {centroid:g} m; it is measured from the bottom "
        "of the box",
    ),
    (
        lambda box: box["section"] != "shell" or box["wall"] is not None,
        'wall_m is missing: section = "shell" needs the wall thickness, here or in [container], in m',
    ),
    (
        lambda box: box["wall"] is None or 2.0 * box["wall"] < box["smallest"],
        "wall_m must be less than half its smallest outer dimension, {smallest:g} m, got {wall:g} m",
    ),
    (
        lambda box: q.DENSITY.allows(box["density"]),
        "{mass:g} kg on {width:g} x {depth_m:g} x {height:g} m is a mean density of {density:.3g} kg/m3, it must be "
        f"{q.DENSITY.range_in_words} kg/m3; are mass_kg in kg and all dimensions in m?",
    ),
    (
        lambda box: box["bottom"] > 0.0 or box["axis"] == 0.0,
        "offset_m is measured from the axis of the box below, and the lowest box has none; got {axis:g} m",
    ),
)


def _each(holds: Callable[[dict[str, Any]], bool], words: str) -> Rule:
    """A rule for every box of [[container.box]]."""

    def reason(case: Any) -> str:
        faults, container = [], case.container
        for number, box in enumerate(case.stack if container.box is not None else (), 1):
            about = {
                **vars(container),
                **vars(box),
                "ratio": box.width / box.height,
                "smallest": min(box.width, box.height, container.depth_m),
                "density": box.mass / (box.width * box.height * container.depth_m * plan_share(container)),
            }
            if not holds(about):
                faults.append(f"{number}: {words.format_map(about)}")
        return "; box ".join(faults)

    return refused("container.box", reason)


def _unsupported(case: Any) -> str:
    """Where what is above has its mass centre beyond the face that carries it."""
    if case.container.box is None:
        return ""
    boxes = case.stack
    # of a joint first: what hangs over there may tilt the whole, too
    for number in (*range(1, len(boxes)), 0):
        upper = boxes[number]
        low, high = shared_face(boxes[number - 1], upper) if number else upper.sides
        centre = centre_above(boxes, number)
        if low < centre < high:
            continue
        below = f"box {number}" if number else "the floor"
        face = f"reaches from x = {low:g} to {high:g} m" if low < high else "has no width"
        return (
            f"{number + 1}: the mass centre of what stands on {below} is at x = {centre:.4g} m, outside the face "
            f"that carries it, which {face} (x from the axis of the lowest box); make the offset_m smaller or "
            "the box below wider"
        )
    return ""


def _not_a_cylinder(case: Any) -> str:
    """What a cylinder does not have; empty where nothing speaks against one."""
    container, support = case.container, case.support
    if not container.is_round:
        return ""
    boxes = case.stack
    slab = case.floor.kind == "slab" and case.floor.corner_patch_m is None
    faults = (
        (
            abs(container.depth_m - container.width_m) > 1e-9 * container.width_m,
            f"depth_m = width_m = {container.width_m:g} m, its diameter; leave depth_m out",
        ),
        (
            len({(box.width, box.axis) for box in boxes}) > 1,
            "boxes of one diameter on one axis; take equal width_m and no offset_m",
        ),
        (
            (container.post_m or container.corner_post_N) is not None,
            "no posts, which stand in edges; leave post_m and corner_post_N out",
        ),
        (support.casting_m is not None, "no castings; leave support.casting_m out"),
        (
            container.mesh_file is not None,
            'no mesh_file, whose cells have one depth; leave it out, or take "prism"',
        ),
        (
            support.kind != "corners" or support.camber_m > 0.0,
            'to stand on the ends of its diameter; take support.kind = "corners" without camber_m',
        ),
        (slab, "floor.corner_patch_m on a slab: what bears of its round edge, [along x, out of plane]"),
    )
    needs = [words for fault, words in faults if fault]
    return f'= "cylinder" needs {"; and ".join(needs)}' if needs else ""


BOX_RULES = (
    refused("container.shape", _not_a_cylinder),
    *(_each(*fault) for fault in BOX_FAULTS),
    refused("container.box", _unsupported),
)

IS_LOOSE = attrgetter("container.is_loose")
JOINT_RULES = (
    *left_out(
        IS_LOOSE,
        {
            "support.kind": 'must be "corners" with container.joints = "loose": every box touches with its corners, '
            "on faces and on the floor; leave it out",
            "support.camber_m": 'does not apply to container.joints = "loose": every box touches with its corners; '
            'leave it out, or take "bolted"',
            "initial.rotation_rad initial.angular_velocity_rad_s": 'does not apply to container.joints = "loose": a '
            'loose stack starts settled; leave it out, or take "bolted"',
            "output.stop_when_overturned": 'must be true with container.joints = "loose": what a fallen box strikes is '
            "not modelled; leave it out",
        },
    ),
    Rule(
        "container.joints",
        lambda case: not case.container.is_loose or case.container.boxes > 1,
        '= "loose" needs two boxes or more: a stack of one has no joints; give boxes or [[container.box]]',
    ),
    Rule(
        "joints.",
        lambda case: case.container.boxes > 1 or all(value is None for value in vars(case.joints).values()),
        "is friction between boxes, but a stack of one has no joints; remove the table, or give boxes or "
        "[[container.box]]",
    ),
    *left_out(
        IS_LOOSE,
        {
            "joints.bolt_capacity_N": 'does not apply to container.joints = "loose", which have no bolts; leave it '
            'out, or take "bolted"'
        },
    ),
    Rule(
        "joints.mu_kinetic",
        lambda case: case.joint_friction["mu_kinetic"] <= case.joint_friction["mu_static"],
        lambda case: (
            "must be at most mu_static = {mu_static:g} of the joints, got {mu_kinetic:g}; leave it out where the two "
            "are equal"
        ).format_map(case.joint_friction),
    ),
)
