"""What the paper says of rocking: its periods, Eqs. (2) to (4), and the orbit beyond which it overturns."""

import math

import numpy as np

from contact.reference.closed_forms_rocking import quarter_period
from contact.reference.rigid_block import RigidBlock
from fem.assessment.rigid_check import block_of
from fem.model.static_checks import period_eq2, period_eq3
from fem.paper.cases import BOX, GRAVITY, HEIGHT, NO_SLIDING, STACK, WIDTH
from fem.paper.claims import Band, Comparison, Finding, Member, Setup, Statement, Table
from fem.paper.experiments import RIGID, Laboratory
from fem.paper.figures import Line, drawing

FREE = {"motion.kind": "none", **NO_SLIDING}
RELEASES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98)  #: over the slenderness angle
CONTROL_PERIOD = 0.8  # s, T_C of Eq. (4)
#: a body whose inertia about its centre is nothing: the mathematical pendulum of the paper's remark
POINT_MASS = 1.0 + 1e-9


def measured_periods(laboratory: Laboratory, base: Setup) -> tuple[RigidBlock, list[Setup], list[float]]:
    """Four times the time from release to the first impact, for RELEASES [s]."""
    block = block_of(laboratory.model(base.but(RIGID)))
    setups = [
        base.but(
            {
                **RIGID,
                **FREE,
                "initial.rotation_rad": float(f"{share * block.slenderness_angle:.8g}"),
                "solver.duration_s": 3.0,
            },
            f"{'stack' if base is STACK else 'box'} released at {share:g} of beta",
        )
        for share in RELEASES
    ]
    rows = laboratory.rows(setups)
    times = [row["first_impact_s"] for row in rows]
    return block, setups, [math.nan if time is None else 4.0 * time for time in times]


def eq_2(laboratory: Laboratory) -> Finding:
    """Eq. (2): a point mass at small rotation."""
    block, setups, periods = measured_periods(laboratory, STACK)
    angle, gravity = block.slenderness_angle, block.gravity
    point = RigidBlock(
        half_width=block.half_width,
        centroid_height=block.centroid_height,
        gravity=gravity,
        inertia_ratio=POINT_MASS,
    )

    def printed(share: float) -> float:
        return period_eq2(
            width=2.0 * block.half_width,
            radius=block.radius,
            gravity=gravity,
            initial_rotation=share * angle,
        )

    comparisons = [
        _ratio(
            f"Eq. 2 over the exact period of a point mass, phi_0 = {share:g} beta",
            printed(share) / (4.0 * quarter_period(point, share * angle)),
            inside=share <= 0.1,
        )
        for share in (0.05, 0.1, 0.2, 0.5, 0.9)
    ]
    comparisons += [
        _ratio(
            f"Eq. 2 over the period of the stack's run, phi_0 = {share:g} beta",
            printed(share) / period,
            inside=False,
        )
        for share, period in zip(RELEASES, periods, strict=True)
        if share in (0.05, 0.5, 0.9)
    ]
    small = printed(RELEASES[0]) / periods[0]
    return Finding(
        comparisons=tuple(comparisons),
        bounds="a point mass, rotations up to 0.1 beta",
        reading=(
            f"At {RELEASES[0]:g} beta Eq. 2 gives {small:.3f} of the stack's period. A point mass without rotational "
            f"inertia, which the paper remarks on, would have sqrt(3/4) = {math.sqrt(0.75):.3f} of it at small "
            "rotation. Towards beta the period of either grows without bound, and Eq. 2 does not."
        ),
        setups=tuple(setups),
    )


