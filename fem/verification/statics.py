"""The static rule: numbers printed in the seed paper's section 7, and the same with g = 9.81.

Homogeneous containers of 1.1 x 1.0 m, 2500 kg each. The paper takes g = 10 and prints two or three figures; the
tolerance is half a unit of the last one. With g = 9.81 the mass is kept; those values are closed forms.
"""

from fem.model.static_checks import StaticChecks, static_checks
from fem.verification.rows import Check, Kind, Row

WIDTH, BOX_HEIGHT, BOX_MASS = 1.1, 1.0, 2500.0


def seed_checks(*, boxes: int, gravity: float, peak: float = 2.4) -> StaticChecks:
    """Static checks of so many of the paper's containers under a floor's peak acceleration [m/s2]."""
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
        ground_acceleration=1.6,
        soil_factor=1.5,
        corner_period=0.8,
        behaviour_factor=1.5,
        importance_factor=1.0,
    )


def printed() -> list[Row]:
    """Section 7 with g = 10: one box, and four."""
    rows = []
    values = {
        1: (10e3, 5e3, 13.75e3, 10e3, 5e3, 1.98),
        4: (40e3, 20e3, 55e3, 40e3, 80e3, 3.30),
    }
    for boxes, references in values.items():
        checks = seed_checks(boxes=boxes, gravity=10.0)
        found = {
            "sliding limit, static [N]": (checks.sliding_limit_static, 0.5),
            "sliding limit, kinetic [N]": (checks.sliding_limit_kinetic, 0.5),
            "restoring moment [Nm]": (checks.restoring_moment, 0.5),
            "base shear of the code [N]": (checks.code.sliding.demand, 0.5),
            "tilting moment of the code [Nm]": (checks.code.overturning.demand, 0.5),
            "period, Eq. (3) [s]": (checks.period_eq3, 0.005),
        }
        rows += [
            _row(
                f"{boxes} box{'es' if boxes > 1 else ''}, g = 10",
                name,
                value,
                reference,
                "printed",
                tolerance,
            )
            for (name, (value, tolerance)), reference in zip(found.items(), references, strict=True)
        ]
    return rows


def with_exact_gravity() -> list[Row]:
    """The same containers with g = 9.81; the stack under the floor motions of the studies."""
    rows = []
    for boxes, references in (
        (1, (9810.0, 1.997, 3.14617, 0.17873)),
        (4, (39240.0, 3.336, 1.88337, 0.89454)),
    ):
        checks = seed_checks(boxes=boxes, gravity=9.81)
        found = {
            "sliding limit, static [N]": (checks.sliding_limit_static, 0.5),
            "period, Eq. (3) [s]": (checks.period_eq3, 5e-4),
            "frequency parameter [1/s]": (checks.frequency_parameter, 5e-6),
            "Housner's restitution": (checks.housner_restitution, 5e-6),
        }
        rows += [
            _row(
                f"{boxes} box{'es' if boxes > 1 else ''}, g = 9.81",
                name,
                value,
                reference,
                "analytic",
                tolerance,
            )
            for (name, (value, tolerance)), reference in zip(found.items(), references, strict=True)
        ]
    box, stack = (seed_checks(boxes=boxes, gravity=9.81) for boxes in (1, 4))
    plateau = seed_checks(boxes=4, gravity=9.81, peak=4.0)
    stated = seed_checks(boxes=4, gravity=9.81, peak=0.05 * 6.928**2)
    compared = (
        ("1 box, code", "utilisation of stiction", box.code.sliding.utilisation, 1.019),
        ("4 boxes", "acceleration of uplift [m/s2]", stack.uplift_acceleration, 2.698),
        (
            "4 boxes, 50 mm at 6.928 rad/s",
            "utilisation of overturning",
            stated.own_motion.overturning.utilisation,
            0.8896,
        ),
        (
            "4 boxes, peak 4.0 m/s2",
            "utilisation of overturning",
            plateau.own_motion.overturning.utilisation,
            1.483,
        ),
    )
    return rows + [
        _row(case, name, value, reference, "analytic", 5e-4) for case, name, value, reference in compared
    ]


def _row(case: str, compared: str, value: float, reference: float, kind: Kind, tolerance: float) -> Row:
    return Row(
        case=case,
        compared=compared,
        value=value,
        reference=reference,
        kind=kind,
        source="seed paper, section 7" if kind == "printed" else "closed form",
        tolerance=tolerance,
    )


CHECKS = (
    Check(name="the seed paper's numbers", rows=printed),
    Check(name="the same with g = 9.81", rows=with_exact_gravity),
)
