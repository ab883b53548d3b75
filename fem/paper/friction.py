"""What the paper says of friction: halts at the reversals, stick-slip there, and kinetic over static friction."""

import math

import numpy as np

from contact.reference.floor_acceleration import sine_floor
from contact.reference.sliding import RigidSlider, simulate_sliding
from fem.paper.cases import ANGULAR_FREQUENCY, BOX, FOR_MAPS, GRAVITY, PLATEAU, RIGID, STACK
from fem.paper.claims import Comparison, Evidence, at_most, claim, equal, table
from fem.paper.experiments import Experiments, stands
from fem.paper.figures import PlottedLine, draw_curves
from fem.paper.maps import pairs, stack_map


@claim(
    "3",
    "we have decaying speeds towards the extreme points, so that the relative motion ... "
    "gradually comes to a halt",
    bounds="strong motion: mu_k g below a quarter of the floor's peak acceleration",
)
def halt_at_extremes(experiments: Experiments) -> Evidence:
    """The exact slider from stiction to ten times its acceleration: phase of its halts."""
    frequency = 10.0
    peaks = np.geomspace(4.0, 40.0, 9)
    slider = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY)
    lags = []
    for peak in peaks:
        floor = sine_floor(amplitude=peak / frequency**2, angular_frequency=frequency)
        # at rest while the floor starts with its largest velocity: it does not drift to one side
        motion = simulate_sliding(
            slider, floor, duration=12.0 * math.pi / frequency, slip_velocity=-peak / frequency
        )
        ends = [one.end for one in motion.intervals if one.direction][-5:-1]
        phases = np.array(ends) * frequency % math.pi  # the extremes are at pi/2
        lags.append(float(np.degrees(np.abs(phases - 0.5 * math.pi)).max()))
    strong = max(lag for lag, peak in zip(lags, peaks, strict=True) if 0.2 * GRAVITY / peak <= 0.25)
    yield at_most(
        "phase between halt and extreme of the floor, mu_k g up to a quarter of the peak", strong, 30.0, "°"
    )
    yield at_most("the same, all peaks from stiction on", max(lags), 30.0, "°", inside=False)
    yield (
        f"The slip of the exact slider ends within {strong:.0f}° of phase of the extreme points of the floor where "
        f"mu_k g is at most a quarter of the peak, and within {max(lags):.0f}° for all peaks: it ends when body and "
        "floor have the same velocity, and the velocity of the body is that which friction gave it."
    )
    yield BOX.but(RIGID, peak=4.5, frequency=frequency, duration=5.0, what="box, 4.5 m/s² at 10 rad/s")
    yield draw_curves(
        "halt-at-extremes",
        "Phase between the end of a slip and the extreme point of the floor; exact slider, mu 0.4/0.2.",
        [PlottedLine(x=peaks, y=lags, style="o-")],
        x_label="peak floor acceleration [m/s²]",
        y_label="phase beside the extreme [°]",
        log_x=True,
    )


@claim(
    "3",
    "stick-slip phenomena towards the reversal ... do not affect the findings of this study",
    bounds="whether it stands; not how far it slides, nor whether it slides or rocks",
)
def reversal(experiments: Experiments) -> Evidence:
    """Box and stack with the same kinetic friction and with or without more static friction at the reversals."""
    rows = []
    largest = 0.0
    for name, base in (("box", BOX), ("stack", STACK)):
        for peak in (4.2, 5.0, 6.5, 8.0):
            group = [
                base.but(
                    FOR_MAPS,
                    mu_static=static,
                    mu_kinetic=0.2,
                    duration=10.0,
                    peak=peak,
                    frequency=10.0,
                    what=f"{name}, mu {static:g}/0.2, {peak:g} m/s² at 10 rad/s",
                )
                for static in (0.2, 0.4)
            ]
            yield from group
            smooth, rough = experiments.rows(group)
            differs = stands(smooth) != stands(rough)
            yield at_most(f"{name}, {peak:g} m/s²: stands or falls differently", differs, 0.0)
            if name == "box":
                change = abs(rough["slip_travel_m"] / smooth["slip_travel_m"] - 1.0)
                largest = max(largest, change)
                what = f"box, {peak:g} m/s²: |change of the path over the floor|"
                yield at_most(what, change, 0.05, inside=False)
            outcomes = smooth["outcome"], rough["outcome"]
            paths = 1e3 * smooth["slip_travel_m"], 1e3 * rough["slip_travel_m"]
            rows.append((name, peak, *outcomes, *paths))
    yield (
        "With mu_s = 0.4 in place of 0.2 at every reversal, and mu_k = 0.2 in both, "
        f"{sum((row[2] == 'overturned') != (row[3] == 'overturned') for row in rows)} of {len(rows)} motions "
        f"change between standing and overturning, and {sum(row[2] != row[3] for row in rows)} change their mode, "
        f"because mu_s starts a motion from rest. The path of the box changes by up to {largest:.0%}."
    )
    yield table(
        "Stick-slip at the reversals: mu_s = 0.2 and 0.4, mu_k = 0.2",
        "container | peak [m/s²] | outcome, 0.2/0.2 | outcome, 0.4/0.2 | path, 0.2/0.2 [mm] "
        "| path, 0.4/0.2 [mm]",
        rows,
    )
    yield experiments.band(
        STACK.but(peak=5.0, frequency=10.0, duration=6.0),
        quantity="rotation ratio of the stack at 5.0 m/s², 10 rad/s, mu 0.4/0.2",
        criterion="it stands",
        holds=stands,
    )


