"""The request of a response curve: case, frequencies, what of the drive is held, starts, periods waited for."""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from fem.case.case import Case, CaseError, case_hash
from fem.study.driver import hash_of

Hold = Literal["displacement", "acceleration"]
#: what a result states of its request
ASKED = dict.fromkeys(("count", "starts", "settle", "observe"), int) | {"shell": bool, "held": Hold}
ASKED |= dict.fromkeys(("first_Hz", "last_Hz", "held_value"), float)

#: of the case's own frequency, in steps of an eleventh: 0.3 to 3 Hz of the paper's motion, which is one of them
FROM, TO, COUNT = 3.0 / 11.0, 30.0 / 11.0, 28
TURN = 2.0 * math.pi  #: [rad]
LEAST_HZ, MOST_HZ = 0.01, 100.0  #: as in a case file
MOST_FREQUENCIES = 2000
MOST_PERIODS = 100_000
MOST_STARTS = 1000
LEAST_OBSERVED = 8
SAMPLES_PER_PERIOD = 128  #: of the history
CLOSEST = 1e-6  #: relative distance of two frequencies that are still different motions of the floor


@dataclass(frozen=True, kw_only=True)
class ResponseRequest:
    """Frequencies swept up and down, random starts at each, and the periods waited for.

    Raises:
        CaseError: a number out of range, a case without a harmonic drive or with one that ends, with a vertical
            motion, the full model.
    """

    case: Case
    first_Hz: float
    last_Hz: float
    count: int = COUNT  #: frequencies, both ends included
    hold: Hold | None = None  #: what of the drive stays the same; None: what the case states
    starts: int = 0  #: random states from which each frequency is begun as well
    shell: bool = False  #: a rigid container is followed as an elastic one, too
    settle: int = 60  #: periods of the drive left out at each frequency
    observe: int = 48  #: periods by which the long-time motion is judged

    def __post_init__(self) -> None:
        case, motion = self.case, self.case.motion
        needed, other = "for a response curve", "take a sweep over motion.frequency_Hz"
        alone = f"{needed}, which follows one body; {other}"
        links, upright = bool(case.links or case.neighbour), case.output.stop_when_overturned
        for refused, words in (
            (motion.kind != "harmonic", f'[motion] kind must be "harmonic" {needed}, got "{motion.kind}"'),
            (motion.cycles is not None, f"[motion] cycles must be left out {needed}: they end the drive"),
            (
                case.has_vertical,
                f'[vertical] kind must be "none" {needed}, got "{case.vertical.kind}"; {other}',
            ),
            (case.floor.turn != 0.0, f'[floor] motion_along must be "floor" {needed} on a slope'),
            (case.container.is_loose, f'[container] joints must be "bolted" {alone}'),
            (links, f"[stop] and [tie] must be left out {alone}, and so must [neighbour]"),
            (
                self.shell and case.solver.model != "rigid",
                '--shell adds the elastic container to a rigid one; leave it out, or --set solver.model="rigid"',
            ),
            (case.solver.model == "full", f'[solver] model must be "reduced" or "rigid" {needed}'),
            (
                not upright,
                "[output] stop_when_overturned must be true: an overturned container has no response",
            ),
        ):
            if refused:
                raise CaseError(words)
        if not case.motion.amplitude > 0.0:
            raise CaseError(
                "[motion] a response curve needs a floor that moves: give amplitude_m or peak_acceleration_m_s2 above 0"
            )
        for name, value in (("--from", self.first_Hz), ("--to", self.last_Hz)):
            if not LEAST_HZ <= value <= MOST_HZ:
                why = "an angular frequency Omega in rad/s is Omega/(2 pi) in Hz"
                why = why if value else "with eta = 0 the floor does not move"
                raise CaseError(
                    f"{name} must lie between {LEAST_HZ:g} and {MOST_HZ:g} Hz, got {value:g} Hz; {why}"
                )
        if not self.first_Hz < self.last_Hz:
            raise CaseError(
                f"--from must be less than --to, got {self.first_Hz:g} Hz and {self.last_Hz:g} Hz; "
                "both directions are swept anyway"
            )
        for name, number, least, most in (
            ("--count", self.count, 2, MOST_FREQUENCIES),
            ("--starts", self.starts, 0, MOST_STARTS),
            ("--settle", self.settle, 0, MOST_PERIODS),
            ("--observe", self.observe, LEAST_OBSERVED, MOST_PERIODS),
        ):
            if not least <= number <= most:
                raise CaseError(f"{name} must lie between {least} and {most}, got {number}")
        step = float(np.min(np.diff(self.frequencies) / self.frequencies[1:]))
        if step < CLOSEST:
            raise CaseError(
                f"--from, --to and --count ask for frequencies {step:.1g} apart, below the resolution of "
                f"{CLOSEST:g}; take fewer, or a wider range"
            )
        for number in (0, self.count - 1):  # refused there, it is refused before anything is computed
            self.case_at(number)

    @property
    def held(self) -> Hold:
        """What of the drive stays the same."""
        return self.hold or ("acceleration" if self.case.motion.amplitude_m is None else "displacement")

    @property
    def frequencies(self) -> np.ndarray:
        """Rising, shape (count,) [Hz]."""
        return np.linspace(self.first_Hz, self.last_Hz, self.count)

    @property
    def own_frequency(self) -> float:
        """The frequency of the case [Hz]."""
        return self.case.motion.angular_frequency / TURN

    @property
    def held_value(self) -> float:
        """Amplitude of the floor's displacement [m] or acceleration [m/s2], whichever is held."""
        amplitude, omega = self.case.motion.amplitude, self.case.motion.angular_frequency
        return amplitude if self.held == "displacement" else amplitude * omega**2

    @property
    def held_in_words(self) -> str:
        """What of the drive stays the same, with its value."""
        amplitude, peak = f"{1e3 * self.held_value:.4g} mm", f"{self.held_value:.4g} m/s²"
        return (
            f"amplitude {amplitude} held" if self.held == "displacement" else f"peak acceleration {peak} held"
        )

    def case_at(self, number: int, model: str | None = None) -> Case:
        """The case at one of the frequencies, with another model where one is given."""
        key = "motion.amplitude_m" if self.held == "displacement" else "motion.peak_acceleration_m_s2"
        period = 1.0 / float(self.frequencies[number])
        return self.case.with_values(
            {
                "motion.frequency_Hz": 1.0 / period,
                key: self.held_value,
                "solver.duration_s": (4.0 + 2.0 * math.ceil(self.case.motion.ramp_cycles)) * period,
                "solver.model": model or self.case.solver.model,
                "output.history_s": period / SAMPLES_PER_PERIOD,
                "output.fields_s": 0.0,
            }
        )

    def to_dict(self) -> dict[str, object]:
        """As the result states it, without the case."""
        numbers = {key: value for key, value in vars(self).items() if key not in ("case", "hold")}
        swept = {"frequencies_Hz": self.frequencies.tolist(), "own_Hz": self.own_frequency}
        return numbers | {"held": self.held, "held_value": self.held_value} | swept

    @property
    def hash(self) -> str:
        """A hash, equal for requests that give the same result."""
        return hash_of(self.to_dict() | {"case": case_hash(self.case)})


def request_of(case: Case, first_Hz: float | None, last_Hz: float | None, **asked: Any) -> ResponseRequest:
    """A request about the frequency of a case, where an end is not given; raises as `ResponseRequest`."""
    own = case.motion.angular_frequency / TURN if case.motion.kind == "harmonic" else 1.0
    first, last = (share * own if end is None else end for share, end in ((FROM, first_Hz), (TO, last_Hz)))
    return ResponseRequest(case=case, first_Hz=first, last_Hz=last, **asked)
