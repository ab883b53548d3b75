"""Response curves: one frequency after the other, up and down, the motion carried on from one to the next.

Where the container overturns, the curve has dropped out; as a fallen container has no response, the next frequency
begins anew as the case does. Each frequency ends with the drive stopped, on a copy of the motion.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from contact.stepping.observables import ROCK, ROCKING, SLIDE
from fem.assessment.verdict import MODE_NAMES, SLIDING, rotation_ratio
from fem.case.case import Case
from fem.model.container import Container, discretise
from fem.response.decay import Decay, follow_decay
from fem.response.model import DrivenModel, begin_drive, carry_drive, driven_case
from fem.response.orbit import Orbit, follow_periods, step_until
from fem.response.request import ResponseRequest
from fem.response.stability import LongTime, amplitude_growth, amplitudes_diverge, classify
from fem.runtime.arrays import FloatArray

PORTRAYED = 16  #: last periods whose phase portrait is kept; of a periodic motion one of its periods
WINDOWS = 4  #: a motion that is not settled is observed again, so many windows in all

Told = Callable[[float, float, int], None]


@dataclass(frozen=True, kw_only=True, eq=False)
class Point:
    """One frequency of a curve."""

    direction: str  #: up | down
    number: int  #: of the frequency, from 0 for the lowest
    case: Case
    began: str  #: "carried" on from the frequency before, or as the "case" begins
    status: str  #: completed | overturned | failed
    reason: str | None  #: why it failed
    motion: str | None  #: rest | slide | rock | slide-rock | overturned, in the window observed
    long_time: LongTime | None  #: None where it overturned or failed
    periods: int  #: of the drive followed, until the end or the fall
    orbit: Orbit  #: of the window observed; where it overturned or failed, what there is of it
    decay: Decay | None  #: with the drive stopped
    slenderness_angle: float  #: [rad]
    velocity_scale: float  #: slenderness angle times frequency parameter [rad/s]

    @property
    def scaled_sections(self) -> FloatArray:
        """Sections (n, 4) in the units in which they are compared."""
        return self.orbit.sections / _scales(self.case, self.slenderness_angle, self.velocity_scale)

    @property
    def amplitudes(self) -> FloatArray:
        """Largest |rotation| of each period observed over the slenderness angle, shape (n,)."""
        return rotation_ratio(self.orbit.extremes[:, 0], self.slenderness_angle)

    @property
    def rotation_ratio(self) -> float | None:
        """Largest |rotation| in the window over the slenderness angle; None where it overturned or failed."""
        return float(self.amplitudes.max()) if self.long_time is not None else None

    @property
    def growth(self) -> float | None:
        """Of the amplitudes within the window [-]."""
        return amplitude_growth(self.amplitudes) if self.long_time is not None else None

    @property
    def bounded(self) -> bool | None:
        """(a) of the paper's stability: it did not overturn, and amplitudes do not diverge; None where failed."""
        if self.status == "failed":
            return None
        return self.long_time is not None and not amplitudes_diverge(self.amplitudes)

    @property
    def stable(self) -> bool | None:
        """(a) and (b) of the paper's stability; None where either could not be judged."""
        if self.bounded is None or (self.bounded and (self.decay is None or self.decay.fate == "failed")):
            return None
        return self.bounded and self.decay is not None and self.decay.fate == "dies out"


@dataclass(frozen=True, kw_only=True, eq=False)
class Standing:
    """Where a curve stands between two frequencies: the motion, or nothing where it is to begin anew."""

    driven: DrivenModel | None


