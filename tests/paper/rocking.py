"""What the paper says of rocking and response: periods, Eqs. (2) to (4), the last orbit that returns, amplification."""

import math

import numpy as np
from closed_forms import quarter_period
from evidence.findings import at_least, at_most, equal
from paper.cases import BOX, FOR_MAPS, NO_SLIDING, PLATEAU, RIGID, SHELL, STACK, PaperCase
from paper.claims import Curve, Evidence, claim, draw_curves
from paper.dimensions import GRAVITY, HEIGHT, PLATEAU_PEAK, WIDTH
from paper.experiments import Experiments, VariantBand, stands, variant_result
from runs import Finished

from contact.reference.rigid_block import RigidBlock
from fem.model.static_checks import period_eq2, period_eq3
from fem.run.sureness import changes_of

FREE = {"motion.kind": "none", **NO_SLIDING}
RELEASES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98)  #: over the slenderness angle
BODIES = {"stack": STACK, "box": BOX}
CONTROL_PERIOD = 0.8  # s, T_C of Eq. (4)
#: of the stack with g = 9.81 [rad/s]
OMEGA_EQ_3 = 2.0 * math.pi / period_eq3(radius=0.5 * math.hypot(WIDTH, HEIGHT), gravity=GRAVITY)
PEAKS = (2.4, 2.9, 3.4, 4.0)  #: m/s2
RATIOS = np.array([1.05, 1.1, 1.2, 1.41, 1.6, 1.8, 2.0, 2.5, 3.0, 3.68, 4.5, 5.5, 7.0])  #: eta
IMPACT = 0.05  #: s, over which a horizontal load is averaged where an impact is not to count
TOLERANCE = 0.01  #: a factor that near to 1 is 1
#: a body whose inertia about its centre is nothing: the mathematical pendulum of the paper's remark
POINT_MASS = 1.0 + 1e-9


def _periods(experiments: Experiments, name: str) -> tuple[RigidBlock, list[PaperCase], dict[float, float]]:
    """Analytic block, cases, and four times the time from release to the first impact, by RELEASES [s]."""
    block = experiments.block(BODIES[name])
    released = [share * block.slenderness_angle for share in RELEASES]
    free = BODIES[name].but(RIGID, FREE, duration=3.0)
    cases = free.scan("rotation", released, f"{name} released at {{:.4f}} rad")
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
    bounds="a point mass, rotations up to 0.1 of the slenderness angle",
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
        what = f"Eq. 2 over the exact period of a point mass, released at {share:g} of the slenderness angle"
        yield equal(what, _eq_2(block, share) / exact, 1.0, 0.05, inside=share <= 0.1)
    for share in (0.05, 0.5, 0.9):
        what = f"Eq. 2 over the period of the stack's run, released at {share:g} of the slenderness angle"
        yield equal(what, _eq_2(block, share) / periods[share], 1.0, 0.05, inside=False)
    small = _eq_2(block, RELEASES[0]) / periods[RELEASES[0]]
    yield (
        f"At {RELEASES[0]:g} of the slenderness angle Eq. 2 gives {small:.3f} of the stack's period. A point mass "
        f"without rotational inertia, which the paper remarks on, would have sqrt(3/4) = {math.sqrt(0.75):.3f} of it "
        "at small rotation. Towards the slenderness angle the period grows without bound, and Eq. 2 does not."
    )
    yield from cases


