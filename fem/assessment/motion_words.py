"""The floor's motions of a run in words: length, samples and peaks, and what of them the run leaves out."""

from fem.records.units import STANDARD_GRAVITY
from fem.results.run_result import MotionResult
from fem.runtime.units import in_figures

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
    if motion.peak_displacement_m is not None:
        words += f", {in_figures(motion.peak_displacement_m, 3, 1e3)} mm"
    if motion.residual_velocity_m_s is not None and motion.residual_displacement_m is not None:
        words += (
            f"; ends with {in_figures(_small(motion.residual_velocity_m_s, motion.peak_velocity_m_s), 2)} m/s, "
            f"{in_figures(_small(motion.residual_displacement_m, motion.peak_displacement_m), 2, 1e3)} mm"
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
