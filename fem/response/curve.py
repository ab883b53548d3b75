"""Response curves: one frequency after the other, up and down, the motion carried on from one to the next.

A container that overturned has no response; the next frequency then begins as the case does. Each frequency ends with
the drive stopped, on a copy of the motion.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contact.stepping.observables import ROCKING
from fem.assessment.verdict import destroyed_corner, relative_rotation
from fem.case.case import Case
from fem.model.container import Container
from fem.response.decay import Decay, follow_decay
from fem.response.model import DrivenModel, begin_drive, carry_drive, driven_case
from fem.response.orbit import Orbit, Progress, follow_periods, no_progress, step_until
from fem.response.request import ResponseRequest
from fem.response.stability import LongTime, amplitude_growth, amplitudes_diverge, classify
from fem.results.outcome import Outcome, least_slide
from fem.runtime.arrays import FloatArray

PORTRAYED = 16  #: last periods whose phase portrait is kept; of a periodic motion, one of its periods
WINDOWS = 4  #: a motion that is not settled is observed again, at most so many windows in all


@dataclass(frozen=True, kw_only=True, eq=False)
class CurvePoint:
    """One frequency of a curve."""

    direction: str  #: up | down
    number: int  #: of the frequency, from 0 for the lowest
    case: Case
    began: str  #: "carried" on from the frequency before, or as the "case" begins
    motion: str | None  #: rest | slide | rock | slide-rock | overturned, in the window observed
    long_time: LongTime | None  #: None where it overturned or failed
    periods: int  #: of the drive followed, until the end or the fall
    orbit: Orbit  #: of the window observed; where it overturned or failed, what there is of it
    decay: Decay | None  #: with the drive stopped
    slenderness_angle: float  #: [rad]

    @property
    def amplitudes(self) -> FloatArray:
        """Largest |rotation| of each period observed over the slenderness angle, shape (n,)."""
        return relative_rotation(self.orbit.extremes[:, 0], self.slenderness_angle)

    @property
    def growth(self) -> float | None:
        """Of the amplitudes within the window [-]."""
        return amplitude_growth(self.amplitudes) if self.long_time is not None else None

    @property
    def bounded(self) -> bool | None:
        """(a) of the paper's stability: it did not overturn, and amplitudes do not diverge; None where not valid."""
        if self.orbit.status == "failed" or self.motion == Outcome.INVALID:
            return None
        return self.long_time is not None and not amplitudes_diverge(self.amplitudes)

    @property
    def stable(self) -> bool | None:
        """(a) and (b) of the paper's stability; None where either could not be judged."""
        if self.bounded is None or (self.bounded and (self.decay is None or self.decay.fate == "failed")):
            return None
        return self.bounded and self.decay is not None and self.decay.fate == "dies out"


def sweep_points(
    request: ResponseRequest,
    container: Container,
    *,
    skip: int = 0,
    before: DrivenModel | None = None,
    progress: Progress = no_progress,
) -> Iterator[tuple[CurvePoint, DrivenModel | None]]:
    """The points of a curve in the order in which they are swept, each with the motion that is carried on.

    Args:
        request: frequencies and drive.
        container: of its case.
        skip: number of points that are computed already.
        before: the motion after the last of these; None: the next point begins as the case does.
        progress: called within a point with the time since its beginning [s], the rotation [rad] and the mode.
    """
    for direction, number in plan_of(request)[skip:]:
        point, before = follow_point(
            request, container, before, direction=direction, number=number, progress=progress
        )
        yield point, before


def plan_of(request: ResponseRequest) -> list[tuple[str, int]]:
    """Direction and number of each frequency, in the order in which they are swept."""
    up = [("up", k) for k in range(request.count)]
    down = [("down", k) for k in reversed(range(request.count))]
    return up + down if request.order == "up-down" else down + up


def case_at(request: ResponseRequest, number: int) -> Case:
    """The case at a frequency of the request."""
    return driven_case(request.case, float(request.frequencies[number]), request.held, request.held_value)


def follow_point(
    request: ResponseRequest,
    container: Container,
    before: DrivenModel | None,
    *,
    direction: str,
    number: int,
    progress: Progress = no_progress,
) -> tuple[CurvePoint, DrivenModel | None]:
    """One frequency, from the motion before; returns the point and the motion to carry on, None after a fall."""
    case = case_at(request, number)
    began = "case" if before is None else "carried"
    driven, orbit = settled(request, case, container, before, progress)
    long_time, periods = None, len(orbit.sections)
    for _ in range(WINDOWS):
        if orbit.status != "completed":
            break
        driven, orbit = follow_periods(driven, request.observe, portrayed=PORTRAYED, progress=progress)
        periods += len(orbit.sections)
        long_time = judge(request, case, driven, orbit) if orbit.status == "completed" else None
        if long_time is not None and long_time.kind != "not settled":
            break
    stands = orbit.status == "completed"
    point = CurvePoint(
        direction=direction,
        number=number,
        case=case,
        began=began,
        motion=None if orbit.status == "failed" else motion_of(driven, orbit),
        long_time=long_time,
        periods=periods,
        orbit=orbit,
        decay=follow_decay(case, container, driven) if stands else None,
        slenderness_angle=driven.run.problem.control.slenderness_angle,
    )
    return point, driven if stands else None


def settled(
    request: ResponseRequest, case: Case, container: Container, before: DrivenModel | None, progress: Progress
) -> tuple[DrivenModel, Orbit]:
    """The model after the periods left out, and their orbit; an empty one where it fell before the first section."""
    if before is None:
        before, until = begin_drive(case, container)
        status = step_until(before, until) if until > 0.0 else "completed"
        if status != "completed":
            reason = "failed before the first section" if status == "failed" else None
            none = np.zeros((0, 4)), np.zeros((0, 7)), np.zeros((0, 2))
            return before, Orbit(
                status=status, sections=none[0], extremes=none[1], portrait=none[2], reason=reason
            )
    return follow_periods(carry_drive(case, container, before), request.settle, progress=progress)


def judge(request: ResponseRequest, case: Case, driven: DrivenModel, orbit: Orbit) -> LongTime:
    """The long-time motion of a window of periods."""
    control = driven.run.problem.control
    angle, amplitude = control.slenderness_angle, case.amplitude
    scales = [angle, angle * control.frequency_parameter, amplitude * case.angular_frequency, amplitude]
    return classify(
        orbit.sections / scales,
        resting=motion_of(driven, orbit) == Outcome.REST,
        tolerance=request.tolerance,
        largest_period=request.largest_period,
    )


def motion_of(driven: DrivenModel, orbit: Orbit) -> str:
    """One word for a window of periods, with the limits of a verdict; a corner sinks in further from point to point."""
    if destroyed_corner(driven.model) is not None:
        return Outcome.INVALID
    if orbit.status == "overturned":
        return Outcome.OVERTURNED
    rocks = orbit.extremes[:, 3].max() > ROCKING * driven.run.problem.control.slenderness_angle
    slides = orbit.extremes[:, 4].max() > least_slide(driven.run.problem.control.width)
    return Outcome.of(slides=slides, rocks=rocks)
