"""The paper's containers and motions: shipped cases, and what the check of a claim changes of them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from fem.case.case import Case, load_case

GRAVITY, WIDTH, HEIGHT = 9.81, 1.1, 4.0  #: m/s2; of the stack [m]
BOX_WEIGHT = 24525.0  #: of one box, 1 m high [N]
HALF_WIDTH = 0.5 * WIDTH  #: a/2 [m]
UPLIFT = GRAVITY * WIDTH / HEIGHT  #: acceleration at which the stack tilts, g a/c [m/s2]
#: p of a homogeneous block as large as the stack, p^2 = 3 g/(4 R) [1/s]
FREQUENCY_PARAMETER = math.sqrt(0.75 * GRAVITY / (0.5 * math.hypot(WIDTH, HEIGHT)))
ANGULAR_FREQUENCY = 6.928  #: sqrt(2.4 m/s2 / 50 mm), the paper's motion [rad/s]
STATED_PEAK, PLATEAU_PEAK = 2.4, 4.0  #: [m/s2]


@dataclass(frozen=True, kw_only=True)
class PaperCase:
    """A case that a reader can run: a shipped case and the keys changed in it."""

    base: str  #: name of a shipped case
    values: Mapping[str, Any] = field(default_factory=dict)  #: dotted keys
    what: str = ""  #: for people

    def but(self, *changes: Mapping[str, Any], what: str = "") -> "PaperCase":
        """This case with more keys changed; the last of two values of a key counts."""
        values = dict(self.values)
        for change in changes:
            values |= change
        return PaperCase(base=self.base, values=values, what=what or self.what)

    @property
    def case(self) -> Case:
        """The case as a run reads it, without fields.

        Raises:
            CaseError: as for a case file.
        """
        return load_case(self.base).with_values({**self.values, "output.fields_s": 0.0})

    @property
    def key(self) -> tuple[Any, ...]:
        """Equal for cases with the same result."""
        return self.base, *sorted(self.values.items())

    @property
    def command(self) -> str:
        """The command line that runs it."""
        changes = "".join(f" --set {key}={_literal(value)}" for key, value in self.values.items())
        return f"python -m fem run {self.base}{changes} --out outputs/try"


def _literal(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, int | float) else str(value)


BOX = PaperCase(base="seed_box", what="one box, 50 mm at 6.928 rad/s")
STACK = PaperCase(base="seed_stack", what="stack of four, 50 mm at 6.928 rad/s")
PLATEAU = PaperCase(base="seed_stack_plateau", what="stack of four, 4.0 m/s² at 6.928 rad/s")

RIGID, SHELL = {"solver.model": "rigid"}, {"solver.model": "reduced"}
#: a rigid container whose history is not needed
FOR_MAPS = {**RIGID, "output.history_s": 2.0}
#: the paper's g with its mass: 2500 kg
G_TEN = {"gravity_m_s2": 10.0, "container.weight_N": 25000.0}


def friction(static: float, kinetic: float) -> dict[str, float]:
    """Both coefficients of friction."""
    return {"contact.mu_static": static, "contact.mu_kinetic": kinetic}


NO_SLIDING = friction(1.0, 1.0)


def duration(seconds: float) -> dict[str, float]:
    """A run of another length."""
    return {"solver.duration_s": seconds}


def sampled(interval: float) -> dict[str, float]:
    """A history at another interval [s]."""
    return {"output.history_s": interval}


def harmonic(peak: float, angular_frequency: float) -> dict[str, float]:
    """A harmonic motion by its peak acceleration [m/s2] and frequency [rad/s]."""
    return {
        "motion.peak_acceleration_m_s2": float(f"{peak:.8g}"),
        "motion.angular_frequency_rad_s": float(f"{angular_frequency:.8g}"),
    }


def amplitude(metres: float, angular_frequency: float | None = None) -> dict[str, float]:
    """A harmonic motion by its amplitude, at the paper's frequency unless another is given [rad/s]."""
    frequency = {} if angular_frequency is None else {"motion.angular_frequency_rad_s": angular_frequency}
    return {"motion.amplitude_m": metres, **frequency}


def released(rotation: float) -> dict[str, float]:
    """Start at rest from a rotation [rad]."""
    return {"initial.rotation_rad": float(f"{rotation:.8g}")}
