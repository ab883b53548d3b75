"""The floor, its motion, and what stands beside a container, in words: of a case, and of what happened."""

from fem.case.case import Case
from fem.case.tables.links import StopTable, TieTable
from fem.case.tables.neighbours import NeighbourTable
from fem.records.units import STANDARD_GRAVITY
from fem.results.outcome import SLIDING, Outcome
from fem.results.run_result import FloorNumbers, LinkResult, MotionResult, NeighbourResult, RunResult, Verdict
from fem.run.joints import leaning_in_words
from fem.runtime.units import FEW, KILONEWTONS, MANY, MILLIMETRES, SHORT_MILLIMETRES, in_figures

ROUNDING = 1e-9  #: share of a peak
NAMES = {"table": "record", "pulse": "pulse"}


def motion_in_words(motion: MotionResult) -> str:
    """Length, samples and peaks of one motion; empty of a floor at rest, and of a result of an older version."""
    if motion.duration_s is None or motion.peak_acceleration_m_s2 is None:
        return ""
    length = f"{motion.duration_s:.4g} s"
    if motion.samples is not None and motion.step_s is not None:
        length += f", {motion.samples} samples of {motion.step_s:.3g} s"
    peak = motion.peak_acceleration_m_s2
    words = f"{length}; peaks {peak:.4g} m/s2 = {peak / STANDARD_GRAVITY:.3g} g"
    if motion.peak_velocity_m_s is not None:
        words += f", {motion.peak_velocity_m_s:.3g} m/s"
    words += "".join(
        f", {SHORT_MILLIMETRES.text(size)}" for size in (motion.peak_displacement_m,) if size is not None
    )
    if motion.residual_velocity_m_s is not None and motion.residual_displacement_m is not None:
        words += (
            f"; ends with {in_figures(_small(motion.residual_velocity_m_s, motion.peak_velocity_m_s), 2)} m/s, "
            f"{MILLIMETRES.text(_small(motion.residual_displacement_m, motion.peak_displacement_m), figures=2)}"
        )
    return words


def _small(residual: float, peak: float | None) -> float:
    """The residual at the end of a motion; 0 where it is rounding error."""
    return 0.0 if abs(residual) <= ROUNDING * (peak or 0.0) else residual


def doubts(motion: MotionResult, gravity: float) -> tuple[str, ...]:
    """Doubts about the floor's motions under this gravity [m/s2]: those of records, and a floor that falls with g."""
    upward = motion.vertical
    if upward is None:
        return motion.notes
    falls = (upward.peak_in_run_m_s2 or 0.0) >= gravity
    note = (
        f"the vertical acceleration of the floor reaches {upward.peak_in_run_m_s2:.4g} m/s2, gravity or more: where it "
        "is downward, the floor bears nothing and the container leaves it"
    )
    return (*motion.notes, *upward.notes, *((note,) if falls else ()))


def is_cut(motion: MotionResult) -> bool:
    """Whether the run ends before one of the motions, or begins after it has."""
    covered = _most_cut(motion).covered
    return covered is not None and covered < 1.0 - 1e-9


def covered_in_words(motion: MotionResult) -> str:
    """The motion under which a verdict holds: "this motion", or the part of it that the run covers."""
    cut = _most_cut(motion)
    if not is_cut(motion) or cut.covered is None or cut.duration_s is None:
        return "this motion"
    part = f"{cut.covered * cut.duration_s:.4g} of {cut.duration_s:.4g} s"
    words = f"the first {part}" if cut.begin_s is None else f"{part}, from {-cut.begin_s:.4g} s of it on"
    return words if cut is motion else f"{words} (vertical motion)"


def missing_peak(motion: MotionResult) -> str:
    """A note that the run leaves out the peak of a motion; empty if it does not."""
    if not is_cut(motion):
        return ""
    missing = _missing_peak(motion, NAMES.get(motion.kind or "", "motion"))
    return missing + (_missing_peak(motion.vertical, "vertical motion") if motion.vertical else "")


def _most_cut(motion: MotionResult) -> MotionResult:
    """The motion of which the run covers the smaller share."""
    share, vertical = motion.covered, motion.vertical
    if vertical is None or vertical.covered is None:
        return motion
    return vertical if share is None or vertical.covered < share else motion


def _missing_peak(motion: MotionResult, name: str) -> str:
    whole, within = motion.peak_acceleration_m_s2, motion.peak_in_run_m_s2
    if whole is None or within is None or within >= whole * (1.0 - 1e-9):
        return ""
    return f"; the {name}'s peak of {whole / STANDARD_GRAVITY:.3g} g is not in it"


KILONEWTON = ("kN", 1e-3)
LEAST = 0.1  #: of a number in a unit, before a smaller unit is taken


