"""What the paper says of overturning: what is restored before it happens, reversal, and A against a/2."""

import math

import numpy as np
from closed_forms import first_swing_threshold, sustained_sine_threshold_slender
from evidence.findings import at_least, at_most
from floors import sine_floor
from paper.cases import FOR_MAPS, NO_SLIDING, PLATEAU, RIGID, SHELL, STACK
from paper.claims import Curve, Evidence, claim, draw_curves, table
from paper.dimensions import ANGULAR_FREQUENCY, FREQUENCY_PARAMETER, HALF_WIDTH, HOLDING, PAPER_MU, UPLIFT
from paper.experiments import Experiments, capped_ratio, stands
from paper.maps import FAST, FREQUENCIES, MapCell, draw_map, stack_map

from fem.figures.heat_map import MapCurve

FRICTIONS = {"mu 0.4/0.2": PAPER_MU, "mu 1.0": HOLDING}


@claim(
    "abstract, 1",
    "neither the beginning of an overturning motion nor the loss of stiction necessarily causes "
    "the structure to fall over",
)
def beginning_is_restored(experiments: Experiments) -> Evidence:
    """Map of the rigid stack over frequency and peak acceleration, with friction that slips and that holds; ten
    cycles of the plateau value."""
    rows = []
    for name, mu in FRICTIONS.items():
        cells = stack_map(experiments, mu).cells
        tilted = [cell for cell in cells if cell.tilted]
        slid = [cell for cell in cells if cell.row["max_slip_m"] > 1.1e-4]
        back, held = (sum(cell.stood and cell.sure for cell in group) for group in (tilted, slid))
        rows.append((name, len(cells), len(tilted), back, len(slid), held))
        yield at_least(f"{name}: cells that tilt and surely stand", back, 1.0)
        if mu != HOLDING:
            yield at_least(f"{name}: cells that lose stiction and surely stand", held, 1.0)
    pulse = PLATEAU.but(
        RIGID, cycles=10.0, duration=25.0, what="stack, ten cycles of 4.0 m/s², then a floor at rest"
    )
    restored = bool(experiments.row(pulse)["restored"])
    yield at_least("ten cycles of the plateau value: it tilts and is back on its base", restored, 1.0)
    _, tilting, returned, sliding, stood = np.sum([row[1:] for row in rows], axis=0)
    yield (
        f"Of the motions of the map that tilt the stack, {returned} of {tilting} are sure not to overturn "
        f"it; of those that make it slide, {stood} of {sliding}. After ten cycles of the plateau value "
        f"and a floor at rest it is {'back on its base' if restored else 'not back on its base'}. The "
        "counts are of cells, not of earthquakes."
    )
    yield pulse
    yield table(
        "Cells of the stack's map",
        "friction | cells | tilt | .. and surely stand | lose stiction | .. and surely stand",
        rows,
    )
    yield experiments.band(
        pulse.but(SHELL, duration=20.0),
        "rotation ratio",
        "it tilts and does not overturn",
        lambda row: row["first_uplift_s"] is not None and stands(row),
    )


@claim(
    "1",
    "if tilting starts short before reversal of the ground motion, some bumping will happen, but "
    "the stack will not fall over",
    bounds="a floor faster than three times p, tilting that begins less than a twelfth of a period "
    "before it reverses (peak up to 1.15 g a/c)",
)
def short_before_reversal(experiments: Experiments) -> Evidence:
    """Peaks from 1.01 to 3 g a/c over frequency, stack that cannot slide: time from tilting to reversal, and the
    end."""
    ratios = (1.01, 1.02, 1.04, 1.07, 1.1, 1.15, 1.2, 1.3, 1.4, 1.6, 1.8, 2.0, 2.5, 3.0)
    peaks = [float(f"{ratio * UPLIFT:.5g}") for ratio in ratios]
    cells = stack_map(experiments, HOLDING, peaks=peaks).cells
    fallen, standing = [cell for cell in cells if cell.fell], [cell for cell in cells if not cell.fell]
    late = [cell for cell in fallen if cell.sure and _lead(cell) <= 1.0 / 12.0]
    fast = [cell for cell in late if cell.motion.angular_frequency >= FAST]
    short = "sure cells that tilt less than a twelfth of a period before reversal and overturn"
    every = "sure cells that tilt at any time before reversal and overturn"
    yield at_most(f"{short}, Omega above 3 p", len(fast), 0.0)
    yield at_most(f"{short}, all frequencies", len(late), 0.0, inside=False)
    yield at_most(every, sum(cell.sure for cell in fallen), 0.0, inside=False)
    for first in sorted(fallen, key=_lead)[:1]:
        frequency = first.motion.angular_frequency
        yield (
            f"The shortest time from tilting to reversal with which the stack overturns is {_lead(first):.3f} of a "
            f"period ({_lead(first) * 2.0 * math.pi / frequency:.2f} s, at {frequency:g} rad/s)."
        )
        yield first.case
    yield f'The scale for "short" is 1/p, the time scale of falling, here {1.0 / FREQUENCY_PARAMETER:.2f} s.'
    yield draw_curves(
        "short-before-reversal",
        "When the stack begins to tilt, in periods before the floor reverses, and its outcome.",
        "angular frequency [rad/s] | lead over the period [-]",
        [
            Curve([cell.motion.angular_frequency for cell in cells], list(map(_lead, cells)), label, style)
            for cells, label, style in ((standing, "stands", "."), (fallen, "overturns", "x"))
        ],
    )
    yield experiments.band(
        STACK.but(NO_SLIDING, peak=1.1 * UPLIFT, frequency=ANGULAR_FREQUENCY, duration=8.0),
        "rotation ratio at 1.1 g a/c, 6.928 rad/s",
        "it stands",
        stands,
    )


