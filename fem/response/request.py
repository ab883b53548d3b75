"""The request of a response curve: case, frequencies, what of the drive is held, periods waited for."""

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np

from fem.case.case import Case, CaseError, case_hash
from fem.case.tables.quantities import SLIP_LIMIT
from fem.response.stability import LARGEST_PERIOD, TOLERANCE

Hold = Literal["displacement", "acceleration"]
Order = Literal["up-down", "down-up"]
Scale = Literal["linear", "log"]

LEAST_HZ, MOST_HZ = 0.01, 100.0  #: as in a case file
MOST_FREQUENCIES = 2000
MOST_PERIODS = 100_000
LEAST_OBSERVED = 8


@dataclass(frozen=True, kw_only=True)
class ResponseRequest:
    """Frequencies swept up and down, and the periods waited for at each.

    Raises:
        CaseError: a number out of range, a case without a harmonic drive or with one that ends, with a vertical
            motion, the full model.
    """

    case: Case
    first_Hz: float
    last_Hz: float
    count: int  #: frequencies, both ends included
    scale: Scale = "linear"
    hold: Hold | None = None  #: what of the drive stays the same; None: what the case states
    order: Order = "up-down"
    settle: int = 60  #: periods of the drive left out at each frequency
    observe: int = 48  #: periods by which the long-time motion is judged
    tolerance: float = TOLERANCE  #: within which two sections count as the same, see `fem.response.stability`
    largest_period: int = LARGEST_PERIOD  #: tried, in periods of the drive
    limit_slip_m: float | None = None  #: within the periods observed, beyond which a motion does not stand

    def __post_init__(self) -> None:
        motion, solver = self.case.motion, self.case.solver
        if motion.kind != "harmonic":
            raise CaseError(f'[motion] kind must be "harmonic" for a response curve, got "{motion.kind}"')
        if motion.cycles is not None:
            raise CaseError(
                f"[motion] cycles = {motion.cycles:g} ends the drive, a response curve needs one without an end; "
                "leave the key out"
            )
        if self.case.has_vertical:
            raise CaseError(
                f'[vertical] kind must be "none" for a response curve, got "{self.case.vertical.kind}": the frequency '
                "of the horizontal motion is swept, and a vertical one would have to be changed with it; "
                "take --set vertical.kind=none, or a sweep over motion.frequency_Hz"
            )
        if self.case.floor.turn:
            raise CaseError(
                '[floor] motion_along must be "floor" for a response curve on a slope, whose motion has no part normal '
                "to the floor; take --set floor.motion_along=floor"
            )
        if self.case.container.is_loose:
            raise CaseError(
                '[container] joints must be "bolted" for a response curve, which follows one body; take a sweep over '
                "motion.frequency_Hz"
            )
        if self.case.links:
            raise CaseError(
                "[stop] and [tie] must be left out for a response curve, which follows a container that nothing holds; "
                "take --set stop=[] --set tie=[], or a sweep over motion.frequency_Hz"
            )
        if self.case.neighbour:
            raise CaseError(
                "[neighbour] must be left out for a response curve, which follows one body; take --set neighbour=[], "
                "or a sweep over motion.frequency_Hz"
            )
        if solver.model == "full":
            raise CaseError(
                '[solver] model = "full" would take days over the hundreds of periods of a response curve; '
                'take --set solver.model="reduced" or "rigid"'
            )
        if not self.case.output.stop_when_overturned:
            raise CaseError(
                "[output] stop_when_overturned must be true: an overturned container has no response"
            )
        for name, value in (("--from", self.first_Hz), ("--to", self.last_Hz)):
            if not LEAST_HZ <= value <= MOST_HZ:
                raise CaseError(
                    f"{name} must lie between {LEAST_HZ:g} and {MOST_HZ:g} Hz, got {value:g} Hz; "
                    "an angular frequency Omega in rad/s is Omega/(2 pi) in Hz"
                )
        if not self.first_Hz < self.last_Hz:
            raise CaseError(
                f"--from must be less than --to, got {self.first_Hz:g} Hz and {self.last_Hz:g} Hz; "
                "both directions are swept anyway, --order says which first"
            )
        for name, number, least, most in (
            ("--count", self.count, 2, MOST_FREQUENCIES),
            ("--settle", self.settle, 0, MOST_PERIODS),
            ("--observe", self.observe, LEAST_OBSERVED, MOST_PERIODS),
            ("--largest-period", self.largest_period, 1, MOST_PERIODS),
        ):
            if not least <= number <= most:
                raise CaseError(f"{name} must lie between {least} and {most}, got {number}")
        if not 1e-6 <= self.tolerance <= 0.1:
            raise CaseError(
                f"--tolerance must lie between 1e-6 and 0.1 of the slenderness angle, got {self.tolerance:g}; "
                f"{TOLERANCE:g} is usual"
            )
        if self.limit_slip_m is not None:
            try:
                SLIP_LIMIT.check(self.limit_slip_m)
            except ValueError as error:
                raise CaseError(f"--limit-slip {error}") from None
        if not self.case.amplitude > 0.0:
            raise CaseError(
                "[motion] a response curve needs a floor that moves: give amplitude_m or peak_acceleration_m_s2 above 0"
            )

    @property
    def held(self) -> Hold:
        """What of the drive stays the same."""
        return self.hold or ("acceleration" if self.case.motion.amplitude_m is None else "displacement")

    @property
    def frequencies(self) -> np.ndarray:
        """Rising, shape (count,) [Hz]."""
        space = np.geomspace if self.scale == "log" else np.linspace
        return np.asarray(space(self.first_Hz, self.last_Hz, self.count))

    @property
    def held_value(self) -> float:
        """Amplitude of the floor's displacement [m] or acceleration [m/s2], whichever is held."""
        amplitude, omega = self.case.amplitude, self.case.angular_frequency
        return amplitude if self.held == "displacement" else amplitude * omega**2

    @property
    def held_in_words(self) -> str:
        """What of the drive stays the same, with its value."""
        if self.held == "displacement":
            return f"amplitude {1e3 * self.held_value:.4g} mm held"
        return f"peak acceleration {self.held_value:.4g} m/s² held"

    def to_dict(self) -> dict[str, object]:
        """As the result states it, without the case."""
        numbers = asdict(self)
        del numbers["case"], numbers["hold"]
        if self.limit_slip_m is None:
            del numbers["limit_slip_m"]
        frequencies = self.frequencies.tolist()
        return numbers | {"held": self.held, "held_value": self.held_value, "frequencies_Hz": frequencies}

    @property
    def hash(self) -> str:
        """A hash, equal for requests that give the same result."""
        document = self.to_dict() | {"case": case_hash(self.case)}
        return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()
