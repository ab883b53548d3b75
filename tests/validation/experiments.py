"""An experiment with its findings: predictions beside measurements, by criteria that were set beforehand."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from evidence.findings import Finding
from evidence.suite import failures

from fem.runtime.identity import versions

#: keys of a finding in validate.json, with the attributes that they hold
KEYS = {"quantity": "what", "measured": "reference", "predicted": "value", "passed": "met"} | {
    name: name for name in ("criterion", "note")
}


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A figure of the page."""

    name: str
    caption: str
    svg: str


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
    findings: tuple[Finding, ...] = ()
    others: tuple[Predictor, ...] = ()
    figures: tuple[Picture, ...] = ()
    not_computed: str = ""  #: the reason, where there is nothing to compare
    seconds: float = 0.0

    @property
    def missed(self) -> int:
        """Number of findings that miss their criterion."""
        return failures(self.findings)


@dataclass(frozen=True, kw_only=True)
class ValidationResult:
    """All experiments."""

    experiments: tuple[Experiment, ...]

    @property
    def findings(self) -> Iterator[Finding]:
        """Every finding, in order."""
        return (finding for experiment in self.experiments for finding in experiment.findings)

    @property
    def failures(self) -> int:
        """Number of findings that miss their criterion."""
        return failures(self.findings)

    @property
    def judged(self) -> int:
        """Number of findings with a criterion."""
        return sum(finding.holds is not None for finding in self.findings)

    @property
    def sentence(self) -> str:
        """The result in one sentence, missed criteria first."""
        if not self.judged:
            return "No experiment was computed."
        judged = f"{self.judged - self.failures} of {self.judged} judged predictions meet their criterion"
        missed = ", ".join(experiment.title for experiment in self.experiments if experiment.missed)
        parts = [f"{judged}; missed: {missed}" if missed else judged]
        if stated := [finding for finding in self.findings if finding.holds is None]:
            off = [finding for finding in stated if finding.telling]
            parts.append(f"{len(stated)} are stated and not judged")
            if off:
                gaps = "; ".join(
                    f"{finding.what}: measured {finding.reference}, predicted {finding.value}"
                    for finding in off
                )
                parts[-1] += f", of which {len(off)} tell most ({gaps})"
        if skipped := [experiment.title for experiment in self.experiments if experiment.not_computed]:
            parts.append(
                f"{len(skipped)} of {len(self.experiments)} experiments not computed ({', '.join(skipped)})"
            )
        return "; ".join(parts) + "."

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data, for JSON."""
        return {
            "passed": self.failures == 0,
            "missed": self.failures,
            "judged": self.judged,
            "sentence": self.sentence,
            "experiments": [
                {key: value for key, value in asdict(experiment).items() if key != "figures"}
                | {"findings": [finding.document(KEYS) for finding in experiment.findings]}
                | {"computed": not experiment.not_computed, "missed": experiment.missed}
                for experiment in self.experiments
            ],
            "versions": versions(),
        }
