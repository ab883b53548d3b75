"""The appendices of the page of a site: motions, every run, how to repeat it."""

from collections.abc import Sequence
from typing import NamedTuple

from markupsafe import Markup

from fem.html import sections as html
from fem.html.units import quantity, short
from fem.results.figures import SLIPPED, declared_in
from fem.results.outcome import Outcome
from fem.site_check.page.runs_section import SINGLE, run_columns
from fem.site_check.page.view import (
    RunPair,
    SiteView,
    elevation_in_words,
    figure,
    friction,
    pairs_of,
    sign_in_words,
    symbols,
)
from fem.site_check.result import SiteMotion
from fem.site_check.tables import MotionsTable

DEFAULT_SEED = MotionsTable().seed


class DrawnMotion(NamedTuple):
    """A motion with its figure; without one beyond the first."""

    motion: SiteMotion
    svg: str | None


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
            for column in run_columns(k, sign_in_words(sign), "ratio", [SLIPPED])
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