def _lead(cell: MapCell) -> float:
    """Time from the first uplift to the next reversal of the floor, over the period."""
    uplift = float(cell.row["first_uplift_s"] or math.nan)
    return (0.25 - cell.motion.angular_frequency * uplift / (2.0 * math.pi)) % 0.5


@claim("5.3", "the condition A <= a/2 is only a conservative description of the falling over limit")
def half_width_is_conservative(experiments: Experiments) -> Evidence:
    """The same maps below A = a/2, a scan of the amplitude at the paper's frequency, and the exact first swing."""
    block = experiments.block(STACK)
    threshold = first_swing_threshold(
        block,
        lambda peak: sine_floor(amplitude=peak / ANGULAR_FREQUENCY**2, angular_frequency=ANGULAR_FREQUENCY),
        low=3.0,
        high=60.0,
        duration=8.0,
        relative_tolerance=1e-4,
    )
    share = threshold / ANGULAR_FREQUENCY**2 / HALF_WIDTH
    held = STACK.but(FOR_MAPS, NO_SLIDING)
    amplitudes = [round((0.1 + 0.02 * n) * HALF_WIDTH, 5) for n in range(46)]
    scan = held.but(duration=15.0).scan(
        "amplitude", amplitudes, "stack that cannot slide, A = {:g} m at 6.928 rad/s"
    )
    ends = zip(scan, experiments.rows(scan, also_failed=True), strict=True)
    falling = [case for case, row in ends if not stands(row)]
    smallest = min((case.values["motion.amplitude_m"] / HALF_WIDTH for case in falling), default=math.nan)
    witnesses, rows = [], []
    for name, mu in FRICTIONS.items():
        cells = stack_map(experiments, mu).cells
        below = [cell for cell in cells if cell.motion.amplitude <= HALF_WIDTH]
        against = sorted((cell for cell in below if cell.fell), key=lambda cell: cell.motion.amplitude)
        sure = [cell for cell in against if cell.sure]
        what = f"{name}: sure cells of the map with A <= a/2 that overturn"
        yield at_most(what, len(sure), 0.0)
        least = against[0].motion.amplitude / HALF_WIDTH if against else None
        rows.append((name, len(below), len(against), len(sure), least))
        witnesses += [cell.case for cell in sure[:1]]
    scanned = "smallest A/(a/2) that overturns at 6.928 rad/s, in a scan by 0.02"
    yield at_least(scanned, smallest if falling else math.inf, 1.0)
    yield at_least("A/(a/2) that overturns in the first swing at 6.928 rad/s, exact block", share, 1.0)
    first = (falling or scan[-1:])[0]
    witness = first.but(
        amplitude=round(0.45 * HALF_WIDTH, 5), what="stack that cannot slide, A = 0.45 a/2 at 6.928 rad/s"
    )
    yield (
        f"At the paper's frequency an amplitude of {share:.2f} a/2 overturns the stack in the first "
        "swing, without any impact (exact block); of the runs, impacts included, the smallest that overturns has "
        f"{smallest:.2f} a/2. The outcome depends not on the amplitude alone but on the acceleration "
        "over g a/c and the frequency over p: in the first swing A Omega²/(g a/c) against sqrt(1 + (Omega/p)²)."
    )
    yield first
    yield witness
    yield from witnesses
    yield table(
        "Cells of the stack's map with A <= a/2",
        "friction | cells | overturn | .. and are sure | smallest A/(a/2) that overturns",
        rows,
    )
    smooth = np.linspace(min(FREQUENCIES), max(FREQUENCIES), 100)
    first_swing = [UPLIFT * sustained_sine_threshold_slender(w / block.frequency_parameter) for w in smooth]
    yield draw_map(
        "half-width-map",
        "Outcome of the rigid stack that cannot slide; hatched: unsure cells.",
        stack_map(experiments, HOLDING),
        [
            MapCurve(x=smooth, y=HALF_WIDTH * smooth**2, label="A = a/2"),
            MapCurve(x=smooth, y=np.full_like(smooth, UPLIFT), label="static rule, g a/c"),
            MapCurve(x=smooth, y=np.array(first_swing), label="first swing (slender)"),
        ],
    )
    yield experiments.band(
        witness.but(SHELL, duration=10.0),
        f"rotation ratio at A = {witness.values['motion.amplitude_m'] / HALF_WIDTH:.2f} a/2",
        "it stands, as A <= a/2 says",
        stands,
        value=capped_ratio,
    )


