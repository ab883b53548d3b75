"""The experiments as lines for a terminal and as a self-contained page, missed criteria first."""

import datetime as dt

from fem.evidence.validation.findings import Experiment, Prediction, ValidationResult, Value
from fem.html.page import render_page
from fem.html.units import short, typeset
from fem.runtime.identity import versions


def table_lines(result: ValidationResult) -> list[str]:
    """The findings for a terminal."""
    lines = [result.sentence]
    for one in sorted(result.experiments, key=_missed_last):
        lines += ["", f"{one.title}  ({one.tests} tests, {one.seconds:.0f} s)"]
        if one.not_computed:
            lines.append(f"  not computed: {one.not_computed}")
            continue
        lines.append(f"  fitted: {one.fitted}")
        for finding in one.findings:
            lines.append(f"  {finding.quantity}")
            judged = f"; {finding.criterion}: {_word(finding)}" if finding.criterion else ""
            lines.append(
                f"    measured {_text(finding.measured)}, predicted {_text(finding.predicted)}{judged}"
            )
        lines += [f"  {other.name}: {other.agreement}" for other in one.others]
    return lines


def page(result: ValidationResult) -> str:
    """The page, missed experiments first."""
    return render_page(
        "validate.html.j2",
        result=result,
        experiments=sorted(result.experiments, key=_missed_last),
        versions=", ".join(f"{name} {version}" for name, version in versions().items()),
        today=dt.date.today().isoformat(),
        text=_text,
        word=_word,
        typeset=typeset,
    )


def _missed_last(one: Experiment) -> bool:
    """Sorts the experiments that are missed to the front."""
    return not one.missed


def _word(finding: Prediction) -> str:
    if finding.passed is None:
        return ""
    return "met" if finding.passed else "MISSED"


def _text(value: Value) -> str:
    return value if isinstance(value, str) else short(float(value), figures=3)
