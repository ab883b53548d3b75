"""The page of a verification at a site, set by `site.html.j2`: what its template is handed."""

import csv
from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from fem.html.page import Page, Signature, html_of
from fem.html.units import ABSENT, number, short, typeset
from fem.results.errors import FolderError
from fem.results.figures import FIGURES, TURNED, Place, declared_in, keys_of
from fem.results.kinds import SITE
from fem.results.outcome import Outcome
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import read_text
from fem.site import figures
from fem.site.answer import ended, span_in_words, unit_of
from fem.site.result import BY_RULE, RESULT_FILE, RuleRange, SiteAnswer, SiteMethod, SiteMotion, SiteResult
from fem.site.rule import groups_of
from fem.site.tables import MotionsTable
from fem.study.driver import read_study

COPIES = ("site.toml", "container.toml")  #: in the folder, printed on the page
MOST_DRAWN = 30  #: motions whose curves are on the page


def site_report(
    folder: Path,
    result: SiteResult | None = None,
    *,
    signature: Signature | None = None,
    brief: bool = False,
) -> str:
    """The page, as the text of an HTML file; there is nothing to sign before the verification is finished.

    Args:
        folder: of the verification.
        result: of it; None: as its folder holds it.
        signature: author, checker, revision.
        brief: two printed sheets: that which is signed, and what the runs found.

    Raises:
        FolderError: the folder holds no result of `assess`, or it is damaged.
    """
    result = result or read_study(folder, SITE, SiteResult)
    document = asdict(result.document or Signature())
    page = Page(
        kind=f"Verification of an unanchored container{', short' if brief else ''}",
        title=result.title or folder.name,
        name=folder.name,
        hash=result.provenance.site_hash,
        signature=(signature or Signature()).completed(document) if result.to_be_signed else None,
    )
    return html_of(page, "site.html.j2", **shown(result, folder, brief=brief))


def shown(result: SiteResult, folder: Path, *, brief: bool = False) -> dict[str, Any]:
    """What the template names beside the result: its runs in groups, methods in rows, drawings, words of numbers."""
    answer, groups = result.result, groups_of(run for run in result.runs if run.stage == "set")
    governing = next((group for group in groups if answer.governing in group.runs), None)
    every = [(group, motion, runs) for group in groups for motion, runs in group.by_motion]
    moving = [row for row in every if any(run.outcome != Outcome.REST for run in row[2])]
    mass = answer.governing.mass if answer.governing else result.bodies[0].mass
    drawn = [row for row in result.methods if row.mass == mass and not row.beyond]
    tried = [point.factor for point in answer.scan]
    return {
        "result": result,
        "brief": brief,
        "standard": "EN 1998-1:2004",
        "FIGURES": FIGURES,
        "BY_RULE": BY_RULE,
        "of_motions": declared_in(SiteMotion),
        "further_keys": [key for key in keys_of(Place.RUNS) if key != TURNED],
        "confirmed_keys": keys_of(Place.KEY),
        "groups": groups,
        "governing": governing,
        "signs": sorted({run.vertical_sign for run in result.runs}, reverse=True) or [1],
        "every": {"moving": moving, "rest": len(every) - len(moving)},
        "merged_methods": merged_methods(result.methods),
        "drawn_methods": drawn if any(row.factor is not None for row in drawn) else [],
        "drawn_motions": [motion for motion in result.set.motions if motion.number <= MOST_DRAWN],
        "ended": ended(answer.confirmed),
        "tried": f"factors {short(tried[0])} to {short(tried[-1])} tried"
        if tried
        else "other factors not computed",
        "ranged": partial(ranged, answer),
        "copies": [(name, _text(folder / name)) for name in COPIES if (folder / name).is_file()],
        "default_seed": MotionsTable().seed,
        "figures": figures,
        "motion_figure": partial(motion_figure, folder, result),
    }


def ranged(answer: SiteAnswer, key: str) -> str:
    """A figure of the rule, with the range that it has over the repetitions."""
    if answer[key] is None:
        return ABSENT
    text, ends = unit_of(key).text(answer[key], figures=2, bare=True), (answer.rule_range or RuleRange())[key]
    between = span_in_words(key, ends[0], ends[-1]) if ends else ""
    return typeset(f"{text} ({between})" if " to " in between else text)


def merged_methods(methods: Sequence[SiteMethod]) -> list[SiteMethod]:
    """The methods side by side; weights of which a method says the same, to three figures, share a row."""
    merged: dict[tuple[str, ...], list[SiteMethod]] = {}
    for method in methods:
        used = number(method.utilisation, figures=3)
        key = method.name, method.quantity, method.elevation, used, method.says, method.compared
        merged.setdefault(key, []).append(method)
    rows = []
    for same in merged.values():
        findings = {method.mass: method.found for method in same}
        alike = len(set(findings.values())) == 1
        words = same[0].found if alike else "; ".join(f"{mass}: {findings[mass]}" for mass in findings)
        rows.append(replace(same[0], mass=", ".join(method.mass for method in same), found=words))
    return rows


def motion_figure(folder: Path, result: SiteResult, motion: SiteMotion) -> str:
    """The figure of a motion, from its files."""
    curves = {name[-5:]: _curve(folder / name) for name in motion.files if name.endswith(".csv")}
    if "h.csv" not in curves:
        raise FolderError(f"{folder / RESULT_FILE}: motion {motion.number} has no curve; compute it again")
    times, horizontal = curves["h.csv"]
    vertical = curves["v.csv"][1] if "v.csv" in curves else None
    return figures.draw_motion(motion, result.action, times, horizontal, vertical)


def _curve(path: Path) -> tuple[FloatArray, FloatArray]:
    try:
        values = np.array(list(csv.reader(read_text(path).splitlines()))[1:], dtype=np.float64)
    except (OSError, ValueError) as error:
        raise FolderError(f"{path} cannot be read ({error}); compute it again") from None
    return values[:, 0], values[:, 1]


def _text(path: Path) -> str:
    try:
        return read_text(path)
    except (OSError, ValueError) as error:
        raise FolderError(f"{path} cannot be read ({error})") from None
