"""Base motion: harmonic motion, pulses, no motion; tables of recorded motion are in `contact.motion.table`.

The floor moves along x, positive toward +x; SI units. `compiled` gives the data for `floor_motion`; `break_times` (the
acceleration jumps or its formula changes), `span` and `time_scale` are for the step control; `peak_acceleration` and
`peak_within`, magnitudes, are for the static checks. `evaluate` gives displacement, velocity and acceleration at times
(n,) as rows (3, n). The four classes have the same methods.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from contact.arrays import FloatArray
from contact.motion import kernel
from contact.motion.kernel import FloorMotion, as_floor_motion, floor_history
from contact.motion.table import TableMotion

PulseShape = Literal["rectangular", "half-sine", "sine"]
PULSE_KINDS: dict[str, int] = {
    "rectangular": kernel.RECTANGULAR,
    "half-sine": kernel.HALF_SINE,
    "sine": kernel.SINE,
}

# The taper raises the peak above A Omega^2 by about 57/(2 pi n)^3 for n cycles of ramp, a quarter of a cycle from the
# plateau (1.2 at n = 1), so the search may stop a few cycles into the ramp.
SEARCHED_CYCLES = 8.0
SAMPLES_PER_CYCLE = 512


@dataclass(frozen=True, kw_only=True)
class NoMotion:
    """A floor at rest."""

    def compiled(self) -> FloorMotion:
        return as_floor_motion(kernel.UNIFORM, (0.0, 0.0, 0.0))

    def evaluate(self, times: FloatArray) -> FloatArray:
        return floor_history(self.compiled(), times)

    @property
    def peak_acceleration(self) -> float:
        return 0.0

    @property
    def break_times(self) -> FloatArray:
        return np.empty(0)

    @property
    def time_scale(self) -> float:
        """Infinite: nothing happens [s]."""
        return math.inf

    @property
    def span(self) -> tuple[float, float]:
        """Start and end [s]: it has no end."""
        return 0.0, math.inf

    def peak_within(self, duration: float) -> float:
        return 0.0


@dataclass(frozen=True, kw_only=True)
class HarmonicMotion:
    """x = A sin(Omega t + phase), from t = 0, tapered at both ends if asked; ValueError where a number is out of range.

    The taper is a quintic window (C2) on the displacement; velocity and acceleration are its exact
    derivatives. With `cycles`, the drive ends at the first instant of zero velocity of A sin(Omega t + phase)
    after so many cycles, and the floor stays there (tapered: at zero displacement). Otherwise it continues; a
    taper then ends at `duration`.
    """

    amplitude: float  #: A [m]
    angular_frequency: float  #: Omega [rad/s]
    duration: float  #: of the run [s]
    phase: float = 0.0  #: [rad]
    ramp_cycles: float = 0.0  #: length of each taper in cycles of the drive [-]
    cycles: float | None = None  #: cycles driven; None: to the end [-]

    def __post_init__(self) -> None:
        if not 0.0 <= self.amplitude < math.inf:
            raise ValueError(f"harmonic amplitude must not be negative or infinite, got {self.amplitude} m")
        if not 0.0 < self.angular_frequency < math.inf:
            raise ValueError(
                f"harmonic angular frequency must be positive, got {self.angular_frequency} rad/s"
            )
        if not 0.0 < self.duration < math.inf:
            raise ValueError(f"harmonic motion: duration must be positive, got {self.duration} s")
        if not math.isfinite(self.phase):
            raise ValueError(f"harmonic phase must be finite, got {self.phase} rad")
        if not 0.0 <= self.ramp_cycles < math.inf:
            raise ValueError(f"harmonic ramp must not be negative, got {self.ramp_cycles} cycles")
        if self.cycles is not None and not 0.0 < self.cycles < math.inf:
            raise ValueError(f"harmonic motion must last for more than 0 cycles, got {self.cycles}")
        if 2.0 * self.ramp > self.end_time * (1.0 + 1e-12):  # ramps may just meet
            raise ValueError(
                f"two ramps of {self.ramp_cycles} cycles ({self.ramp:.6g} s each) do not fit into a drive of "
                f"{self.end_time:.6g} s: it would not reach its amplitude; use shorter ramps or a longer drive"
            )

    @property
    def time_scale(self) -> float:
        """Period of the drive [s]."""
        return 2.0 * math.pi / self.angular_frequency

    @property
    def ramp(self) -> float:
        """Length of each taper [s]."""
        return self.ramp_cycles * self.time_scale

    @property
    def end_time(self) -> float:
        """When the drive ends; infinite for an untapered drive without a number of cycles [s]."""
        if self.cycles is None:
            return self.duration if self.ramp > 0.0 else math.inf
        # Omega t + phase = pi/2 + k pi; the small number keeps a zero that falls on the cycle's very end.
        k = math.ceil(2.0 * self.cycles + self.phase / math.pi - 0.5 - 1e-9)
        return (math.pi * (k + 0.5) - self.phase) / self.angular_frequency

    @property
    def break_times(self) -> FloatArray:
        """Instants in (0, duration] where the acceleration jumps or its formula changes, shape (n,) [s]."""
        ends = {self.ramp, self.end_time - self.ramp, self.end_time}
        return np.array(sorted(end for end in ends if 0.0 < end <= self.duration), dtype=float)

    @property
    def span(self) -> tuple[float, float]:
        """Start and end [s]: the floor may go on for as long as the run does."""
        return 0.0, math.inf

    @property
    def peak_acceleration(self) -> float:
        """Largest |acceleration| within the run [m/s2]: A Omega^2 once a whole half cycle is not tapered."""
        return self.amplitude * _peak_of_unit(replace(self, amplitude=1.0))

    def peak_within(self, duration: float) -> float:
        """Largest |acceleration| [m/s2]; the run is that of the motion."""
        return self.peak_acceleration

    def compiled(self) -> FloorMotion:
        return as_floor_motion(
            kernel.HARMONIC, (self.amplitude, self.angular_frequency, self.phase, self.ramp, self.end_time)
        )

    def evaluate(self, times: FloatArray) -> FloatArray:
        return floor_history(self.compiled(), times)


@lru_cache(maxsize=256)  # the cells of a map often differ in amplitude only
def _peak_of_unit(motion: HarmonicMotion) -> float:
    """Largest |acceleration| of a motion of amplitude 1 m [m/s2]."""
    end = min(motion.end_time, motion.duration)
    full = motion.angular_frequency**2
    plateau = (motion.ramp, min(motion.end_time - motion.ramp, motion.duration))
    floor = full if plateau[1] - plateau[0] >= 0.5 * motion.time_scale else 0.0
    if floor == full and motion.ramp == 0.0:
        return full
    reach = SEARCHED_CYCLES * motion.time_scale
    spans = (
        (plateau[0] - reach, plateau[0] + motion.time_scale),
        (plateau[1] - motion.time_scale, plateau[1] + reach),
    )
    return max(floor, *(_peak_between(motion, max(0.0, low), min(end, high)) for low, high in spans))


def _peak_between(motion: HarmonicMotion, low: float, high: float) -> float:
    """Largest |acceleration| in [low, high): sampled, then refined around the largest sample."""
    if high <= low:
        return 0.0
    count = int(SAMPLES_PER_CYCLE * (high - low) / motion.time_scale) + 9
    # Just before the end: at `end_time` itself the floor is at rest.
    times, peak = np.linspace(low, np.nextafter(high, 0.0), count), 0.0
    for _ in range(6):
        sizes = np.abs(motion.evaluate(times)[2])
        best = int(np.argmax(sizes))
        peak = max(peak, float(sizes[best]))
        times = np.linspace(times[max(best - 1, 0)], times[min(best + 1, times.size - 1)], 33)
    return peak


@dataclass(frozen=True, kw_only=True)
class PulseMotion:
    """One pulse of floor acceleration, after which the floor keeps its velocity; ValueError: a number out of range.

    `rectangular`: constant; `half-sine`: half a period; `sine`: one period, after which the velocity is zero.
    """

    shape: PulseShape
    acceleration: float  #: constant (rectangular) or first peak, > 0 toward +x [m/s2]
    pulse: float  #: length [s]
    delay: float = 0.0  #: of its beginning [s]

    def __post_init__(self) -> None:
        if self.shape not in PULSE_KINDS:
            raise ValueError(f"unknown pulse shape {self.shape!r}; known: {', '.join(PULSE_KINDS)}")
        if not math.isfinite(self.acceleration):
            raise ValueError(f"pulse acceleration must be finite, got {self.acceleration} m/s2")
        if not 0.0 < self.pulse < math.inf:
            raise ValueError(f"pulse length must be positive, got {self.pulse} s")
        if not 0.0 <= self.delay < math.inf:
            raise ValueError(f"pulse delay must not be negative, got {self.delay} s")

    @property
    def peak_acceleration(self) -> float:
        """Largest |acceleration| [m/s2]."""
        return abs(self.acceleration)

    @property
    def break_times(self) -> FloatArray:
        """Beginning (unless t = 0) and end of the pulse, shape (1 or 2,) [s]."""
        ends = np.array([self.delay, self.delay + self.pulse])
        return ends[ends > 0.0]

    @property
    def time_scale(self) -> float:
        """Length of the pulse [s]."""
        return self.pulse

    @property
    def span(self) -> tuple[float, float]:
        """Start and end of the pulse [s]."""
        return self.delay, self.delay + self.pulse

    def peak_within(self, duration: float) -> float:
        """Largest |acceleration| up to `duration`, the end of the run [m/s2]."""
        # between these instants its size is monotonic
        quarters = self.delay + self.pulse * np.array([0.0, 0.25, 0.5, 0.75])
        instants = np.append(quarters, duration)
        return float(np.abs(self.evaluate(instants[instants <= duration])[2]).max())

    def compiled(self) -> FloorMotion:
        return as_floor_motion(PULSE_KINDS[self.shape], (self.acceleration, self.pulse, self.delay))

    def evaluate(self, times: FloatArray) -> FloatArray:
        return floor_history(self.compiled(), times)


@dataclass(frozen=True, kw_only=True, eq=False)
class SumOfMotions:
    """Two motions of any kinds at once, such as what a horizontal and a vertical one are along a slope."""

    parts: tuple[HarmonicMotion | PulseMotion | TableMotion, ...]

    @property
    def peak_acceleration(self) -> float:
        """Largest |acceleration| [m/s2]."""
        return self.peak_within(self._end)

    @property
    def _end(self) -> float:
        """Of the run, where a part goes on for as long as that [s]."""
        return max(getattr(part, "duration", part.span[1]) for part in self.parts)

    @property
    def break_times(self) -> FloatArray:
        """Those of all parts, shape (n,) [s]."""
        return np.unique(np.concatenate([part.break_times for part in self.parts]))

    @property
    def time_scale(self) -> float:
        """The shortest of its parts [s]."""
        return min(part.time_scale for part in self.parts)

    @property
    def span(self) -> tuple[float, float]:
        """Start of the first and end of the last [s]."""
        return min(part.span[0] for part in self.parts), max(part.span[1] for part in self.parts)

    def peak_within(self, duration: float) -> float:
        """Largest |acceleration| from 0 to `duration`, at instants that are dense for every part [m/s2]."""
        end = min(duration, self._end)
        count = 1 + math.ceil(SAMPLES_PER_CYCLE * end / self.time_scale)
        tables = [part.times for part in self.parts if isinstance(part, TableMotion)]
        instants = np.unique(
            np.concatenate([np.linspace(0.0, end, min(count, 10**6)), self.break_times, *tables])
        )
        inside = instants[(instants >= 0.0) & (instants <= end)]
        return float(np.abs(self.evaluate(inside)[2]).max())

    def compiled(self) -> FloorMotion:
        """Data for `floor_motion`: tables as one of both times, and the other parts one behind the other."""
        return self._compiled

    @cached_property
    def _compiled(self) -> FloorMotion:
        own = [part.compiled() for part in self.parts]
        tables = [data for data in own if data.kind == kernel.PIECEWISE]
        numbers = [
            number
            for data in own
            if data.kind != kernel.PIECEWISE
            for number in (
                float(data.kind),
                *data.parameters,
                *[0.0] * (kernel.PART - 1 - data.parameters.size),
            )
        ]
        knots = np.unique(np.concatenate([np.empty(0), *(data.breaks for data in tables)]))
        rows = sum((_rows_at(data, knots) for data in tables), start=np.zeros((knots.size + 1, 4)))
        return as_floor_motion(
            kernel.SUM if numbers else kernel.PIECEWISE, tuple(numbers), breaks=knots, coefficients=rows
        )

    def evaluate(self, times: FloatArray) -> FloatArray:
        return floor_history(self.compiled(), times)


def _rows_at(table: FloorMotion, knots: FloatArray) -> FloatArray:
    """The coefficients of a table with more knots than its own, among these, shape (k + 1, 4)."""
    if not knots.size:
        return np.zeros((1, 4))
    row = np.append(0, np.searchsorted(table.breaks, knots, side="right"))
    s = np.append(knots[0], knots) - table.breaks[np.maximum(row - 1, 0)]
    x, v, a, jerk = table.coefficients[row].T
    return np.column_stack(
        [x + s * (v + s * (0.5 * a + s * jerk / 6.0)), v + s * (a + 0.5 * s * jerk), a + s * jerk, jerk]
    )


SingleMotion = NoMotion | HarmonicMotion | PulseMotion | TableMotion
BaseMotion = SingleMotion | SumOfMotions


def along_and_normal(
    horizontal: SingleMotion, vertical: SingleMotion, slope: float
) -> tuple[BaseMotion, BaseMotion]:
    """A horizontal and a vertical motion along a floor and normal to it; `slope` > 0: it falls toward +x [rad]."""
    cosine, sine = math.cos(slope), math.sin(slope)
    return (
        _combined(_scaled(horizontal, cosine), _scaled(vertical, -sine)),
        _combined(_scaled(horizontal, sine), _scaled(vertical, cosine)),
    )


def _scaled(motion: SingleMotion, factor: float) -> SingleMotion:
    match motion:
        case HarmonicMotion():
            turn = math.pi if factor < 0.0 else 0.0
            return replace(motion, amplitude=abs(factor) * motion.amplitude, phase=motion.phase + turn)
        case PulseMotion():
            return replace(motion, acceleration=factor * motion.acceleration)
        case TableMotion():
            return replace(motion, values=factor * motion.values)
    return motion


def _combined(one: SingleMotion, other: SingleMotion) -> BaseMotion:
    """Two motions at once."""
    if isinstance(one, NoMotion):
        return other
    if isinstance(other, NoMotion):
        return one
    if (
        isinstance(one, TableMotion)
        and isinstance(other, TableMotion)
        and one.quantity == other.quantity
        and np.array_equal(one.times, other.times)
    ):
        return replace(one, values=one.values + other.values)
    return SumOfMotions(parts=(one, other))