def eq_3(laboratory: Laboratory) -> Finding:
    """Eq. (3): a hanging bar; and whether it represents rocking better than Eq. (2)."""
    tables, lines, setups, comparisons, met = [], [], [], [], []
    far: dict[str, list[float]] = {"Eq. 2": [], "Eq. 3": []}
    for name, base in (("stack", STACK), ("box", BOX)):
        block, released, periods = measured_periods(laboratory, base)
        angle, gravity = block.slenderness_angle, block.gravity
        third = period_eq3(radius=block.radius, gravity=gravity)
        exact = [4.0 * quarter_period(block, share * angle) for share in RELEASES]
        second = [
            period_eq2(
                width=2.0 * block.half_width,
                radius=block.radius,
                gravity=gravity,
                initial_rotation=share * angle,
            )
            for share in RELEASES
        ]
        setups += released[::3]
        met.append(f"{float(np.interp(third, exact, RELEASES)):.2f} beta ({name})")
        comparisons += [
            _ratio(
                f"{name}: Eq. 3 over the period of the run, phi_0 = {share:g} beta",
                third / period,
                tolerance=0.1,
                inside=share == 0.6,
            )
            for share, period in zip(RELEASES, periods, strict=True)
            if share in (0.1, 0.3, 0.6, 0.9)
        ]
        far["Eq. 2"] += [abs(math.log(two / period)) for two, period in zip(second, periods, strict=True)]
        far["Eq. 3"] += [abs(math.log(third / period)) for period in periods]
        lines += [
            Line(x=RELEASES, y=periods, label=f"{name}, run", style="o"),
            Line(x=RELEASES, y=exact, label=f"{name}, exact block"),
            Line(x=RELEASES, y=second, label=f"{name}, Eq. 2", style=":"),
            Line(x=RELEASES, y=[third] * len(RELEASES), label=f"{name}, Eq. 3", style="--"),
        ]
        tables.append(
            Table(
                caption=f"Period of the {name} [s]",
                columns=("phi_0/beta [-]", "run", "exact", "Eq. 2", "Eq. 3"),
                rows=tuple(
                    (share, period, true, two, third)
                    for share, period, true, two in zip(RELEASES, periods, exact, second, strict=True)
                ),
            )
        )
    typical = {name: math.exp(float(np.median(values))) - 1.0 for name, values in far.items()}
    length = math.hypot(WIDTH, HEIGHT)
    comparisons += [
        _ratio(
            "Eq. 3 over the period of a hanging bar of length 2 r, 2 pi sqrt(2 L/(3 g))",
            period_eq3(radius=0.5 * length, gravity=GRAVITY)
            / (2.0 * math.pi * math.sqrt(2.0 * length / (3.0 * GRAVITY))),
            tolerance=1e-9,
        ),
        Comparison(
            what="median distance from the runs' periods, Eq. 3 over Eq. 2",
            measured=typical["Eq. 3"] / typical["Eq. 2"],
            relation="<=",
            limit=1.0,
            unit="-",
            inside=False,
        ),
    ]
    return Finding(
        comparisons=tuple(comparisons),
        bounds="as the period of a hanging bar; as that of rocking near phi_0 = 0.6 beta alone",
        reading=(
            "A rocking block has no natural period: from nothing at small rotation its period grows "
            "beyond every bound at beta. Eq. 3, 2 pi/p, meets the exact block's at "
            f"{' and '.join(met)}. The median distance of "
            f"Eq. 3 from the runs is {100.0 * typical['Eq. 3']:.0f} %, that of Eq. 2 "
            f"{100.0 * typical['Eq. 2']:.0f} %."
        ),
        setups=tuple(setups),
        tables=tuple(tables),
        drawings=(
            drawing(
                "periods",
                "Period of free rocking over the rotation of release: runs, exact block, Eqs. 2 and 3.",
                lines,
                x_label="initial rotation over the slenderness angle [-]",
                y_label="period [s]",
            ),
        ),
        band=_band_of_periods(laboratory),
    )


def _band_of_periods(laboratory: Laboratory) -> Band:
    """Period at half of beta over deformation, contact and support, over the exact block's."""
    block = block_of(laboratory.model(STACK.but(RIGID)))
    rotation = 0.5 * block.slenderness_angle
    exact = quarter_period(block, rotation)
    return laboratory.band(
        STACK.but({**FREE, "initial.rotation_rad": float(f"{rotation:.8g}"), "solver.duration_s": 1.5}),
        quantity="period of the stack released at 0.5 beta over the exact block's",
        unit="-",
        value=lambda row: None if row["first_impact_s"] is None else row["first_impact_s"] / exact,
        criterion="within 5 % of the exact block's",
        holds=lambda row: (
            row["first_impact_s"] is not None and abs(row["first_impact_s"] / exact - 1.0) <= 0.05
        ),
    )


