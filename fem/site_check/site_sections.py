"""The sections of the page of a site behind its first sheet: runs, rules of thumb, appendices."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import NamedTuple

from markupsafe import Markup

from fem.html import sections as html
from fem.html.formula import formula_markup
from fem.html.page import svg_element
from fem.html.units import ABSENT, figure_head, number, quantity, short, typeset
from fem.results.figures import FIGURES, SLIPPED, TURNED, Place, Shown, declared_in, figures_of, keys_of
from fem.results.outcome import ENDINGS, Outcome
from fem.seismic.hazard import ACCELERATION
from fem.site_check.figures import draw_floor, draw_methods, draw_scan
from fem.site_check.reasons import destroyed
from fem.site_check.result import (
    BY_RULE,
    AnnualRates,
    ByRule,
    ConfirmedRun,
    HazardLevel,
    SiteMethod,
    SiteMotion,
    SiteResult,
    SiteRun,
)
from fem.site_check.rule import RunGroup, both_directions, groups_of
from fem.site_check.tables import MotionsTable

BOTH = (
    "Both: the slips of the two elevations as vectors, the larger of 100 % + 30 % and 30 % + 100 % (EN 1998-1:2004, "
    "4.3.3.5.1 (3), of effects). Friction is not linear: an estimate, no part of the rule."
)
MARGIN = (
    "The margin is the factor on the set, not the ratio: a body may return from beyond its angle, and a body that a "
    "weaker motion overturns may stand under a stronger one. Near the boundary a single run may come out otherwise "
    "with other numerics, so read the factor as a magnitude."
)
DEFAULT_SEED = MotionsTable().seed
SINGLE = (
    "The peak of a single motion is chaotic: with other numerics the same motion may turn a body half or twice as far. "
    "Two figures are given; what the rule makes of all of them is steadier, and its range is on the first sheet."
)
symbols = partial(formula_markup, prose=True)
FURTHER = [key for key in keys_of(Place.RUNS) if key != TURNED]


class RunPair(NamedTuple):
    """The runs of one motion: with the vertical upward, and the other sign."""

    motion: int
    group: RunGroup
    runs: tuple[SiteRun, ...]


class DrawnMotion(NamedTuple):
    """A motion with its figure; without one beyond the first."""

    motion: SiteMotion
    svg: str | None


@dataclass(frozen=True, kw_only=True)
class SiteView:
    """A verification as its page shows it."""

    result: SiteResult

    @cached_property
    def groups(self) -> list[RunGroup]:
        """The runs of the set, by what they have in common."""
        return groups_of(run for run in self.result.runs if run.stage == "set")

    @property
    def governing(self) -> RunGroup | None:
        """The group of the run that governs."""
        run = self.result.result.governing
        return next((group for group in self.groups if run in group.runs), None)

    @property
    def signs(self) -> list[int]:
        """Signs of the vertical motion that were computed."""
        return sorted({run.vertical_sign for run in self.result.runs}, reverse=True) or [1]


def figure(svg: str, name: str, label: str) -> html.Figure:
    """A drawing of the page; its name keeps the ids apart."""
    return html.Figure(svg_element(svg, label=name.replace("-", " "), prefix=name), label)


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
        count = f"All {resting}" if not moving else f"The other {resting} of {len(view.groups)}"
        blocks.append(f"{count} combinations of weight, elevation and friction are at rest in every motion.")
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
    if result.result.hazard:
        blocks += [html.Heading("The rate of overturning, level by level"), *_levels(result.result.hazard)]
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


def _run_columns(
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
        *_run_columns(0, "outcome", "rotation ratio"),
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


def _levels(rates: AnnualRates) -> list[html.Block]:
    """The counts at each level of the motion, and what of the rate arises up to it."""
    unit = "m/s²" if rates.measure == ACCELERATION else "m/s"

    def interval(level: HazardLevel) -> str:
        return f"{' to '.join(short(end, 100, 2) for end in level.interval)} %" if level.interval else ABSENT

    def share(level: HazardLevel) -> str:
        whole = rates.overturning_per_year
        return f"{short(level.overturning_per_year / whole, 100, 2)} %" if whole else ABSENT

    columns: list[html.Column[HazardLevel]] = [
        html.Column(f"level [{unit}]", lambda level: short(level.strength, figures=3), html.NUMBER),
        html.Column("exceeded [1/year]", lambda level: f"{level.rate_per_year:.2g}", html.NUMBER),
        html.Column("overturned", lambda level: f"{level.overturned} of {level.motions}", html.NUMBER),
        html.Column("95 % interval", interval, html.NUMBER),
        html.Column("slid too far", lambda level: f"{level.slipped} of {level.motions}", html.NUMBER),
        html.Column("rate up to it [1/year]", lambda level: f"{level.overturning_per_year:.2g}", html.NUMBER),
        html.Column("of the whole", share, html.NUMBER),
    ]
    return [
        html.table_of("the rate of overturning, level by level", columns, rates.levels, look="runs"),
        html.Note(
            typeset(
                "The rate up to a level arises from the one before it; up to the first, from the first movement of a "
                f"rigid body. Beyond the strongest level {rates.beyond_per_year:.2g} per year arise, if the share that "
                "overturns stays as counted there. A level is exceeded as often as the user's hazard says; the rates "
                "hold for that hazard spread by the scatter."
            )
        ),
    ]


def methods_section(view: SiteView) -> html.PageSection:
    """The simplified methods side by side, and what each says of the strength."""
    result = view.result
    checked = [row for row in result.methods if row.checked]
    if not checked:
        return html.section("", "methods")
    governing = result.result.governing
    mass = governing.mass if governing else result.bodies[0].mass
    drawn = [row for row in checked if row.mass == mass and not row.beyond]
    capacities = (
        draw_methods(drawn, result.result, mass) if any(row.factor is not None for row in drawn) else ""
    )
    action = "the same action as the runs"
    if result.floor and result.floor.z_over_h:
        action = (
            "the motions of the floor, as the runs do, but for those that name a_g S, which is of the ground: "
            "Eq. (4.25) raises it to the floor, the plateau does not"
        )
    return html.section(
        "Rules of thumb side by side",
        "methods",
        html.joined(
            f"All use the least friction of the range and {action}. The last columns give what the rule counts, and "
            "whether the method is conservative against that. A median is what half of such motions or bodies exceed, "
            "so it gets no verdict; nor does a rule out of its range, in grey. Formulas and numbers are in the ",
            html.link("static calculation", "sheet"),
            ".",
        ),
        _methods_table("rules of thumb side by side", checked),
        *([figure(capacities, "methods-0", "capacity over strength by each method")] if capacities else []),
    )


def unchecked_section(view: SiteView) -> html.PageSection:
    """The simplified methods whose sources were not seen, on a sheet of their own."""
    rows = [row for row in view.result.methods if not row.checked]
    if not rows:
        return html.section("", "unchecked")
    return html.section(
        "Further rules of thumb, not checked against their texts",
        "unchecked",
        html.Paragraph(
            "They are no part of the verification: take them as a hint, or look up the source.", "tight"
        ),
        _methods_table("rules of thumb that were not checked", rows),
        look="break",
    )


def _methods_table(caption: str, rows: Sequence[SiteMethod]) -> html.Table:
    def compared(row: SiteMethod) -> html.Cell:
        if row.beyond:
            return html.Cell(f"out of range: {row.beyond}", "note")
        if row.median:
            return html.Cell("a median: no verdict", "note")
        return html.Cell(row.compared or ABSENT, "doubt" if row.compared == "not conservative" else "")

    columns: list[html.Column[SiteMethod]] = [
        html.Column("method", lambda row: symbols(row.name)),
        html.Column("check", lambda row: row.quantity),
        html.Column("weight", lambda row: row.mass + elevation_in_words(row.elevation)),
        html.Column("utilisation", lambda row: _utilisation(row, 3), html.NUMBER),
        html.Column("conclusion", lambda row: row.says),
        html.Column("the rule counts", lambda row: html.Cell(Markup.escape(row.found), "wide")),
        html.Column("the method is", compared),
        html.Column("source", lambda row: html.Cell(Markup.escape(row.source), "note")),
    ]
    return html.table_of(
        caption,
        columns,
        merged_methods(rows),
        row_look=lambda row: "outside" if row.beyond else "",
        look="methods",
    )


def sheet_section(view: SiteView) -> html.PageSection:
    """Appendix C: the simplified methods with their numbers."""
    if not view.result.methods:
        return html.section("", "sheet")

    def name(row: SiteMethod) -> str:
        return html.joined(
            symbols(row.name), f", {row.quantity}, {row.mass}{elevation_in_words(row.elevation)}"
        )

    def demand(row: SiteMethod) -> str:
        return "none" if row.demand is None else quantity(row.demand, row.unit)

    columns: list[html.Column[SiteMethod]] = [
        html.Column("method", name),
        html.Column("formula", lambda row: formula_markup(row.formula)),
        html.Column("with numbers", lambda row: symbols(row.numbers)),
        html.Column("demand", demand, html.NUMBER),
        html.Column("capacity", lambda row: quantity(row.capacity, row.unit), html.NUMBER),
        html.Column("utilisation", lambda row: _utilisation(row, 4), html.NUMBER),
        html.Column("valid for", lambda row: html.Cell(Markup.escape(row.validity), "note")),
    ]
    table = html.table_of("static calculation with numbers", columns, view.result.methods, look="methods")
    return html.section("Appendix C: static calculation with numbers", "sheet", table)


def _utilisation(row: SiteMethod, figures: int) -> str:
    return "∞" if row.utilisation is None else number(row.utilisation, figures=figures)


def merged_methods(methods: Sequence[SiteMethod]) -> list[SiteMethod]:
    """The methods side by side; weights of which a method says the same, to three figures, share a row."""
    merged: dict[tuple[str, ...], list[SiteMethod]] = {}
    for method in methods:
        key = (
            method.name,
            method.quantity,
            method.elevation,
            number(method.utilisation, figures=3),
            method.says,
        )
        merged.setdefault((*key, method.compared), []).append(method)
    rows = []
    for same in merged.values():
        findings = {method.mass: method.found for method in same}
        alike = len(set(findings.values())) == 1
        words = same[0].found if alike else "; ".join(f"{mass}: {findings[mass]}" for mass in findings)
        rows.append(replace(same[0], mass=", ".join(method.mass for method in same), found=words))
    return rows


def motions_section(motions: Sequence[DrawnMotion]) -> html.PageSection:
    """Appendix A: the motions in numbers and curves."""
    columns: list[html.Column[SiteMotion]] = [
        html.Column("motion", lambda motion: str(motion.number), html.NUMBER),
        html.Column("origin", lambda motion: Markup.escape(motion.origin)),
        html.Column("scale", lambda motion: short(motion.scale), html.NUMBER),
        *html.figure_columns(declared_in(SiteMotion)),
    ]
    curves = [
        figure(svg, f"motion-{motion.number}", f"motion {motion.number}") for motion, svg in motions if svg
    ]
    more = len(motions) - len(curves)
    return html.section(
        "Appendix A: the motions",
        "motions",
        html.table_of("the motions", columns, [motion for motion, _ in motions], look="runs"),
        html.Group("drawn", curves),
        *([html.Note(f"The curves of the other {more} motions are in their files.")] if more else []),
        look="break",
    )


def every_run_section(view: SiteView) -> html.PageSection:
    """Appendix B: a row for each motion at each weight and friction."""
    every = [pair for group in view.groups for pair in pairs_of(group)]
    pairs = [pair for pair in every if any(run.outcome != Outcome.REST for run in pair.runs)]
    if not every:
        return html.section("", "runs")
    period: html.Column[RunPair] = html.Column(
        symbols("T_1 [s]"), lambda pair: short(pair.group.first.building_period_s), html.NUMBER
    )
    columns: list[html.Column[RunPair]] = [
        html.Column("motion", lambda pair: str(pair.motion), html.NUMBER),
        html.Column(
            "weight", lambda pair: pair.group.first.mass + elevation_in_words(pair.group.first.elevation)
        ),
        *([period] if view.result.floor and view.result.floor.building_periods_s else []),
        html.Column("friction", lambda pair: friction(pair.group.first), html.NUMBER),
        *(
            column
            for k, sign in enumerate(view.signs)
            for column in _run_columns(k, sign_in_words(sign), "ratio", [SLIPPED])
        ),
    ]
    blocks: list[html.Block] = [
        html.Note(f"{SINGLE} Residual slips, velocities and uplifts are in runs.csv.")
    ]
    if left := len(every) - len(pairs):
        blocks.append(
            f"{left} of {len(every)} rows are left out, in which the container rests; runs.csv has them."
        )
    if pairs:
        blocks.append(html.table_of("every run", columns, pairs, look="runs long", most=len(pairs)))
    return html.section("Appendix B: every run", "runs", *blocks)


def repeat_section(view: SiteView, copies: Sequence[tuple[str, str]]) -> html.PageSection:
    """Appendix D: seeds, hashes and files to compute it again."""
    origin, motions = view.result.provenance, view.result.set
    rows: list[tuple[str, str]] = [
        ("command", html.code(origin.command)),
        (
            "program",
            f"sources {view.result.program}, {origin.system}" if origin.system else view.result.program,
        ),
    ]
    if motions.seed is not None:
        lasts = quantity(motions.stationary_s, "s")
        chosen = "the default" if motions.seed == DEFAULT_SEED else "chosen by the user"
        rows.append(("seed", f"{motions.seed} ({chosen}), {motions.source}, stationary part {lasts}"))
    rows += [
        ("hash of the site file", html.code(origin.site_hash)),
        ("hash of the case", html.code(origin.case_hash)),
        *((f"motion {motion.number}", _hashes(motion)) for motion in motions.motions),
        ("versions", ", ".join(f"{name} {version}" for name, version in origin.versions)),
    ]
    if origin.wall_s:
        rows.append(("computed in", quantity(origin.wall_s, "s", figures=3)))
    files = [block for name, text in copies for block in (html.Heading(name), html.Listing(text))]
    return html.section("Appendix D: how to repeat it", "again", html.Pairs(rows, look="asked"), *files)


def _hashes(motion: SiteMotion) -> Markup:
    files = zip(motion.files, motion.sha256, strict=False)
    return Markup(" · ").join(html.joined(f"{file} ", html.code(digest)) for file, digest in files)


def elevation_in_words(elevation: str) -> str:
    """The elevation behind a name, unless it is that which a case file shows."""
    return "" if elevation == "width" else f", {elevation}"


def sign_in_words(sign: int) -> str:
    """How the vertical motion was taken."""
    return "vertical as it is" if sign > 0 else "vertical reversed" if sign < 0 else "no vertical"


def pairs_of(group: RunGroup) -> list[RunPair]:
    """The runs of a group, motion by motion, the sign + first."""
    return [
        RunPair(
            motion,
            group,
            tuple(
                sorted(
                    (run for run in group.runs if run.motion == motion), key=lambda run: -run.vertical_sign
                )
            ),
        )
        for motion in sorted({run.motion for run in group.runs})
    ]


def two_figures(figure: Shown, value: float | None) -> str:
    """A figure as far as it is known."""
    return ABSENT if value is None else typeset(figure.unit.text(value, figures=2, bare=True))


def friction(run: SiteRun) -> str:
    """Both coefficients of a run."""
    return f"{short(run.mu_static, figures=3)} / {short(run.mu_kinetic, figures=3)}"