def floor_rows(floor: FloorNumbers | None, *, lands: bool = True) -> list[tuple[str, str]]:
    """Name and value in everyday units; empty for a rigid, level floor. `lands`: whether it may land on a corner."""
    if floor is None:
        return []
    rows = [("floor", _material(floor)), ("corner", _springs(floor)), ("crushes at", _cap(floor))]
    rows.append(("turns about", _pivot(floor)))
    if floor.slope_percent:
        side = "right (+x)" if floor.slope_percent > 0.0 else "left (-x)"
        rows.append(("slope", f"{abs(floor.slope_percent):g} %, it falls to the {side}"))
    rows.append(("one impact", _hit(floor) if lands else ""))
    return [(name, value) for name, value in rows if value]


def _material(floor: FloorNumbers) -> str:
    modulus, strength = floor.youngs_modulus_Pa, floor.bearing_strength_Pa
    if modulus is None or strength is None:
        return ""
    name = f"{floor.preset}: " if floor.preset else ""
    return (
        f"{name}E = {_in_units(modulus, ('GPa', 1e-9), ('MPa', 1e-6))}, nu = {floor.poisson_ratio:g}, strength "
        f"{_in_units(strength, ('MPa', 1e-6), ('kPa', 1e-3))}"
    )


def _springs(floor: FloorNumbers) -> str:
    stiffness, sinks, bounces = (
        floor.corner_stiffness_N_m,
        floor.static_indentation_m,
        floor.contact_frequency_Hz,
    )
    if floor.corner_patch_m is None or stiffness is None or sinks is None or bounces is None:
        return ""
    patch = " x ".join(f"{side:g}" for side in floor.corner_patch_m)
    return (
        f"{patch} m: {_in_units(stiffness, ('kN/mm', 1e-6))}, contact frequency {_in_units(bounces, ('Hz', 1.0))}, "
        f"sinks in by {_in_units(sinks, ('mm', 1e3), ('um', 1e6))} at rest"
    )


def _cap(floor: FloorNumbers) -> str:
    cap, times, bearing = floor.corner_cap_N, floor.cap_over_weight, floor.bearing_capacity_N
    if cap is None or times is None or bearing is None:
        return ""
    other = ""
    if floor.governs == "container":
        other = f", where the steel above it yields; the floor bears {_in_units(bearing, KILONEWTON)}"
    elif floor.steel_capacity_N is not None:
        other = f"; the steel above it yields at {_in_units(floor.steel_capacity_N, KILONEWTON)}"
    return f"{_in_units(cap, KILONEWTON)} a corner at its surface, {in_figures(times, FEW)} times the weight{other}"


def _pivot(floor: FloorNumbers) -> str:
    inset = floor.pivot_inset_m
    if not inset:
        return ""
    where = _in_units(inset, ("mm", 1e3))
    return f"points {where} inside the edges of what touches: under the edge itself the floor gives way"


def _hit(floor: FloorNumbers) -> str:
    ratio, speed, crushing = floor.hit_rotation_ratio, floor.closing_speed_m_s, floor.crushing_per_hit_m
    if ratio is None or speed is None or crushing is None:
        return ""
    gives = "crush the corner" if crushing else "crush nothing"
    return f"back from {ratio:g} of the slenderness angle it would strike at {in_figures(speed, FEW)} m/s and {gives}"


def _in_units(value: float, *units: tuple[str, float]) -> str:
    """Three figures in the first of the units, largest first, in which the number is not small."""
    name, factor = next(((name, factor) for name, factor in units if value * factor >= LEAST), units[-1])
    return f"{in_figures(value, MANY - 1, factor)} {name}"


def link_rows(case: Case) -> list[tuple[str, str]]:
    """Each stop, tie and neighbour of a case: name and what it is."""
    return [
        *(("stop", _stop(stop)) for stop in case.stop),
        *(("tie", _tie(tie)) for tie in case.tie),
        *(("neighbour", _beside(*pair)) for pair in zip(case.neighbour, case.row[1:], strict=True)),
    ]


def _stop(stop: StopTable) -> str:
    where = f"on the {stop.side} at {stop.height_m:g} m, gap {1e3 * stop.gap_m:g} mm"
    return where + _stiffness(stop) + _friction(stop) + _strength(stop)


def _tie(tie: TieTable) -> str:
    to = "level to a wall" if tie.to == "wall" else "down to the floor"
    of = f"of neighbour {tie.neighbour} " if tie.neighbour else ""
    damping = f", damping ratio {tie.damping_ratio:g}" if tie.damping_ratio else ""
    where = f"{of}on the {tie.side} from {tie.height_m:g} m {to}, slack {1e3 * tie.slack_m:g} mm"
    return where + _stiffness(tie) + damping + _strength(tie)


