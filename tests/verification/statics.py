"""The static rule: the numbers printed in section 7 of Knoedel and Hrabowski, and the same with g = 9.81.

Homogeneous containers of 1.1 x 1.0 m, 2500 kg each. The paper takes g = 10 and prints two or three figures; the
tolerance is half a unit of the last one. With g = 9.81 the mass is kept; those values are closed forms.
"""

from evidence.findings import analytic, printed
from verification.checks import Findings, check

from fem.case.tables.run_tables import StaticTable
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
