"""The static rule against section 7 of Knoedel and Hrabowski; mass, centre and inertia of a container by hand.

Homogeneous containers of 1.1 x 1.0 m, 2500 kg each. The paper takes g = 10 and prints two or three figures; the
tolerance is half a unit of the last one. With g = 9.81 the mass is kept; those values are closed forms.

Every block that other checks hold a run to has the mass centre and the inertia of the program's mesh. So these are
held here to sums of rectangles, worked from the drawing: steel of 7850 kg/m3, front and back sheets together, fill.
"""

import math

import runs
from evidence.findings import analytic, printed
from verification.checks import Findings, check

from contact.stepping.modal_body import ModalBody
from fem.case.tables.run_tables import StaticTable
from fem.model.model import build_model
from fem.model.static_checks import StaticChecks, static_checks

#: a_gR, S and T_C of the paper, q and gamma_I
PAPER_CODE = StaticTable(
    ground_acceleration_m_s2=1.6,
    soil_factor=1.5,
    corner_period_s=0.8,
    behaviour_factor=1.5,
    importance_factor=1.0,
)
WIDTH, BOX_HEIGHT, BOX_MASS = 1.1, 1.0, 2500.0
PAPER, CLOSED_FORM = "the paper, section 7", "closed form"


def paper_checks(*, boxes: int, gravity: float, peak: float = 2.4) -> StaticChecks:
    """Static checks of a stack of the paper's boxes under a floor's peak acceleration [m/s2]."""
    mass, height = boxes * BOX_MASS, boxes * BOX_HEIGHT
    return static_checks(
        mass=mass,
        centroid=0.5 * height,
        inertia=mass * (WIDTH**2 + height**2) / 12.0,
        width=WIDTH,
        gravity=gravity,
        mu_static=0.4,
        mu_kinetic=0.2,
        peak_floor_acceleration=peak,
        code=PAPER_CODE,
    )


@check("statics", "the paper's numbers (Knoedel and Hrabowski)")
def paper_numbers() -> Findings:
    """Section 7 with g = 10: one box, and four."""
    for boxes, case, numbers in (
        (1, "1 box, g = 10", (10e3, 5e3, 13.75e3, 10e3, 5e3, 1.98)),
        (4, "4 boxes, g = 10", (40e3, 20e3, 55e3, 40e3, 80e3, 3.30)),
    ):
        checks = paper_checks(boxes=boxes, gravity=10.0)
        values = (
            ("sliding limit, static [N]", checks.sliding_limit_static, 0.5),
            ("sliding limit, kinetic [N]", checks.sliding_limit_kinetic, 0.5),
            ("restoring moment [Nm]", checks.restoring_moment, 0.5),
            ("base shear of the code [N]", checks.code.sliding.demand, 0.5),
            ("tilting moment of the code [Nm]", checks.code.overturning.demand, 0.5),
            ("period, Eq. (3) [s]", checks.period_eq3, 0.005),
        )
        for (name, value, tolerance), number in zip(values, numbers, strict=True):
            yield printed(case, name, value, number, source=PAPER, absolute=tolerance)


@check("statics", "the same with g = 9.81")
def with_exact_gravity() -> Findings:
    """The same containers with g = 9.81, and the stack under the floor motions of the runs below."""
    box, stack = (paper_checks(boxes=boxes, gravity=9.81) for boxes in (1, 4))
    for case, checks, numbers in (
        ("1 box, g = 9.81", box, (9810.0, 1.997, 3.14617, 0.17873)),
        ("4 boxes, g = 9.81", stack, (39240.0, 3.336, 1.88337, 0.89454)),
    ):
        values = (
            ("sliding limit, static [N]", checks.sliding_limit_static, 0.5),
            ("period, Eq. (3) [s]", checks.period_eq3, 5e-4),
            ("frequency parameter [1/s]", checks.frequency_parameter, 5e-6),
            ("Housner's restitution", checks.housner_restitution, 5e-6),
        )
        for (name, value, tolerance), number in zip(values, numbers, strict=True):
            yield analytic(case, name, value, number, source=CLOSED_FORM, absolute=tolerance)
    stated = paper_checks(boxes=4, gravity=9.81, peak=0.05 * 6.928**2).own_motion.overturning
    plateau = paper_checks(boxes=4, gravity=9.81, peak=4.0).own_motion.overturning
    for case, name, value, number in (
        ("1 box, code", "utilisation of sliding", box.code.sliding.utilisation, 1.019),
        ("4 boxes", "acceleration of uplift [m/s2]", stack.uplift_acceleration, 2.698),
        ("4 boxes, 50 mm at 6.928 rad/s", "utilisation of overturning", stated.utilisation, 0.8896),
        ("4 boxes, peak 4.0 m/s2", "utilisation of overturning", plateau.utilisation, 1.483),
    ):
        yield analytic(case, name, value, number, source=CLOSED_FORM, absolute=5e-4)