def sweep_points(
    request: ResponseRequest,
    *,
    skip: int = 0,
    standing: Callable[[Case, Container], DrivenModel] | None = None,
    told: Told = lambda time, rotation, mode: None,
) -> Iterator[tuple[Point, Standing]]:
    """The points of a curve in the order in which they are swept.

    Args:
        request: what is asked.
        skip: points already there.
        standing: how the motion after the last of these is had again, from the case and container of that point; None:
            the next point begins anew.
        told: of the progress within a point: time since its begin [s], rotation [rad], mode.

    Raises:
        CaseError, MeshError: bad input.
    """
    container = discretise(request.case)
    plan = plan_of(request)
    before: DrivenModel | None = None
    if skip and standing is not None:
        before = standing(case_at(request, plan[skip - 1][1]), container)
    for direction, number in plan[skip:]:
        point, before = follow_point(
            request, container, before, direction=direction, number=number, told=told
        )
        yield point, Standing(driven=before)


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
    told: Told = lambda time, rotation, mode: None,
) -> tuple[Point, DrivenModel | None]:
    """One frequency, from the motion before; returns the point and the motion to go on with, None after a fall."""
    case = case_at(request, number)
    began = "case" if before is None else "carried"
    if before is None:
        lead, until = begin_drive(case, container)
        status = step_until(lead, until) if until > 0.0 else "completed"
        if status != "completed":
            empty = Orbit(
                status=status,
                sections=np.zeros((0, 4)),
                extremes=np.zeros((0, 6)),
                portrait=np.zeros((0, 2)),
                overturned_at=until,
                reason="failed before the first section" if status == "failed" else None,
            )
            return _point(case, lead, direction, number, began, empty, None, 0), None
        before = lead
    driven = carry_drive(case, container, before)
    driven, orbit = follow_periods(driven, request.settle, told=told)
    periods = len(orbit.sections)
    long_time = None
    for _ in range(WINDOWS):
        if orbit.status != "completed":
            break
        driven, orbit = follow_periods(driven, request.observe, portrayed=PORTRAYED, told=told)
        periods += len(orbit.sections)
        if orbit.status != "completed":
            break
        long_time = judge(request, case, driven, orbit)
        if long_time.kind != "not settled":
            break
    if orbit.status != "completed":
        return _point(case, driven, direction, number, began, orbit, None, periods), None
    decay = follow_decay(case, container, driven)
    return _point(case, driven, direction, number, began, orbit, long_time, periods, decay), driven


def judge(request: ResponseRequest, case: Case, driven: DrivenModel, orbit: Orbit) -> LongTime:
    """The long-time motion of a window of periods."""
    control = driven.run.control
    angle = control.slenderness_angle
    scales = _scales(case, angle, angle * control.frequency_parameter)
    return classify(
        orbit.sections / scales,
        resting=motion_of(driven, orbit) == "rest",
        tolerance=request.tolerance,
        largest_period=request.largest_period,
    )


def motion_of(driven: DrivenModel, orbit: Orbit) -> str:
    """One word for a window of periods, with the limits of a verdict."""
    rocks = orbit.extremes[:, 3].max() > ROCKING * driven.run.control.slenderness_angle
    slides = orbit.extremes[:, 4].max() > SLIDING * driven.run.control.width
    return MODE_NAMES[(ROCK if rocks else 0) + (SLIDE if slides else 0)]


def _scales(case: Case, angle: float, velocity: float) -> FloatArray:
    amplitude = case.amplitude
    return np.array([angle, velocity, amplitude * case.angular_frequency, amplitude])


def _point(
    case: Case,
    driven: DrivenModel,
    direction: str,
    number: int,
    began: str,
    orbit: Orbit,
    long_time: LongTime | None,
    periods: int,
    decay: Decay | None = None,
) -> Point:
    control = driven.run.control
    motion = None
    if orbit.status == "completed":
        motion = motion_of(driven, orbit)
    elif orbit.status == "overturned":
        motion = "overturned"
    return Point(
        direction=direction,
        number=number,
        case=case,
        began=began,
        status=orbit.status,
        reason=orbit.reason,
        motion=motion,
        long_time=long_time,
        periods=periods,
        orbit=orbit,
        decay=decay,
        slenderness_angle=control.slenderness_angle,
        velocity_scale=control.slenderness_angle * control.frequency_parameter,
    )
