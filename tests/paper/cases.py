"""The paper's containers and motions: shipped cases, and what the check of a claim changes of them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from paper.dimensions import HOLDING

from fem.case.case import Case, load_case

#: short names of the keys that claims change most
KEYS = {
    "model": "solver.model",
    "duration": "solver.duration_s",
    "interval": "output.history_s",
    "support": "support.kind",
    "boxes": "container.boxes",
    "mu_static": "contact.mu_static",
    "mu_kinetic": "contact.mu_kinetic",
    "damping": "contact.damping_ratio",
    "amplitude": "motion.amplitude_m",
    "peak": "motion.peak_acceleration_m_s2",
    "frequency": "motion.angular_frequency_rad_s",
    "cycles": "motion.cycles",
    "rotation": "initial.rotation_rad",
    "velocity": "initial.angular_velocity_rad_s",
}


@dataclass(frozen=True, kw_only=True)
class PaperCase:
    """A case that a reader can run: a shipped case and the keys changed in it."""

    base: str  #: name of a shipped case
    values: Mapping[str, Any] = field(default_factory=dict)  #: dotted keys
    what: str = ""  #: for people

    def but(self, *changes: Mapping[str, Any], what: str = "", **named: float | str) -> "PaperCase":
        """This case with more keys changed; of two values of a key the last one counts.

        Args:
            changes: values by dotted keys.
            what: text for people; default: as before.
            named: values by the short names in KEYS; numbers are rounded to eight digits, as the command has them.
        """
        values = dict(self.values)
        for change in changes:
            values |= change
        values |= {KEYS[name]: _rounded(value) for name, value in named.items()}
        return PaperCase(base=self.base, values=values, what=what or self.what)

    def scan(self, name: str, values: Iterable[float], what: str) -> list["PaperCase"]:
        """This case once for each value of a key by its short name; `what` is a format of the value."""
        return [self.but(what=what.format(value), **{name: value}) for value in values]

    @property
    def case(self) -> Case:
        """The case as a run reads it, without fields."""
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


def _rounded(value: Any) -> Any:
    return float(f"{value:.8g}") if isinstance(value, float) else value


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


def friction(mu_static: float, mu_kinetic: float) -> dict[str, float]:
    """The keys of both coefficients, rounded as by `but`."""
    return {"contact.mu_static": _rounded(mu_static), "contact.mu_kinetic": _rounded(mu_kinetic)}


NO_SLIDING = friction(*HOLDING)
