"""An experiment with its findings: predictions beside measurements, by criteria that were set beforehand.

Measured numbers are in `tests/validation/data`; the comment of each table names its source and licence.
"""

import csv
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from evidence.findings import Finding, failures
from evidence.pages import Picture

from fem.runtime.identity import versions

#: keys of a finding in validate.json, with the attributes that they hold
KEYS = {"quantity": "what", "measured": "reference", "predicted": "value", "passed": "met"} | {
    name: name for name in ("criterion", "note")
}


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


def document_of(experiments: Sequence[Experiment]) -> dict[str, Any]:
    """The content of validate.json."""
    every = [finding for experiment in experiments for finding in experiment.findings]
    return {
        "passed": failures(every) == 0,
        "missed": failures(every),
        "judged": sum(finding.holds is not None for finding in every),
        "sentence": in_a_sentence(experiments),
        "experiments": [
            {key: value for key, value in asdict(experiment).items() if key != "figures"}
            | {"findings": [finding.document(KEYS) for finding in experiment.findings]}
            | {"computed": not experiment.not_computed, "missed": experiment.missed}
            for experiment in experiments
        ],
        "versions": versions(),
    }


def in_a_sentence(experiments: Sequence[Experiment]) -> str:
    """The result, missed criteria first."""
    every = [finding for experiment in experiments for finding in experiment.findings]
    stated = [finding for finding in every if finding.holds is None]
    judged = len(every) - len(stated)
    if not judged:
        return "No experiment was computed."
    met = f"{judged - failures(every)} of {judged} judged predictions meet their criterion"
    missed = ", ".join(experiment.title for experiment in experiments if experiment.missed)
    parts = [f"{met}; missed: {missed}" if missed else met]
    if stated:
        off = [finding for finding in stated if finding.telling]
        gaps = "; ".join(f"{one.what}: measured {one.reference}, predicted {one.value}" for one in off)
        telling = f", of which {len(off)} tell most ({gaps})" if off else ""
        parts.append(f"{len(stated)} are stated and not judged{telling}")
    if skipped := [experiment.title for experiment in experiments if experiment.not_computed]:
        parts.append(f"{len(skipped)} of {len(experiments)} experiments not computed ({', '.join(skipped)})")
    return "; ".join(parts) + "."


def measured_table(name: str) -> list[dict[str, str]]:
    """Rows of a table, by column."""
    text = (Path(__file__).parent / "data" / name).read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