#: of a part: mass [kg], x and z of its centre, width and height [m]
Part = tuple[float, float, float, float, float]
#: box of 1.02 x 1.02 m, 1 m deep, 10 mm: floor and lid, side walls, both sheets; 474.14 kg with its centre at 0.51 m
STEEL: tuple[Part, ...] = (
    (80.07, 0.0, 0.005, 1.02, 0.01),
    (80.07, 0.0, 1.015, 1.02, 0.01),
    (78.5, -0.505, 0.51, 0.01, 1.0),
    (78.5, 0.505, 0.51, 0.01, 1.0),
    (157.0, 0.0, 0.51, 1.0, 1.0),
)
#: 2000 kg between the sheets: all of the room, its lower and its upper six tenths
FULL, LOW, HIGH = (2000.0, 0.0, 0.51, 1.0, 1.0), (2000.0, 0.0, 0.31, 1.0, 0.6), (2000.0, 0.0, 0.71, 1.0, 0.6)
#: two posts of 0.1 m and 10 mm behind each other, at each side: outer flanges, webs, inner flanges
POSTS: tuple[Part, ...] = tuple(
    (mass, side * x, 0.51, width, 1.02)
    for side in (-1.0, 1.0)
    for mass, x, width in ((16.014, 0.505, 0.01), (25.6224, 0.46, 0.08), (16.014, 0.415, 0.01))
)
#: a filled box of 0.82 x 0.52 m, 10 mm, on the first and 0.1 m beside its axis; 270.04 kg of steel
UPPER: tuple[Part, ...] = (
    (64.37, 0.1, 1.025, 0.82, 0.01),
    (64.37, 0.1, 1.535, 0.82, 0.01),
    (39.25, -0.305, 1.28, 0.01, 0.5),
    (39.25, 0.505, 1.28, 0.01, 0.5),
    (62.8, 0.1, 1.28, 0.8, 0.5),
    (500.0, 0.1, 1.28, 0.8, 0.5),
)
BLOCK: Part = (2500.0, 0.0, 0.5, 1.1, 1.0)
SHELL: runs.Keys = {
    "container.width_m": 1.02,
    "container.height_m": 1.02,
    "container.depth_m": 1.0,
    "container.mass_kg": 2474.14,
    "container.wall_m": 0.01,
    "container.section": "shell",
}
#: heights of the mass centre of the box filled low and high, and of the one with posts filled low [m]
Z_LOW, Z_HIGH, Z_POSTS = 861.8114 / 2474.14, 1661.8114 / 2474.14, 920.614808 / 2589.4408
SMALL = {"width_m": 0.82, "height_m": 0.52, "mass_kg": 770.04, "centroid_m": 0.26, "offset_m": 0.1}
#: container -> keys, its parts, distances along x and z by which its mass is shifted evenly [m], half its base [m]
BODIES: dict[str, tuple[runs.Keys, tuple[Part, ...], float, float, float]] = {
    "filled shell": (SHELL, (*STEEL, FULL), 0.0, 0.0, 0.51),
    "shell filled low": (SHELL | {"container.centroid_m": Z_LOW}, (*STEEL, LOW), 0.0, 0.0, 0.51),
    "shell filled from the lid": (SHELL | {"container.centroid_m": Z_HIGH}, (*STEEL, HIGH), 0.0, 0.0, 0.51),
    "filled shell, 50 mm beside": (
        SHELL | {"container.eccentricity_m": 0.05},
        (*STEEL, FULL),
        0.05,
        0.0,
        0.51,
    ),
    "solid, centre at 0.42 m": ({"container.centroid_m": 0.42}, (BLOCK,), 0.0, -0.08, 0.55),
    "shell filled low, on feet": (
        SHELL | {"container.centroid_m": Z_LOW, "support.kind": "feet", "support.foot_m": 0.15},
        (*STEEL, LOW),
        0.0,
        0.0,
        0.51,
    ),
    "shell filled low, posts, castings 20 mm inside": (
        SHELL
        | {
            "container.mass_kg": 2589.4408,
            "container.centroid_m": Z_POSTS,
            "container.post_m": [0.1, 0.01],
            "support.casting_m": [0.162, 0.178, 0.02],
        },
        (*STEEL, *POSTS, LOW),
        0.0,
        0.0,
        0.49,
    ),
    "a smaller box beside the axis of one filled low": (
        SHELL | {"container.box": [{"mass_kg": 2474.14, "centroid_m": Z_LOW}, SMALL]},
        (*STEEL, LOW, *UPPER),
        0.0,
        0.0,
        0.51,
    ),
}