@claim(
    "4.2, Eq. 3",
    "T = 2 pi sqrt(4 r/(3 g)) ... seems to be a better representation for our engineering problem",
    bounds="as the period of a hanging bar; as that of rocking released near 0.6 of the slenderness angle alone",
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
        met.append(f"{float(np.interp(third, exact, RELEASES)):.2f} of the slenderness angle ({name})")
        for share in (0.1, 0.3, 0.6, 0.9):
            what = f"{name}: Eq. 3 over the period of the run, released at {share:g} of the slenderness angle"
            yield equal(what, third / periods[share], 1.0, 0.1, inside=share == 0.6)
        far_2 += [abs(math.log(two / run)) for two, run in zip(second, periods.values(), strict=True)]
        far_3 += [abs(math.log(third / run)) for run in periods.values()]
        lines += [
            Curve(RELEASES, list(periods.values()), f"{name}, run", "o"),
            Curve(RELEASES, exact, f"{name}, exact block"),
            Curve(RELEASES, second, f"{name}, Eq. 2", ":"),
            Curve(RELEASES, [third] * len(RELEASES), f"{name}, Eq. 3", "--"),
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
        "towards the slenderness angle. Eq. 3, 2 pi/p, equals the period of the exact block at "
        f"{' and '.join(met)}. The median distance of "
        f"Eq. 3 from the runs is {100.0 * typical_3:.0f} %, that of Eq. 2 {100.0 * typical_2:.0f} %."
    )
    yield draw_curves(
        "periods",
        "Period of free rocking over the rotation of release: runs, exact block, Eqs. 2 and 3.",
        "initial rotation over the slenderness angle [-] | period [s]",
        lines,
    )
    block = experiments.block(STACK)
    rotation = 0.5 * block.slenderness_angle
    quarter = quarter_period(block, rotation)
    yield experiments.band(
        STACK.but(FREE, rotation=rotation, duration=1.5),
        "period of the stack released at 0.5 of the slenderness angle over the exact block's",
        "within 5 % of the exact block's",
        lambda row: abs((row["first_impact_s"] or math.inf) / quarter - 1.0) <= 0.05,
        value=lambda row: row["first_impact_s"] and row["first_impact_s"] / quarter,
    )


@claim(
    "4.2, Eq. 4",
    "the rocking period of bodies with practical dimensions is T >= 2 s ... smaller than the plateau value",
    bounds="rotations of 0.7 of the slenderness angle and more",
)
def control_periods(experiments: Experiments) -> Evidence:
    """The same runs against 2 s, and Eq. 4 with their periods."""
    ranges = []
    for name in ("box", "stack"):
        _, released_ones, periods = _periods(experiments, name)
        reached = next(
            (f"{share:g} of the slenderness angle" for share, period in periods.items() if period >= 2.0),
            "none",
        )
        low, high = min(periods.values()), max(periods.values())
        ranges.append(f"from {low:.2f} s to {high:.2f} s ({name}; 2 s and more from {reached} on)")
        yield from released_ones[1::4]
        for share in (0.05, 0.1, 0.3, 0.5, 0.7, 0.9):
            what = f"{name}: period of the run, released at {share:g} of the slenderness angle"
            yield at_least(what, periods[share], 2.0, "s", inside=share >= 0.7)
        for share in (0.1, 0.9):
            what = f"{name}: T_C/T of Eq. 4, released at {share:g} of the slenderness angle"
            yield at_most(what, CONTROL_PERIOD / periods[share], 0.4, inside=share >= 0.7)
    yield (
        f"From {RELEASES[0]:g} to {RELEASES[-1]:g} of the slenderness angle the period ranges {'; '.join(ranges)}. "
        f"As long as it is shorter than T_C = {CONTROL_PERIOD:g} s the container is on the plateau. That T_C belongs "
        "to ground D of EN 1998-1 Table 3.2, the paper's S = 1.5 to another ground."
    )


@claim(
    "2, Lyapunov stability, Klotter",
    "semi-stable ... perturbations to the outside are divergent while perturbations to the inside are stable",
)
def semi_stable_orbit(experiments: Experiments) -> Evidence:
    """Kicks at rest scanned around the analytic limit, and release beside the slenderness angle; box and stack, rigid
    and shell."""
    kicked, parted, cases = [], [], []
    for name, base in BODIES.items():
        block = experiments.block(base)
        kick = _analytic_kick(block)
        # a scan by a quarter of a per cent around the kick: where standing ends, nan if it ends twice
        factors = [1.0 + 0.0025 * n for n in range(-4, 5)]
        case = base.but(RIGID, FREE, duration=5.0, interval=0.02)
        scan = case.scan("velocity", [factor * kick for factor in factors], "kicked by {:g} rad/s")
        rows = zip(factors, experiments.rows(scan), strict=True)
        changes = changes_of({factor: "stands" if stands(row) else "falls" for factor, row in rows})
        once = [change.above for change in changes] == ["falls"]
        kicked.append(changes[0].value if once else math.nan)
        what = f"{name}, rigid: largest kick that returns over p sqrt(2 (1 - cos beta)) = {kick:.4f} rad/s"
        yield equal(what, kicked[-1], 1.0, 0.005)
        sides = [share * block.slenderness_angle for share in (0.98, 1.02)]
        for kind, model in (("rigid", RIGID), ("reduced", SHELL)):
            released = base.but(FREE, model, duration=10.0, interval=0.01)
            pair = released.scan("rotation", sides, f"{name}, {kind}, released at {{:.4f}} rad")
            inner, outer = experiments.rows(pair)
            cases += pair
            parted += [stands(inner), not stands(outer)]
            yield at_least(
                f"{name}, {kind}: released at 0.98 of the slenderness angle it stands", parted[-2], 1.0
            )
            yield at_least(
                f"{name}, {kind}: released at 1.02 of the slenderness angle it falls", parted[-1], 1.0
            )
    lines = []
    for case in cases[:2]:
        history = experiments.run(case).history
        early = history["time_s"] <= 6.0
        rotation, velocity = history["rotation_rad"][early], history["angular_velocity_rad_s"][early]
        lines.append(Curve(rotation, velocity, case.what))
    yield (
        "The orbit through rest at the slenderness angle separates the motions that return from those that overturn: "
        f"of {len(parted)} releases on either side {sum(parted)} ended so. The largest kick that returns "
        f"is {' and '.join(f'{ratio:.4f}' for ratio in kicked)} of the analytic one for the rigid stack and box."
    )
    yield from cases
    yield draw_curves(
        "semi-stable-orbit",
        "Phase portrait of the rigid stack released 2 % inside and outside of the slenderness angle.",
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
    """Angular velocity at rest that just brings a block to the slenderness angle, p sqrt(2 (1 - cos beta)) [rad/s]."""
    return 2.0 * block.frequency_parameter * math.sin(0.5 * block.slenderness_angle)


@claim(
    "4.2",
    "With a prescribed base displacement and eta > 1, even for a steady state drive the DAF for "
    "the absolute amplitude of the oscillator remains < 1",
    bounds="eta above sqrt 2, among the cases that stand",
)
def mass_centre(experiments: Experiments) -> Evidence:
    """Rigid stack, mu 0.4/0.2, three peaks, eta from 1 to 7: amplitude of the mass centre over the floor's."""
    curves = []
    overturned = np.zeros(RATIOS.size, dtype=int)
    near = math.sqrt(2.0) >= RATIOS
    base = STACK.but(FOR_MAPS, interval=0.002, duration=25.0)
    for peak in PEAKS:
        frequencies = (RATIOS * OMEGA_EQ_3).tolist()
        group = base.but(peak=peak).scan("frequency", frequencies, f"stack, {peak:g} m/s² at {{:.4g}} rad/s")
        runs = [experiments.run(case, also_failed=True) for case in group]
        yield from [case for case, ratio in zip(group, RATIOS, strict=True) if ratio in (1.2, 2.0)]
        overturned += [run.status == "overturned" for run in runs]
        factors = np.array([_factor(run) for run in runs])
        curves.append(Curve(RATIOS, factors, f"{peak:g} m/s²", "o-"))
        for which, chosen, inside in (("above sqrt 2", ~near, True), ("from 1 to sqrt 2", near, False)):
            known = factors[chosen & np.isfinite(factors)]
            what = f"{peak:g} m/s²: largest DAF, eta {which}, cases that stand"
            if known.size:
                yield at_most(what, known.max(), 1.0 + TOLERANCE, inside=inside)
    total, slow = len(PEAKS) * RATIOS.size, len(PEAKS) * near.sum()
    yield at_most(f"runs with eta above 1 that overturn, of {total}", overturned.sum(), 0.0, inside=False)
    eta = np.linspace(1.45, 7.0, 100)
    yield (
        f"eta is taken with the paper's Eq. 3. {overturned.sum()} of {total} runs overturn, of them "
        f"{overturned[near].sum()} of {slow} with eta up to sqrt 2, and "
        "a displacement factor does not show that. A linear oscillator needs eta > sqrt 2, not 1, for DAF < 1. A "
        "container that only sticks moves with the floor: DAF = 1, not less."
    )
    yield draw_curves(
        "mass-centre",
        "Displacement amplitude of the mass centre over that of the floor, last three cycles; gaps: overturned.",
        "eta = Omega / omega (Eq. 3) [-] | DAF [-]",
        [*curves, Curve(eta, 1.0 / (eta**2 - 1.0), "linear oscillator", ":")],
        y_limits=(0.0, 2.0),
    )
    yield _band(
        "DAF of the mass centre at the plateau value, eta = 3.68",
        [(case, run, _factor(run)) for case, run in _at_plateau(experiments)],
    )


@claim(
    "8",
    "by dynamic effects, there is no amplification that leads to higher horizontal loads",
    bounds="a rigid body outside impacts: 95 % of the time",
)
def no_amplification(experiments: Experiments) -> Evidence:
    """Horizontal force between floor and stack under the plateau value, over mass times 4.0 m/s²."""
    runs = _at_plateau(experiments)
    experiments.run(runs[0][0])  # the rigid run must not have failed
    loads = [(case, _loads(run)) for case, run in runs if run.status != "failed"]
    rigid, *shell = (load for _, load in loads)
    peak, mean, usual = (max(load[k] for load in shell) for k in range(3))
    of_all = [max(load[k] for _, load in loads) for k in range(2)]
    yield at_most("rigid: horizontal load over that of the plateau, 95 % of the time", rigid[2], 1.0)
    yield at_most("rigid: the same, mean of 50 ms", rigid[1], 1.0, inside=False)
    yield at_most("rigid: the same, peaks of impacts", rigid[0], 1.0, inside=False)
    yield at_most("shell: 95 % of the time, worst of the band", usual, 1.0, inside=False)
    yield at_most("shell: mean of 50 ms, worst of the band", mean, 1.0, inside=False)
    yield at_most("shell: peaks of impacts, worst of the band", peak, 1.0, inside=False)
    yield (
        f"For 95 % of the time the load on the rigid container is at most {rigid[2]:.2f} of the plateau load. "
        f"Impacts differ: the horizontal impulse of an impact, spread over 50 ms, is up to {of_all[1]:.2f} of the "
        f"plateau load. Its peak is up to {of_all[0]:.0f} times the plateau load, which is a property of the contact "
        "and not of the container. A shell vibrates after an impact: for one twentieth of the time its load exceeds "
        f"up to {usual:.2f} of the plateau load."
    )
    yield from [case for case, _ in loads[:2]]
    yield _band(
        "horizontal load over that of the plateau, 95 % of the time",
        [(case, run, math.nan if run.status == "failed" else _loads(run)[2]) for case, run in runs],
    )


def _at_plateau(experiments: Experiments) -> list[tuple[PaperCase, Finished]]:
    """The plateau value over deformation, contact and support, sampled closely."""
    variants = experiments.variants(PLATEAU.but(duration=10.0, interval=0.002))
    return [(case, experiments.run(case, also_failed=True)) for case in variants]


def _band(quantity: str, runs: list[tuple[PaperCase, Finished, float]]) -> VariantBand:
    """Of values that must be at most 1; nan where a run gave none."""
    members = [
        variant_result(case, run.status if math.isfinite(value) else None, value, value <= 1.0)
        for case, run, value in runs
    ]
    return VariantBand(quantity=quantity, unit="-", criterion="at most 1", members=members)


def _factor(run: Finished) -> float:
    """Half the peak to peak of the mass centre over that of the floor, largest of the last three cycles.

    nan for a run that failed or overturned.
    """
    if run.status != "completed":
        return math.nan
    time, floor = run.history["time_s"], run.history["base_displacement_m"]
    centre = floor + run.history["centre_x_m"]
    period = run.model.case.motion.period
    end = float(time[-1])
    cycles = [(time <= end - n * period) & (time >= end - (n + 1) * period) for n in range(3)]
    return max(float(np.ptp(centre[cycle]) / np.ptp(floor[cycle])) for cycle in cycles)


def _loads(run: Finished) -> tuple[float, float, float]:
    """Horizontal load over that of the plateau: largest, largest mean of 50 ms, and for 95 % of the time."""
    time, shear = run.history["time_s"], run.history["shear_force_N"]
    width = max(round(IMPACT / float(time[1] - time[0])), 1)
    plateau = run.model.container.mesh.mass * PLATEAU_PEAK
    mean = np.abs(np.convolve(shear, np.full(width, 1.0 / width), mode="valid")) / plateau
    load = np.abs(shear) / plateau
    return float(load.max()), float(mean.max()), float(np.quantile(load, 0.95))
