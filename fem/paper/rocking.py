"""What the paper says of rocking: its periods, Eqs. (2) to (4), and the orbit beyond which it overturns."""

import math

import numpy as np

from contact.reference.closed_forms_rocking import quarter_period
from contact.reference.rigid_block import RigidBlock
from fem.model.static_checks import period_eq2, period_eq3
from fem.paper.cases import BOX, GRAVITY, HEIGHT, NO_SLIDING, RIGID, SHELL, STACK, WIDTH, PaperCase
from fem.paper.claims import Evidence, at_least, at_most, claim, equal
from fem.paper.experiments import Experiments, VariantBand, stands
from fem.paper.figures import curve, draw_curves

FREE = {"motion.kind": "none", **NO_SLIDING}
RELEASES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98)  #: over the slenderness angle
BODIES = {"stack": STACK, "box": BOX}
CONTROL_PERIOD = 0.8  # s, T_C of Eq. (4)
#: a body whose inertia about its centre is nothing: the mathematical pendulum of the paper's remark
POINT_MASS = 1.0 + 1e-9


def _periods(experiments: Experiments, name: str) -> tuple[RigidBlock, list[PaperCase], dict[float, float]]:
    """Analytic block, cases, and four times the time from release to the first impact, by RELEASES [s]."""
    block = experiments.block(BODIES[name])
    released = [share * block.slenderness_angle for share in RELEASES]
    cases = (
        BODIES[name]
        .but(RIGID, FREE, duration=3.0)
        .scan("rotation", released, f"{name} released at {{:.4f}} rad")
    )
    times = [row["first_impact_s"] for row in experiments.rows(cases)]
    periods = [math.nan if time is None else 4.0 * time for time in times]
    return block, cases, dict(zip(RELEASES, periods, strict=True))


def _eq_2(block: RigidBlock, share: float) -> float:
    """Eq. (2) for a release at a share of the slenderness angle [s]."""
    return period_eq2(
        width=2.0 * block.half_width,
        radius=block.radius,
        gravity=block.gravity,
        initial_rotation=share * block.slenderness_angle,
    )


@claim(
    "4.2, Eq. 2",
    "T = 8 sqrt(phi_0 r²/(a g)) ... a mathematical pendulum rather than a physical pendulum",
    bounds="a point mass, rotations up to 0.1 beta",
)
def eq_2(experiments: Experiments) -> Evidence:
    """Rigid stack released at twelve rotations; four times the time to its first impact; the exact point mass."""
    block, cases, periods = _periods(experiments, "stack")
    point = RigidBlock(
        half_width=block.half_width,
        centroid_height=block.centroid_height,
        gravity=block.gravity,
        inertia_ratio=POINT_MASS,
    )
    for share in (0.05, 0.1, 0.2, 0.5, 0.9):
        exact = 4.0 * quarter_period(point, share * block.slenderness_angle)
        what = f"Eq. 2 over the exact period of a point mass, phi_0 = {share:g} beta"
        yield equal(what, _eq_2(block, share) / exact, 1.0, 0.05, inside=share <= 0.1)
    for share in (0.05, 0.5, 0.9):
        what = f"Eq. 2 over the period of the stack's run, phi_0 = {share:g} beta"
        yield equal(what, _eq_2(block, share) / periods[share], 1.0, 0.05, inside=False)
    small = _eq_2(block, RELEASES[0]) / periods[RELEASES[0]]
    yield (
        f"At {RELEASES[0]:g} beta Eq. 2 gives {small:.3f} of the stack's period. A point mass without rotational "
        f"inertia, which the paper remarks on, would have sqrt(3/4) = {math.sqrt(0.75):.3f} of it at small "
        "rotation. Towards beta the period of either grows without bound, and Eq. 2 does not."
    )
    yield from cases


