"""What the runs of a verification found, on its page."""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

from fem.html import sections as html
from fem.html.units import ABSENT, figure_head, short
from fem.results.figures import FIGURES, TURNED, Place, figures_of, keys_of
from fem.results.outcome import ENDINGS, Outcome
from fem.site_check.page.figures import draw_floor, draw_scan
from fem.site_check.page.view import RunPair, SiteView, figure, friction, pairs_of, sign_in_words, two_figures
from fem.site_check.reasons import destroyed
from fem.site_check.result import BY_RULE, ByRule, ConfirmedRun, SiteRun
from fem.site_check.rule import RunGroup, both_directions

BOTH = (
    "Both: the slips of the two elevations as vectors, the larger of 100 % + 30 % and 30 % + 100 % (EN 1998-1:2004, "
    "4.3.3.5.1 (3), of effects). Friction is not linear: an estimate, no part of the rule."
)
MARGIN = (
    "The margin is the factor on the set, not the ratio: a body may return from beyond its angle, and a body that a "
    "weaker motion overturns may stand under a stronger one. Near the boundary a single run may come out otherwise "
    "with other numerics, so read the factor as a magnitude."
)
SINGLE = (
    "The peak of a single motion is chaotic: with other numerics the same motion may turn a body half or twice as far. "
    "Two figures are given; what the rule makes of all of them is steadier."
)
FURTHER = [key for key in keys_of(Place.RUNS) if key != TURNED]


def runs_section(view: SiteView, *, brief: bool = False) -> html.PageSection:
    """What the runs found, and the margin; in brief without the runs of a single motion."""
    if not view.groups:
        return html.section("", "found")
    result, governing = view.result, view.governing
    both = both_directions(view.groups)
    signs = "with both signs of the vertical " if len(view.signs) > 1 else ""
    blocks: list[html.Block] = [
        f"Every motion {signs}at each weight and friction, model {result.inputs.model}. No value of friction is always "
        "the unfavourable one: with low friction the body slides, with high friction it rocks. At a ratio of 1 the "
        "body has reached its slenderness angle, beyond which it falls if left alone.",
    ]
    moving = [group for group in view.groups if not group.rests]
    if moving:
        blocks.append(_groups_table(view, moving, both))
    if resting := len(view.groups) - len(moving):
        blocks.append(
            f"{resting} of {len(view.groups)} combinations of weight, elevation and friction rest in every motion."
        )
    if both and moving:
        blocks.append(html.Note(BOTH))
    if result.floor and result.floor.z_over_h is not None and not brief:
        drawn = figure(draw_floor(result.action, result.floor), "floor", "spectra of the floor")
        blocks += [html.Heading("The floor in the building"), drawn]
    if governing and not governing.rests and not brief:
        where = f"{governing.first.mass}, friction {friction(governing.first)}"
        blocks += [
            html.Heading(f"Motion by motion, where it governs: {where}"),
            _governing_table(governing),
            html.Note(SINGLE),
        ]
    if result.result.confirmed and not brief:
        blocks += [html.Heading("The deciding runs, repeated"), _confirmed_table(result.result.confirmed)]
    if result.result.scan:
        drawn = figure(
            draw_scan(result.result, result.inputs), "scan", "outcome over the factor on the motions"
        )
        blocks += [html.Heading("Margin"), drawn, html.Note(MARGIN)]
    return html.section("What the runs found", "found", *blocks)


class _GroupRow(NamedTuple):
    """A row of the groups: of one elevation, or of both with only their slip."""

    group: RunGroup
    elevation: str
    overturned: str
    by_rule: ByRule
    look: str = ""


def _groups_table(
    view: SiteView, groups: Sequence[RunGroup], both: Sequence[tuple[RunGroup, float]]
) -> html.Table:
    def row_of(group: RunGroup) -> _GroupRow:
        failed = f", {group.failed} failed" if group.failed else ""
        look = "given" if group is view.governing else ""
        return _GroupRow(
            group,
            group.first.elevation,
            f"{group.overturned} of {len(group.runs)}{destroyed(group.invalid)}{failed}",
            group.by_rule,
            "failed" if group.overturned or group.invalid or group.failed else look,
        )

    period: html.Column[_GroupRow] = html.Column(
        "building period [s]", lambda row: short(row.group.first.building_period_s), html.NUMBER
    )
    columns: list[html.Column[_GroupRow]] = [
        html.Column("weight", lambda row: row.group.first.mass),
        html.Column("elevation", lambda row: row.elevation),
        *([period] if view.result.floor and view.result.floor.building_periods_s else []),
        html.Column("friction, static / kinetic", lambda row: friction(row.group.first), html.NUMBER),
        html.Column("overturned", lambda row: row.overturned, html.NUMBER),
        *html.figure_columns(BY_RULE, text=two_figures, value=lambda row, key: row.by_rule[key]),
    ]
    rows = [row_of(group) for group in groups]
    rows += [
        _GroupRow(group, "both, 100 % + 30 %", ABSENT, ByRule(slip_m=slip))
        for group, slip in both
        if not group.rests
    ]
    return html.table_of("what the runs found", columns, rows, row_look=lambda row: row.look, look="runs")


def run_columns(
    k: int, head: str, turned_head: str, further: Sequence[str] = FURTHER
) -> list[html.Column[RunPair]]:
    """What the run with sign `k` of a pair found: its outcome, its rotation ratio and further figures by their keys."""

    def of(cell: html.CellOf[SiteRun], pair: RunPair) -> str:
        return cell(pair.runs[k]) if k < len(pair.runs) else ""

    def found(key: str, run: SiteRun) -> str:
        fell = key == TURNED and run.outcome == Outcome.OVERTURNED
        return "fell" if fell else two_figures(FIGURES[key], run[key])

    return [
        html.Column(head, partial(of, lambda run: run.outcome or "failed")),
        html.Column(turned_head, partial(of, partial(found, TURNED)), html.NUMBER),
        *(
            html.Column(figure_head(FIGURES[key]), partial(of, partial(found, key)), html.NUMBER)
            for key in further
        ),
    ]


def _governing_table(group: RunGroup) -> html.Table:
    columns: list[html.Column[RunPair]] = [
        html.Column("motion", lambda pair: str(pair.motion), html.NUMBER),
        html.Column("sign", lambda pair: sign_in_words(pair.runs[0].vertical_sign)),
        *run_columns(0, "outcome", "rotation ratio"),
    ]
    single = [pair._replace(runs=(run,)) for pair in pairs_of(group) for run in pair.runs]
    return html.table_of(
        "motion by motion",
        columns,
        single,
        row_look=lambda pair: "failed" if pair.runs[0].outcome in (*ENDINGS, None) else "",
        look="runs",
    )


def _confirmed_table(confirmed: Sequence[ConfirmedRun]) -> html.Table:
    columns: list[html.Column[ConfirmedRun]] = [
        html.Column("motion", lambda repeat: str(repeat.run.motion), html.NUMBER),
        html.Column("weight", lambda repeat: repeat.run.mass),
        html.Column("friction", lambda repeat: friction(repeat.run), html.NUMBER),
        html.Column("model", lambda repeat: repeat.model),
        html.Column("outcome", lambda repeat: repeat.outcome or "failed"),
        *html.figure_columns(figures_of(Place.KEY), text=two_figures),
        html.Column("how sure", lambda repeat: repeat.sure or ABSENT),
        html.Column("outcomes over unknown inputs", lambda repeat: ", ".join(repeat.outcomes) or ABSENT),
    ]
    return html.table_of("the deciding runs, repeated", columns, confirmed, look="runs")