@check("statics", "mass, centre and inertia by hand")
def bodies_by_hand() -> Findings:
    """The numbers of the body that is stepped, with fills below and above the middle, feet, castings, unequal boxes.

    A density with an even part in x or z that shifts the centre by e keeps the second moment about the old one, so
    its inertia is less by M e^2.
    """
    for name, (keys, parts, beside, above, half) in BODIES.items():
        body = build_model(runs.BOX.with_values({"solver.element_size_m": 0.1} | keys)).body
        assert isinstance(body, ModalBody)
        mass = sum(part[0] for part in parts)
        x, z = (sum(part[0] * part[axis] for part in parts) / mass for axis in (1, 2))
        inertia = sum(
            m * ((width**2 + height**2) / 12.0 + (at - x) ** 2 + (up - z) ** 2)
            for m, at, up, width, height in parts
        )
        for what, value, exact in (
            ("mass [kg]", body.mass, mass),
            ("x of the mass centre [m]", body.rest[0], x + beside),
            ("z of the mass centre [m]", body.rest[1], z + above),
            ("moment of inertia [kg m2]", body.inertia, inertia - mass * (beside**2 + above**2)),
            ("half the base [m]", body.rest[0] + body.point[-1, 0], half),
        ):
            within = 1e-9 * max(1.0, exact)
            yield analytic(name, what, value, exact, source="sum of its parts", absolute=within)


#: cylinder of 1 m diameter and 1 m height, 10 mm: two discs and the wall [kg]
DISC, RING = 7850.0 * math.pi * 0.5**2 * 0.01, 7850.0 * math.pi * (0.5**2 - 0.49**2) * 0.98
ROUND: runs.Keys = {f"container.{side}_m": 1.0 for side in ("width", "depth", "height")} | {
    "container.shape": "cylinder",
    "container.section": "shell",
    "container.wall_m": 0.01,
}


@check("statics", "mass and inertia of a cylinder")
def cylinders() -> Findings:
    """Upright cylinders in closed form: a solid, an empty one of discs and a wall, and that filled to the lid.

    About a horizontal axis through the mass centre a solid has M (3 r^2 + h^2)/12, a tube M (3 (R^2 + r^2) + h^2)/12.
    An empty one is built only where its mass is that of its walls to twelve digits.
    """
    walls = 2.0 * DISC * ((3.0 * 0.5**2 + 0.01**2) / 12.0 + 0.495**2)
    walls += RING * (3.0 * (0.5**2 + 0.49**2) + 0.98**2) / 12.0
    fill = 1500.0 * (3.0 * 0.49**2 + 0.98**2) / 12.0
    for name, keys, mass, inertia in (
        ("solid", {"container.section": "solid"}, 1500.0, 1500.0 * (3.0 * 0.5**2 + 1.0) / 12.0),
        ("walls alone", {}, 2.0 * DISC + RING, walls),
        ("filled", {}, 2.0 * DISC + RING + 1500.0, walls + fill),
    ):
        body = build_model(runs.BOX.with_values(ROUND | {"container.mass_kg": mass} | keys)).body
        assert isinstance(body, ModalBody)
        columns = "closed form; the mesh has 24 columns of one density each"
        for what, value, by_hand, source, error in (
            ("mass [kg]", body.mass, mass, "closed form", 1e-9),
            ("z of the mass centre [m]", body.rest[1], 0.5, "closed form", 1e-9),
            ("moment of inertia [kg m2]", body.inertia, inertia, columns, 2e-3),
        ):
            yield analytic(f"cylinder, {name}", what, value, by_hand, source=source, relative=error)