@claim(
    "4.3, Eq. 6",
    "the relation of mu_k being app. 50 % of mu_s is arbitrary; 92 % ... nearly 100 % of the stiction",
    bounds="whether the rigid stack overturns; not how far anything slides",
)
def friction_ratio(experiments: Experiments) -> Evidence:
    """Maps of the rigid stack with mu_k at 50, 92 and 100 % of 0.4, and the slip of a box."""
    names = {0.5: "50 %", 0.92: "92 %", 1.0: "100 %"}
    maps = {
        ratio: stack_map(experiments, (0.4, round(0.4 * ratio, 6)), perturbed=ratio in (0.5, 1.0))
        for ratio in names
    }
    rows = []
    for ratio in (0.92, 1.0):
        both = pairs(maps[0.5], maps[ratio])
        differ = [pair for pair in both if pair[0].fell != pair[1].fell]
        sure = [pair for pair in differ if pair[0].sure and pair[1].sure]
        what = f"sure cells that stand with 50 % and fall with {names[ratio]}, or the reverse"
        yield Comparison(what=what, measured=len(sure), relation="<=", limit=0.0)
        rows.append((names[ratio], len(both), len(differ), len(sure)))
        yield from [one.case for one, _ in sure[:1]]
    boxes = [
        BOX.but(
            FOR_MAPS,
            mu_kinetic=round(0.4 * ratio, 6),
            duration=10.0,
            peak=5.0,
            frequency=ANGULAR_FREQUENCY,
            what=f"box, mu_k = {name} of 0.4, 5.0 m/s² at 6.928 rad/s",
        )
        for ratio, name in names.items()
    ]
    half, most, full = (row["max_slip_m"] for row in experiments.rows(boxes))
    yield equal("largest slip of a box, 92 % over 50 %", most / half, 1.0, 0.1, inside=False)
    yield equal("largest slip of a box, 100 % over 50 %", full / half, 1.0, 0.1, inside=False)
    yield (
        f"The largest slip of a box under 5.0 m/s² is {1e3 * half:.0f} mm at 50 %, {1e3 * most:.0f} mm at 92 % "
        f"and {1e3 * full:.0f} mm at 100 %. The outcome of the rigid stack "
        f"changes in {rows[0][2]} and {rows[1][2]} of its {rows[0][1]} cells, {rows[0][3]} and "
        f"{rows[1][3]} of them sure. The paper calls this choice arbitrary."
    )
    yield from boxes
    yield table(
        "Cells of the stack's map whose outcome differs from that with mu_k = 50 % of mu_s = 0.4",
        "mu_k over mu_s | cells | another outcome | .. and sure",
        rows,
    )
    yield experiments.band(
        PLATEAU.but(mu_kinetic=0.4, duration=10.0),
        quantity="rotation ratio at the plateau value with mu_k = mu_s",
        criterion="the same outcome as with mu_k = 0.5 mu_s on the rigid block: it rocks",
        holds=lambda row: row["outcome"] == "rock",
    )