def control_periods(laboratory: Laboratory) -> Finding:
    """T of 2 s and more against the control period, Eq. (4)."""
    comparisons, setups, ranges = [], [], []
    for name, base in (("box", BOX), ("stack", STACK)):
        _, released, periods = measured_periods(laboratory, base)
        reached = next((f"{s:g} beta" for s, T in zip(RELEASES, periods, strict=True) if T >= 2.0), "none")
        ranges.append(
            f"from {min(periods):.2f} s to {max(periods):.2f} s ({name}; 2 s and more from {reached} on)"
        )
        setups += released[1::4]
        comparisons += [
            Comparison(
                what=f"{name}: period of the run, phi_0 = {share:g} beta",
                measured=period,
                relation=">=",
                limit=2.0,
                unit="s",
                inside=share >= 0.7,
            )
            for share, period in zip(RELEASES, periods, strict=True)
            if share in (0.05, 0.1, 0.3, 0.5, 0.7, 0.9)
        ]
        comparisons += [
            Comparison(
                what=f"{name}: T_C/T of Eq. 4, phi_0 = {share:g} beta",
                measured=CONTROL_PERIOD / period,
                relation="<=",
                limit=0.4,
                unit="-",
                inside=share >= 0.7,
            )
            for share, period in zip(RELEASES, periods, strict=True)
            if share in (0.1, 0.9)
        ]
    return Finding(
        comparisons=tuple(comparisons),
        bounds="rotations of 0.7 beta and more",
        reading=(
            f"From {RELEASES[0]:g} to {RELEASES[-1]:g} beta the period goes {'; '.join(ranges)}. As long as it is "
            f"shorter than T_C = {CONTROL_PERIOD:g} s the container is on the plateau. That T_C belongs to ground D of "
            "EN 1998-1 Table 3.2, the paper's S = 1.5 to another ground."
        ),
        setups=tuple(setups),
    )


def semi_stable_orbit(laboratory: Laboratory) -> Finding:
    """The largest kick from which the container returns, and release beside beta."""
    comparisons, setups, lines = [], [], []
    for name, base in (("stack", STACK), ("box", BOX)):
        block = block_of(laboratory.model(base.but(RIGID)))
        kick = 2.0 * block.frequency_parameter * math.sin(0.5 * block.slenderness_angle)
        largest = _largest_kick(laboratory, base.but({**RIGID, **FREE}), kick, step=0.0025, share=0.01)
        comparisons.append(
            Comparison(
                what=(
                    f"{name}, rigid: largest kick that returns over p sqrt(2 (1 - cos beta)) = {kick:.4f} "
                    "rad/s"
                ),
                measured=largest,
                relation="=",
                limit=1.0,
                unit="-",
                tolerance=0.005,
            )
        )
        for model in ("rigid", "reduced"):
            pair = [
                base.but(
                    {
                        **FREE,
                        "solver.model": model,
                        "initial.rotation_rad": float(f"{share * block.slenderness_angle:.8g}"),
                        "solver.duration_s": 10.0,
                        "output.history_s": 0.01,
                    },
                    f"{name}, {model}, released at {share:g} beta",
                )
                for share in (0.98, 1.02)
            ]
            inner, outer = laboratory.rows(pair)
            setups += pair
            comparisons += [
                _truth(f"{name}, {model}: released at 0.98 beta it stands", inner["outcome"] != "overturned"),
                _truth(f"{name}, {model}: released at 1.02 beta it falls", outer["outcome"] == "overturned"),
            ]
    for setup in setups[:2]:
        history = laboratory.record(setup).history
        window = history["time_s"] <= 6.0
        lines.append(
            Line(
                x=history["rotation_rad"][window],
                y=history["angular_velocity_rad_s"][window],
                label=setup.what,
            )
        )
    band = _band_of_kicks(laboratory)
    kicked = [one for one in comparisons if one.relation == "="]
    parted = [one for one in comparisons if one.relation == ">="]
    return Finding(
        comparisons=tuple(comparisons),
        reading=(
            "The orbit through rest at beta parts the motions that come back from those that fall: of "
            f"{len(parted)} releases beside it {sum(one.holds for one in parted)} ended so. The largest kick that "
            f"returns is {' and '.join(f'{one.measured:.4f}' for one in kicked)} of the analytic one for the rigid "
            f"stack and box; for the stack over deformation, contact and support it lies between {band.low:.2f} and "
            f"{band.high:.2f} of it (scanned by 0.02)."
        ),
        setups=tuple(setups),
        drawings=(
            drawing(
                "semi-stable-orbit",
                "Phase portrait of the rigid stack released 2 % inside and outside of beta.",
                lines,
                x_label="rotation [rad]",
                y_label="angular velocity [rad/s]",
            ),
        ),
        band=band,
    )