@claim(
    "5.3",
    "the acceleration of the center of mass during the first quarter period, leading to phi < "
    "beta for A = a/2",
    bounds="in the first quarter period; it says nothing of what follows",
)
def rotation_at_half_width(experiments: Experiments) -> Evidence:
    """A = a/2 at six frequencies, stack that cannot slide: rotation in the first quarter period, and the end."""
    ratios, falls = [], []
    angle = experiments.block(STACK).slenderness_angle
    held = STACK.but(FOR_MAPS, NO_SLIDING, amplitude=HALF_WIDTH, duration=10.0, interval=0.005)
    frequencies = (2.5, 3.5, 5.0, ANGULAR_FREQUENCY, 9.0, 12.0)
    cases = held.scan("frequency", frequencies, "stack that cannot slide, A = a/2 at {:g} rad/s")
    for frequency, case in zip(frequencies, cases, strict=True):
        run = experiments.run(case)
        time, rotation = run.history["time_s"], np.abs(run.history["rotation_rad"])
        ratios.append(float(rotation[time <= 0.5 * math.pi / frequency].max()) / angle)
        falls.append(run.status == "overturned")
        what = f"rotation in the first quarter period over the slenderness angle, {frequency:g} rad/s"
        yield at_most(what, ratios[-1], 1.0)
        yield at_most(f"overturns in the end, {frequency:g} rad/s", falls[-1], 0.0, inside=False)
    yield (
        f"Within a quarter of the first period the rotation reaches {max(ratios):.2f} of the slenderness angle at "
        f"most. The stack then continues to rotate with the velocity it has; in the end it overturns at {sum(falls)} "
        f"of {len(falls)} frequencies."
    )
    yield from cases


@claim(
    "5.4",
    "Overturning Mode ... Tilting moment does exceed restoring moment from self weight ... Steady state amplitude "
    "A > a/2 (quasi-static, weak condition)",
)
def beyond_half_width(experiments: Experiments) -> Evidence:
    """The map of the stack that cannot slide, above A = a/2 and g a/c."""
    beyond = [
        cell
        for cell in stack_map(experiments, HOLDING).cells
        if cell.motion.amplitude > HALF_WIDTH and cell.motion.peak > UPLIFT
    ]
    standing = [cell for cell in beyond if cell.stood]
    sure = [cell for cell in standing if cell.sure]
    below = []
    for cell in sure:
        # the peak over g a/c from which a sine overturns a slender block in its first swing
        limit = sustained_sine_threshold_slender(cell.motion.angular_frequency / FREQUENCY_PARAMETER)
        if cell.motion.peak / UPLIFT < limit:
            below.append(cell)
    yield at_most("sure cells with A > a/2 and M_T > M_R that stand", len(sure), 0.0)
    yield (
        f"Of {len(beyond)} motions with A > a/2 whose tilting moment exceeds the restoring one, "
        f"{len(beyond) - len(standing)} overturn the stack that cannot slide and {len(standing)} do "
        f"not, {len(sure)} of them sure ({len(below)} below the exact limit of the first swing). Whether the "
        "reverse, A <= a/2, is safe is another claim."
    )
    yield from [cell.case for cell in [*sure[:2], *beyond[:1]]]
    yield experiments.band(
        STACK.but(NO_SLIDING, amplitude=0.66, frequency=2.5, duration=8.0),
        "rotation ratio at A = 1.2 a/2, 2.5 rad/s (1: overturned)",
        "it overturns",
        lambda row: not stands(row),
        value=capped_ratio,
    )
