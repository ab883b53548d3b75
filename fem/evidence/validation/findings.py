"""The findings of an experiment: predictions beside measurements, and whether they meet the criteria set beforehand."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

Value = float | str


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """One comparison; without a criterion it is stated and not judged."""

    quantity: str  #: with its unit
    measured: Value
    predicted: Value
    criterion: str = ""
    passed: bool | None = None  #: None where there is no criterion
    note: str = ""


@dataclass(frozen=True, kw_only=True)
class Predictor:
    """The score of another predictor on the same tests."""

    name: str
    agreement: str
    source: str


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """An experiment with its findings."""

    name: str
    title: str
    source: str
    licence: str
    tests: int  #: how many are compared
    fitted: str  #: which inputs were fitted, on which tests, and to what
    findings: tuple[Prediction, ...] = ()
    others: tuple[Predictor, ...] = ()
    not_computed: str = ""  #: the reason, where there is nothing to compare
    seconds: float = 0.0

    @property
    def missed(self) -> tuple[Prediction, ...]:
        """Findings that miss their criterion."""
        return tuple(finding for finding in self.findings if finding.passed is False)


@dataclass(frozen=True, kw_only=True)
class ValidationResult:
    """All experiments."""

    experiments: tuple[Experiment, ...]

    @property
    def missed(self) -> int:
        """Number of findings that miss their criterion."""
        return sum(len(one.missed) for one in self.experiments)

    @property
    def judged(self) -> int:
        """Number of findings with a criterion."""
        return sum(finding.passed is not None for one in self.experiments for finding in one.findings)

    @property
    def sentence(self) -> str:
        """The result in one sentence, missed criteria first."""
        if not self.judged:
            return "No experiment was computed."
        skipped = sum(bool(one.not_computed) for one in self.experiments)
        rest = f"; {skipped} of {len(self.experiments)} experiments not computed" if skipped else ""
        if self.missed:
            names = ", ".join(one.title for one in self.experiments if one.missed)
            return f"{self.missed} of {self.judged} predictions miss their criterion ({names}){rest}."
        return f"All {self.judged} predictions meet their criterion{rest}."

    def to_dict(self, versions: Mapping[str, str]) -> dict[str, Any]:
        """Everything as plain data, for JSON."""
        return {
            "passed": self.missed == 0,
            "missed": self.missed,
            "judged": self.judged,
            "sentence": self.sentence,
            "experiments": [
                asdict(one) | {"computed": not one.not_computed, "missed": len(one.missed)}
                for one in self.experiments
            ],
            "versions": dict(versions),
        }
