"""The experiments as lines for a terminal and as a self-contained page, missed criteria first."""

from collections.abc import Iterator

from evidence import page
from evidence.findings import Finding
from validation.experiments import Experiment, Predictor, ValidationResult

from fem.html.page import Page, html_of, svg_element
from fem.html.sections import NUMBER, Block, Column, Figure, Note, PageSection, Paragraph, table_of
from fem.html.units import typeset

SHOWS = "shows the tables"
INTRODUCTION = (
    "Every table compares predictions of this program with measurements in a laboratory. Quantities that were not "
    "measured were fitted on some of the tests to predict the others. Each criterion was set "
    "before the comparison; a line without one is stated and not judged."
)
FINDINGS = [
    Column[Finding]("quantity", lambda finding: page.noted(finding.what, finding.note)),
    Column("measured", lambda finding: page.short_text(finding.reference), NUMBER),
    Column("predicted", lambda finding: page.short_text(finding.value), NUMBER),
    Column("criterion", lambda finding: finding.criterion),
    Column("result", lambda finding: page.result_of(finding.holds, *page.MET_OR_MISSED)),
]
OTHERS = [
    Column[Predictor]("other predictors of the same tests", lambda predictor: predictor.name),
    Column("share predicted", lambda predictor: predictor.agreement, NUMBER),
    Column("source", lambda predictor: predictor.source),
]


def lines_of(result: ValidationResult) -> list[str]:
    """The findings for a terminal."""
    groups = [
        (f"{experiment.title}  ({experiment.tests} tests, {experiment.seconds:.0f} s)", _lines(experiment))
        for experiment in _ordered(result)
    ]
    return [result.sentence, *page.table_lines(groups, "")]


def _lines(experiment: Experiment) -> list[str]:
    if experiment.not_computed:
        return [f"  not computed: {experiment.not_computed}"]
    findings = (line for finding in experiment.findings for line in page.finding_lines(finding))
    return [
        f"  fitted: {experiment.fitted}",
        *findings,
        *(f"  {other.name}: {other.agreement}" for other in experiment.others),
    ]


def page_of(result: ValidationResult) -> str:
    """The page, missed experiments first."""
    look = "fail" if result.failures else "pass" if result.judged else ""
    return html_of(
        Page(
            kind="Validation",
            title="Validation",
            name="validate",
            introduction=[Paragraph(result.sentence, f"sentence {look}".rstrip()), page.computed_now()],
            sections=[
                INTRODUCTION,
                *(
                    PageSection(experiment.title, experiment.name, list(_blocks(experiment)))
                    for experiment in _ordered(result)
                ),
            ],
        )
    )


def _blocks(experiment: Experiment) -> Iterator[Block]:
    yield Note(f"{typeset(experiment.source)}. Licence: {experiment.licence}.")
    if experiment.not_computed:
        yield f"Not computed: {experiment.not_computed}."
        return
    yield f"{experiment.tests} tests. Fitted: {typeset(experiment.fitted)}."
    yield table_of(f"findings of {experiment.title}", FINDINGS, experiment.findings, row_look=page.look_of)
    for picture in experiment.figures:
        svg = svg_element(picture.svg, label=picture.caption, prefix=picture.name)
        yield Figure(svg, picture.caption, caption=picture.caption)
    if experiment.others:
        yield table_of("other predictors", OTHERS, experiment.others)


def _ordered(result: ValidationResult) -> list[Experiment]:
    """Experiments that are missed first."""
    return sorted(result.experiments, key=lambda experiment: not experiment.missed)