def _beside(table: NeighbourTable, alone: Case) -> str:
    """A neighbour, by its table and its case alone."""
    boxes = f"{alone.container.boxes} box{'es' * (alone.container.boxes > 1)}"
    size = f"{alone.stack[0].width:g} x {alone.stack[-1].top:g} m, {alone.mass:.6g} kg, {boxes}"
    which = "" if table.case is None else f"{table.case}, "
    return f"{which}on the {table.side}, gap {1e3 * table.gap_m:g} mm, {size}{_stiffness(table)}{_friction(table)}"


def _stiffness(link: StopTable | TieTable | NeighbourTable) -> str:
    return f", {1e-3 * link.stiffness_N_m:.6g} kN/m"


def _friction(link: StopTable | NeighbourTable) -> str:
    return f", friction {link.mu:g}" if link.mu else ""


def _strength(link: StopTable | TieTable) -> str:
    return "" if link.strength_N is None else f", breaks at {1e-3 * link.strength_N:.4g} kN"


def links_in_words(result: RunResult) -> str:
    """What each stop, tie and neighbour did, without a full stop; empty where there are none."""
    stops, ties = result.stops or (), result.ties or ()
    beside = enumerate((result.verdict or Verdict()).neighbours or (), 1)
    return "; ".join(
        [
            *(_of_stop(stop) for stop in stops),
            *(_of_tie(tie) for tie in ties),
            *(_of_neighbour(number, neighbour) for number, neighbour in beside),
        ]
    )


def fall_in_row(verdict: Verdict) -> str:
    """Who overturned first in a row, and when; empty where there are no neighbours or none of them did."""
    fallen = [
        (neighbour.overturned_at_s, number, neighbour)
        for number, neighbour in enumerate(verdict.neighbours or (), 1)
        if neighbour.overturned_at_s is not None
    ]
    if not fallen:
        return ""
    at, number, neighbour = min(fallen)
    if verdict.leans:
        return leaning_in_words(_neighbour(number, neighbour), verdict)
    return f"{_neighbour(number, neighbour)} overturned at t = {at:.3f} s, where the run ends"


def _neighbour(number: int, neighbour: NeighbourResult) -> str:
    return f"neighbour {number} on the {neighbour.side}"


def _of_neighbour(number: int, neighbour: NeighbourResult) -> str:
    ratio = f", rotation ratio {neighbour.rotation_ratio:.3f}" if neighbour.overturned_at_s is None else ""
    slip = f", slip {1e3 * neighbour.max_slip_m:.3g} mm" if Outcome(neighbour.outcome) in SLIDING else ""
    did = Outcome(neighbour.outcome).verb.replace(", ", " and ")
    moved = f"{_neighbour(number, neighbour)} {did}{ratio}{slip}"
    if neighbour.hits == 0:
        return f"{moved}, not touched{_left(neighbour, 'gap')}"
    hits = "once" if neighbour.hits == 1 else f"{neighbour.hits} times"
    speed = f"{neighbour.largest_closing_velocity_m_s:.2g} m/s"
    return f"{moved}, hit {hits}, at {speed} at most, with up to {KILONEWTONS.text(neighbour.max_force_N, figures=3)}"


def _of_stop(stop: LinkResult) -> str:
    name = f"the stop on the {stop.side} at {stop.height_m:g} m"
    if stop.max_force_N == 0.0:
        return f"{name} was not touched{_left(stop, 'gap')}"
    hits = "once" if stop.hits == 1 else f"{stop.hits} times"
    words = f"{name} was hit {hits}, at {stop.largest_closing_velocity_m_s:.2g} m/s at most, with up to {_force(stop)}"
    return words + _broken(stop)


def _of_tie(tie: LinkResult) -> str:
    of = f" of neighbour {tie.neighbour}" if tie.neighbour else ""
    name = f"the tie{of} on the {tie.side} at {tie.height_m:g} m"
    if tie.max_force_N == 0.0:
        return f"{name} stayed slack{_left(tie, 'slack')}"
    return f"{name} carried up to {_force(tie)}{_broken(tie)}"


def _left(link: LinkResult | NeighbourResult, what: str) -> str:
    return (
        ""
        if link.gap_left_m is None
        else f", {SHORT_MILLIMETRES.text(link.gap_left_m)} of the {what} was left"
    )


def _force(link: LinkResult) -> str:
    return KILONEWTONS.text(link.max_force_N, figures=3)


def _broken(link: LinkResult) -> str:
    return "" if link.broken_at_s is None else f", and broke at t = {link.broken_at_s:.3f} s"