def _band_of_kicks(laboratory: Laboratory) -> Band:
    """Largest kick of the stack over deformation, contact and support, over the analytic one."""
    block = block_of(laboratory.model(STACK.but(RIGID)))
    kick = 2.0 * block.frequency_parameter * math.sin(0.5 * block.slenderness_angle)
    members = []
    for setup in laboratory.variants(STACK.but(FREE)):
        largest = _largest_kick(laboratory, setup, kick, step=0.02, share=0.08)
        members.append(
            Member(
                what=setup.what,
                command=setup.but(_kick(kick)).command,
                outcome="" if math.isfinite(largest) else None,
                value=largest if math.isfinite(largest) else None,
                holds=abs(largest - 1.0) <= 0.03 if math.isfinite(largest) else None,
            )
        )
    return Band(
        quantity="largest kick that returns, over the analytic one",
        unit="-",
        criterion="within 3 % of the analytic one",
        members=tuple(members),
    )


def _kick(angular_velocity: float) -> dict[str, float]:
    return {
        "initial.angular_velocity_rad_s": float(f"{angular_velocity:.8g}"),
        "solver.duration_s": 5.0,
        "output.history_s": 0.02,
    }


def _largest_kick(laboratory: Laboratory, setup: Setup, kick: float, *, step: float, share: float) -> float:
    """Scan around a kick: where standing ends, over the kick; nan if it does not end, or more than once."""
    count = round(share / step)
    factors = [1.0 + step * n for n in range(-count, count + 1)]
    rows = laboratory.attempts([setup.but(_kick(factor * kick)) for factor in factors])
    if any(row["status"] == "failed" for row in rows):
        return math.nan
    falls = [row["outcome"] == "overturned" for row in rows]
    if True not in falls or falls[0] or not all(falls[falls.index(True) :]):
        return math.nan
    first = falls.index(True)
    return 0.5 * (factors[first - 1] + factors[first])


def _ratio(what: str, measured: float, *, tolerance: float = 0.05, inside: bool = True) -> Comparison:
    return Comparison(
        what=what, measured=measured, relation="=", limit=1.0, unit="-", tolerance=tolerance, inside=inside
    )


def _truth(what: str, found: bool) -> Comparison:
    return Comparison(what=what, measured=float(found), relation=">=", limit=1.0, unit="-")


STATEMENTS = (
    Statement(
        name="eq-2",
        section="4.2, Eq. 2",
        quote="T = 8 sqrt(phi_0 r²/(a g)) ... a mathematical pendulum rather than a physical pendulum",
        tried=(
            "Rigid stack released at twelve rotations; four times the time to its first impact; the exact "
            "point mass."
        ),
        examine=eq_2,
    ),
    Statement(
        name="eq-3",
        section="4.2, Eq. 3",
        quote="T = 2 pi sqrt(4 r/(3 g)) ... seems to be a better representation for our engineering problem",
        tried="The same runs, of stack and box, against Eqs. 2 and 3.",
        examine=eq_3,
    ),
    Statement(
        name="control-periods",
        section="4.2, Eq. 4",
        quote=(
            "the rocking period of bodies with practical dimensions is T >= 2 s ... smaller than the "
            "plateau value"
        ),
        tried="The same runs against 2 s, and Eq. 4 with their periods.",
        examine=control_periods,
    ),
    Statement(
        name="semi-stable-orbit",
        section="2, Lyapunov stability, Klotter",
        quote=(
            "semi-stable ... perturbations to the outside are divergent while perturbations to the inside "
            "are stable"
        ),
        tried=(
            "Kicks at rest scanned around the analytic limit, and release beside beta; box and stack, "
            "rigid and shell."
        ),
        examine=semi_stable_orbit,
        seconds=2.0,
    ),
)
