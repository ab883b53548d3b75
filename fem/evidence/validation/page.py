"""The experiments as lines for a terminal and as a self-contained page, missed criteria first."""

from collections.abc import Iterator

from fem.evidence import page
from fem.evidence.findings import Finding
from fem.evidence.validation.experiments import Experiment, Predictor, ValidationResult
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
    Column[Finding]("quantity", lambda one: page.noted(one.what, one.note)),
    Column("measured", lambda one: page.short_text(one.reference), NUMBER),
    Column("predicted", lambda one: page.short_text(one.value), NUMBER),
    Column("criterion", lambda one: one.criterion),
    Column("result", lambda one: page.result_of(one.holds, *page.MET_OR_MISSED)),
]
OTHERS = [
    Column[Predictor]("other predictors of the same tests", lambda one: one.name),
    Column("share predicted", lambda one: one.agreement, NUMBER),
    Column("source", lambda one: one.source),
]


def lines_of(result: ValidationResult) -> list[str]:
    """The findings for a terminal."""
    groups = [
        (f"{one.title}  ({one.tests} tests, {one.seconds:.0f} s)", _lines(one)) for one in _ordered(result)
    ]
    return [result.sentence, *page.table_lines(groups, "")]


def _lines(one: Experiment) -> list[str]:
    if one.not_computed:
        return [f"  not computed: {one.not_computed}"]
    findings = (line for finding in one.findings for line in page.finding_lines(finding))
    return [
        f"  fitted: {one.fitted}",
        *findings,
        *(f"  {other.name}: {other.agreement}" for other in one.others),
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
                *(PageSection(one.title, one.name, list(_blocks(one))) for one in _ordered(result)),
            ],
        )
    )


def _blocks(one: Experiment) -> Iterator[Block]:
    yield Note(f"{typeset(one.source)}. Licence: {one.licence}.")
    if one.not_computed:
        yield f"Not computed: {one.not_computed}."
        return
    yield f"{one.tests} tests. Fitted: {typeset(one.fitted)}."
    yield table_of(f"findings of {one.title}", FINDINGS, one.findings, row_look=page.look_of)
    for picture in one.figures:
        svg = svg_element(picture.svg, label=picture.caption, prefix=picture.name)
        yield Figure(svg, picture.caption, caption=picture.caption)
    if one.others:
        yield table_of("other predictors", OTHERS, one.others)


def _ordered(result: ValidationResult) -> list[Experiment]:
    """Experiments that are missed first."""
    return sorted(result.experiments, key=lambda one: not one.missed)