@claim(
    "4.2, Eq. 3",
    "T = 2 pi sqrt(4 r/(3 g)) ... seems to be a better representation for our engineering problem",
    bounds="as the period of a hanging bar; as that of rocking near phi_0 = 0.6 beta alone",
)
def eq_3(experiments: Experiments) -> Evidence:
    """The same runs, of stack and box, against Eqs. 2 and 3."""
    lines, met, far_2, far_3 = [], [], [], []
    for name in BODIES:
        block, released_ones, periods = _periods(experiments, name)
        third = period_eq3(radius=block.radius, gravity=block.gravity)
        exact = [4.0 * quarter_period(block, share * block.slenderness_angle) for share in RELEASES]
        second = [_eq_2(block, share) for share in RELEASES]
        yield from released_ones[::3]
        met.append(f"{float(np.interp(third, exact, RELEASES)):.2f} beta ({name})")
        for share in (0.1, 0.3, 0.6, 0.9):
            what = f"{name}: Eq. 3 over the period of the run, phi_0 = {share:g} beta"
            yield equal(what, third / periods[share], 1.0, 0.1, inside=share == 0.6)
        far_2 += [abs(math.log(two / run)) for two, run in zip(second, periods.values(), strict=True)]
        far_3 += [abs(math.log(third / run)) for run in periods.values()]
        lines += [
            curve(RELEASES, list(periods.values()), f"{name}, run", "o"),
            curve(RELEASES, exact, f"{name}, exact block"),
            curve(RELEASES, second, f"{name}, Eq. 2", ":"),
            curve(RELEASES, [third] * len(RELEASES), f"{name}, Eq. 3", "--"),
        ]
    typical_2, typical_3 = (math.exp(float(np.median(far))) - 1.0 for far in (far_2, far_3))
    length = math.hypot(WIDTH, HEIGHT)
    bar = 2.0 * math.pi * math.sqrt(2.0 * length / (3.0 * GRAVITY))
    of_bar = "Eq. 3 over the period of a hanging bar of length 2 r, 2 pi sqrt(2 L/(3 g))"
    median = "median distance from the runs' periods, Eq. 3 over Eq. 2"
    yield equal(of_bar, period_eq3(radius=0.5 * length, gravity=GRAVITY) / bar, 1.0, 1e-9)
    yield at_most(median, typical_3 / typical_2, 1.0, inside=False)
    yield (
        "A rocking block has no natural period: its period is zero at small rotation and grows without bound "
        "towards beta. Eq. 3, 2 pi/p, equals the period of the exact block at "
        f"{' and '.join(met)}. The median distance of "
        f"Eq. 3 from the runs is {100.0 * typical_3:.0f} %, that of Eq. 2 {100.0 * typical_2:.0f} %."
    )
    yield draw_curves(
        "periods",
        "Period of free rocking over the rotation of release: runs, exact block, Eqs. 2 and 3.",
        "initial rotation over the slenderness angle [-] | period [s]",
        lines,
    )
    yield _band_of_periods(experiments)


def _band_of_periods(experiments: Experiments) -> VariantBand:
    """Period at half of beta over deformation, contact and support, over the exact block's."""
    block = experiments.block(STACK)
    rotation = 0.5 * block.slenderness_angle
    exact = quarter_period(block, rotation)
    return experiments.band(
        STACK.but(FREE, rotation=rotation, duration=1.5),
        "period of the stack released at 0.5 beta over the exact block's",
        "within 5 % of the exact block's",
        lambda row: row["first_impact_s"] is not None and abs(row["first_impact_s"] / exact - 1.0) <= 0.05,
        value=lambda row: None if row["first_impact_s"] is None else row["first_impact_s"] / exact,
    )


@claim(
    "4.2, Eq. 4",
    "the rocking period of bodies with practical dimensions is T >= 2 s ... smaller than the plateau value",
    bounds="rotations of 0.7 beta and more",
)
def control_periods(experiments: Experiments) -> Evidence:
    """The same runs against 2 s, and Eq. 4 with their periods."""
    ranges = []
    for name in ("box", "stack"):
        _, released_ones, periods = _periods(experiments, name)
        reached = next((f"{share:g} beta" for share, period in periods.items() if period >= 2.0), "none")
        low, high = min(periods.values()), max(periods.values())
        ranges.append(f"from {low:.2f} s to {high:.2f} s ({name}; 2 s and more from {reached} on)")
        yield from released_ones[1::4]
        for share in (0.05, 0.1, 0.3, 0.5, 0.7, 0.9):
            what = f"{name}: period of the run, phi_0 = {share:g} beta"
            yield at_least(what, periods[share], 2.0, "s", inside=share >= 0.7)
        for share in (0.1, 0.9):
            what = f"{name}: T_C/T of Eq. 4, phi_0 = {share:g} beta"
            yield at_most(what, CONTROL_PERIOD / periods[share], 0.4, inside=share >= 0.7)
    yield (
        f"From {RELEASES[0]:g} to {RELEASES[-1]:g} beta the period ranges {'; '.join(ranges)}. As long as it is "
        f"shorter than T_C = {CONTROL_PERIOD:g} s the container is on the plateau. That T_C belongs to ground D of "
        "EN 1998-1 Table 3.2, the paper's S = 1.5 to another ground."
    )


