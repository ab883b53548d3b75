"""The page of a verification at a site: the answer first, then its basis, then all numbers."""

import csv
from dataclasses import asdict
from pathlib import Path

import numpy as np

from fem.html import sections as html
from fem.html.page import Page, Signature, html_of
from fem.results.errors import FolderError
from fem.results.kinds import SITE
from fem.runtime.arrays import FloatArray
from fem.site_check.page.answer_section import answer_section
from fem.site_check.page.appendices import DrawnMotion, every_run_section, motions_section, repeat_section
from fem.site_check.page.figures import draw_motion
from fem.site_check.page.inputs_section import inputs_section, set_section, spectra_section
from fem.site_check.page.methods_sections import methods_section, sheet_section, unchecked_section
from fem.site_check.page.runs_section import runs_section
from fem.site_check.page.view import SiteView
from fem.site_check.result import RESULT_FILE, SiteMotion, SiteResult
from fem.study.driver import read_study

COPIES = ("site.toml", "container.toml")  #: in the folder, printed on the page
CODE = (
    "EN 1998-1:2004, 4.4.2.4 (2), for building structures in special cases and applied here by analogy, allows the "
    "equilibrium to be verified by geometrically non-linear methods with the action of 3.2.3.1. It names no number of "
    "motions, no limit of rotation or slip and no partial factor: worst or mean follow 4.3.3.4.3 (3), by analogy, the "
    "limits are those of the user. That any overturning means not fulfilled, the limit of a single rotation, and the "
    "largest slip against the clearance are rules of this program."
)
SIGNING = ("prepared", "checked", "approved")
MOST_DRAWN = 30  #: motions whose curves are on the page
NOT_COVERED = (
    "rocking under two horizontal components at once, torsion, motion out of the plane",
    "failure of the joints of a stack, sloshing of the content, buckling",
    "strength and stiffness of floor and soil",
    "neighbouring containers and walls, ropes, stops",
    "partial factors on friction: its range is computed instead",
)


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
    signing = SIGNING if result.state == "finished" else ()
    view, document = SiteView(result=result), asdict(result.document or Signature())
    motions = [
        DrawnMotion(motion, motion_figure(folder, motion, result) if motion.number <= MOST_DRAWN else None)
        for motion in (() if brief else result.set.motions)
    ]
    copies = [(name, _text(folder / name)) for name in COPIES if (folder / name).is_file()]
    page = Page(
        kind=f"Verification of an unanchored container{', short' if brief else ''}",
        title=result.title or folder.name,
        name=folder.name,
        hash=result.provenance.site_hash,
        signature=(signature or Signature()).completed(document) if signing else None,
        sections=[
            html.Group(
                "first site",
                [
                    answer_section(result),
                    inputs_section(result),
                    set_section(result),
                    html.section(
                        "Not covered", "not-covered", html.Paragraph(f"{'; '.join(NOT_COVERED)}.", "tight")
                    ),
                    *(
                        [html.Group("sign", [f"{who}: name, date, signature" for who in signing])]
                        if signing
                        else []
                    ),
                ],
            ),
            html.section("The rule and the code", "rule", html.Paragraph(CODE, "tight")),
            runs_section(view, brief=brief),
            *(
                []
                if brief
                else [
                    spectra_section(result),
                    methods_section(view),
                    unchecked_section(view),
                    motions_section(motions),
                    every_run_section(view),
                    sheet_section(view),
                    repeat_section(view, copies),
                ]
            ),
        ],
    )
    return html_of(page)


def motion_figure(folder: Path, motion: SiteMotion, result: SiteResult) -> str:
    """The figure of a motion, from its files."""
    curves = {name[-5:]: _curve(folder / name) for name in motion.files if name.endswith(".csv")}
    if "h.csv" not in curves:
        raise FolderError(f"{folder / RESULT_FILE}: motion {motion.number} has no curve; compute it again")
    times, horizontal = curves["h.csv"]
    vertical = curves["v.csv"][1] if "v.csv" in curves else None
    return draw_motion(motion, result.action, times, horizontal, vertical)


def _curve(path: Path) -> tuple[FloatArray, FloatArray]:
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))[1:]
        values = np.array(rows, dtype=np.float64)
    except (OSError, ValueError) as error:
        raise FolderError(f"{path} cannot be read ({error}); compute it again") from None
    return values[:, 0], values[:, 1]


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise FolderError(f"{path} cannot be read ({error})") from None