@claim(
    "2, Lyapunov stability, Klotter",
    "semi-stable ... perturbations to the outside are divergent while perturbations to the inside are stable",
)
def semi_stable_orbit(experiments: Experiments) -> Evidence:
    """Kicks at rest scanned around the analytic limit, and release beside beta; box and stack, rigid and shell."""
    kicked, parted, cases = [], [], []
    for name, base in BODIES.items():
        block = experiments.block(base)
        kick = _analytic_kick(block)
        kicked.append(_largest_kick(experiments, base.but(RIGID, FREE, duration=5.0, interval=0.02), kick))
        what = f"{name}, rigid: largest kick that returns over p sqrt(2 (1 - cos beta)) = {kick:.4f} rad/s"
        yield equal(what, kicked[-1], 1.0, 0.005)
        for kind, model in (("rigid", RIGID), ("reduced", SHELL)):
            pair = [
                base.but(
                    FREE,
                    model,
                    rotation=share * block.slenderness_angle,
                    duration=10.0,
                    interval=0.01,
                    what=f"{name}, {kind}, released at {share:g} beta",
                )
                for share in (0.98, 1.02)
            ]
            cases += pair
            inner, outer = experiments.rows(pair)
            beside = [
                at_least(f"{name}, {kind}: released at 0.98 beta it stands", stands(inner), 1.0),
                at_least(f"{name}, {kind}: released at 1.02 beta it falls", not stands(outer), 1.0),
            ]
            yield from beside
            parted += [one.holds for one in beside]
    lines = []
    for case in cases[:2]:
        history = experiments.run(case).history
        shown = history["time_s"] <= 6.0
        rotation, velocity = history["rotation_rad"][shown], history["angular_velocity_rad_s"][shown]
        lines.append(curve(rotation, velocity, case.what))
    yield (
        "The orbit through rest at beta separates the motions that return from those that overturn: of "
        f"{len(parted)} releases on either side {sum(parted)} ended so. The largest kick that "
        f"returns is {' and '.join(f'{one:.4f}' for one in kicked)} of the analytic one for the rigid stack and box."
    )
    yield from cases
    yield draw_curves(
        "semi-stable-orbit",
        "Phase portrait of the rigid stack released 2 % inside and outside of beta.",
        "rotation [rad] | angular velocity [rad/s]",
        lines,
    )
    kick = 0.97 * _analytic_kick(experiments.block(STACK))
    yield experiments.band(
        STACK.but(FREE, velocity=kick, duration=5.0),
        "rotation ratio after 0.97 of the analytic kick",
        "it returns",
        stands,
    )


def _analytic_kick(block: RigidBlock) -> float:
    """Angular velocity at rest that just brings a block to beta, p sqrt(2 (1 - cos beta)) [rad/s]."""
    return 2.0 * block.frequency_parameter * math.sin(0.5 * block.slenderness_angle)


def _largest_kick(experiments: Experiments, case: PaperCase, kick: float) -> float:
    """Scan by a quarter of a per cent around a kick: where standing ends, over the kick; nan if it ends twice."""
    factors = [1.0 + 0.0025 * n for n in range(-4, 5)]
    scan = case.scan("velocity", [factor * kick for factor in factors], "kicked by {:g} rad/s")
    falls = [not stands(row) for row in experiments.rows(scan)]
    first = falls.index(True) if True in falls else 0
    return 0.5 * (factors[first - 1] + factors[first]) if first and all(falls[first:]) else math.nan
