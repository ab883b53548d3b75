"""The report of a run: one page from its folder, verdict first, with everything needed to check it.

`run.html.j2` is the page; this module hands it the run, as `RunView`, and the words for it.
"""

import datetime as dt
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from markupsafe import Markup

from contact.reference.event_driven import EventError
from fem.assessment.code_note import code_note
from fem.assessment.drawn_links import drawn_links
from fem.assessment.floor_words import drawn_level, floor_rows
from fem.assessment.joint_tables import joints_note, unbolted
from fem.assessment.loose_boxes import BOXES_NOTE, box_rows, largest_joint_slip
from fem.assessment.ranges import impact_note, largest_ratio, largest_rotation, largest_slip, of_band
from fem.assessment.rigid_check import check_against_rigid_block
from fem.assessment.rule_or_run import governing
from fem.assessment.summary import (
    MARGIN_NOTE,
    band_note,
    lacks_margin,
    outcome_sentence,
    result_rows,
    to_compare,
)
from fem.assessment.sureness import SURE, numerical
from fem.case.case import Case
from fem.case.tables.unknown_inputs import WORDS
from fem.figures.cache import drawings_of
from fem.figures.style import Drawing
from fem.html.page import Page, Signature, html_of, svg_element
from fem.html.units import number, quantity, short, typeset
from fem.model.model import Model, build_model
from fem.report.animation import (
    COLOURS,
    Animation,
    animation_of,
    colour_scale,
    exaggeration,
    exaggerations,
    player_data,
)
from fem.report.comparison import Compared, assumptions, case_rows, compared_rows, exclusions
from fem.report.sketch import sketch
from fem.report.static_sheet import static_sheet
from fem.results.errors import FolderError
from fem.results.fields import Fields
from fem.results.history import History
from fem.results.kinds import RUN
from fem.results.outcome import Outcome
from fem.results.reader import OpenedRun
from fem.results.run_result import Energy, Numerics, RigidCheckResult, RunResult, Verdict, to_overturn
from fem.solid.modes import FEW, elastic_mode_table

#: figures beside the animation, in the order of reading; the others have their own sections
MOTION = ("rotation", "slip", "base_motion", "spectrum", "uplift", "forces", "phase_portrait", "energy")
SHORT_MOTION = ("rotation", "slip")
#: terms of the energy balance: fields of the result, and words
ENERGIES = {
    "reference_J": "to overturn",
    "base_work_J": "work of the floor",
    "friction_J": "friction",
    "contact_damping_J": "contact damping",
    "material_damping_J": "material damping",
    "crushing_J": "crushing of the floor",
    "impact_J": "restitution asked of the impacts",
    "numerical_J": "error at the end, > 0 lost",
}
#: what the template names besides the run
SAID: dict[str, Any] = {
    "BOXES_NOTE": BOXES_NOTE,
    "DEGREES": math.degrees(1.0),
    "MARGIN_NOTE": MARGIN_NOTE,
    "assumptions": assumptions,
    "band_note": band_note,
    "case_rows": case_rows,
    "exclusions": exclusions,
    "governing": governing,
    "impact_note": impact_note,
    "joints_note": joints_note,
    "lacks_margin": lacks_margin,
    "largest_joint_slip": largest_joint_slip,
    "largest_ratio": largest_ratio,
    "largest_rotation": largest_rotation,
    "largest_slip": largest_slip,
    "of_band": of_band,
    "static_sheet": static_sheet,
    "unbolted": unbolted,
}


@dataclass(frozen=True, kw_only=True)
class RunView:
    """A run as its page shows it."""

    run: OpenedRun
    model: Model
    history: History
    animation: Animation
    drawn: Mapping[str, Drawing]
    brief: bool  #: of three printed sheets at most

    @property
    def case(self) -> Case:
        """The case, resolved."""
        return self.run.case

    @property
    def result(self) -> RunResult:
        """What `run.json` holds."""
        return self.run.typed_result

    @property
    def verdict(self) -> Verdict:
        """What the run found; empty before there is anything."""
        return self.result.verdict or Verdict()

    @property
    def finished(self) -> bool:
        """Whether nothing is left to compute."""
        return self.run.status in RUN.finished

    @property
    def standing(self) -> str:
        """How the verdict is coloured: what the run found, never whether that is safe."""
        verdict = self.verdict
        if not self.finished:
            return "open"
        if verdict.outcome == Outcome.OVERTURNED:
            return "fell"
        unsure = verdict.outcome == Outcome.INVALID or (verdict.band is not None and verdict.band.unsure)
        return "unsure" if unsure else "stood"

    @property
    def sentences(self) -> tuple[str, str]:
        """The verdict in one sentence, and what follows it."""
        first, _, further = outcome_sentence(self.result).partition(". ")
        return (f"{first}." if further else first), further

    @property
    def sure(self) -> tuple[str, str]:
        """How sure the outcome is, and why; without a reason: nothing was tried."""
        verdict = self.verdict
        if (band := verdict.band) is None:
            return (verdict.sure, "by the static rule alone") if verdict.sure else ("not computed", "")
        named = ", ".join(WORDS.get(key, key) for key in verdict.decided_by)
        decided = f"; decided by {named}" if named else ""
        known = verdict.sure or ("unsure" if band.unsure else "same outcome")
        if verdict.sure == SURE and all(map(numerical, band.members[1:])):
            known = "no input varied"
        return known, f"{', '.join(band.outcomes)}{decided}"

    @property
    def sketch(self) -> Markup:
        """The container in elevation."""
        static, case = self.model.static, self.case
        peak = static.own_motion.sliding.demand * case.gravity_m_s2 / static.weight - static.downhill
        return sketch(
            case,
            centroid=static.centroid,
            peak_acceleration=peak,
            peak_vertical=static.peak_vertical_acceleration,
        )

    @property
    def floor(self) -> list[tuple[str, str]]:
        """What the floor amounts to: name and value."""
        return [(name, typeset(value)) for name, value in floor_rows(self.result.floor)]

    @property
    def found(self) -> list[tuple[str, str]]:
        """All figures of the run, but those of its floor: name and value."""
        of_floor = dict(self.floor)
        return [(name, typeset(value)) for name, value in result_rows(self.result) if name not in of_floor]

    @property
    def code(self) -> str:
        """What is to be known of the code's rows; empty where there are none."""
        return code_note(self.model.static.to_result())

    @cached_property
    def compared(self) -> list[Compared]:
        """The static rules beside the run."""
        return compared_rows(self.model.static, to_compare(self.result))

    @cached_property
    def boxes(self) -> Sequence[Sequence[str]]:
        """A row for each box of a loose stack."""
        return box_rows(self.result)

    @property
    def curves(self) -> list[str]:
        """Names of the figures beside the animation."""
        moves = self.case.motion.kind != "none" or self.case.has_vertical
        names = SHORT_MOTION if self.brief else MOTION
        return [name for name in names if name != "base_motion" or moves]

    @cached_property
    def played(self) -> dict[str, Any]:
        """What the animation plays; empty where there is none."""
        if len(self.history) < 2 or self.brief:
            return {}
        return player_data(self.animation, self.history, model=self.model)

    @property
    def exaggeration(self) -> float:
        """Factor on the elastic displacement as first shown."""
        return exaggeration(self.animation, self.model.container.mesh.height)

    @property
    def exaggerations(self) -> list[float]:
        """Factors to choose from."""
        return exaggerations(self.animation, self.model.container.mesh.height)

    @property
    def colours(self) -> list[str]:
        """Of the stress."""
        return colour_scale("YlGnBu", COLOURS)

    @property
    def level(self) -> str:
        """A note that a sloping floor is drawn level; empty for a level one."""
        return drawn_level(self.case.floor.slope_percent)

    def svg(self, name: str) -> Markup:
        """A drawing by its name."""
        drawing = self.drawn[name]
        return svg_element(drawing.svg, label=drawing.title, prefix=drawing.name)

    @cached_property
    def modes(self) -> Sequence[Mapping[str, float]]:
        """The elastic modes of the container, also of a rigid run."""
        return elastic_mode_table(self.model.container.lowest_modes(FEW))

    @cached_property
    def check(self) -> RigidCheckResult | None:
        """The comparison with the analytic block: that of the run, or else made now; None of an unfinished run."""
        result = self.result
        if result.rigid_check is not None:
            return result.rigid_check
        if not self.finished or result.verdict is None or len(self.history) < 2:
            return None
        try:
            return check_against_rigid_block(self.model, self.history, result.verdict).result
        except (ValueError, EventError) as error:
            return RigidCheckResult(reasons=(str(error),))

    @property
    def stepping(self) -> list[tuple[str, str]]:
        """How the run was stepped: name and value."""
        return _stepping(self.case, self.result.numerics or Numerics())

    @property
    def energies(self) -> list[tuple[str, str]]:
        """The energy balance at the end: name and value."""
        energy, row = self.result.energy or Energy(), bool(self.case.neighbour)
        absent = {
            "crushing_J": not self.case.floor.is_slab,
            "impact_J": not self.case.states_restitution,
        }
        error = f"{number(energy.closure_error, figures=3)} of the energy {to_overturn(row)}"
        rows = [
            (to_overturn(row) if key == "reference_J" else words, quantity(getattr(energy, key), "J"))
            for key, words in ENERGIES.items()
            if not absent.get(key, False)
        ]
        return [*rows, ("largest error", error)]

    @property
    def computed(self) -> str:
        """When."""
        return f"{dt.datetime.fromtimestamp(self.run.place.result.stat().st_mtime):%Y-%m-%d %H:%M}"

    @property
    def resolved(self) -> str:
        """The case with every default."""
        return self.run.place.resolved.read_text(encoding="utf-8")


def run_report(
    run: OpenedRun,
    *,
    signature: Signature | None = None,
    brief: bool = False,
    message: Callable[[str], None] = lambda text: None,
) -> str:
    """The page, as the text of an HTML file.

    Args:
        run: opened; finished or not.
        signature: author, checker, revision; an unfinished run is not signed.
        brief: three printed pages at most: answer, inputs, static rule and run, rotation and slip, limits.
        message: receives a sentence for the user where something is missing.

    Raises:
        FolderError: the folder does not hold what a report needs.
        CaseError, MeshError: the resolved case in it cannot be read.
    """
    if run.typed_result.static is None:
        raise FolderError(f"{run.place.result}: the run has not begun; run the case, then report it")
    model = build_model(run.case)
    view = RunView(
        run=run,
        model=model,
        history=_history(run, message),
        animation=animation_of(
            model, _fields(run, message), drawn_links(run.case, _broken(run.typed_result))
        ),
        drawn=drawings_of(run, model.container),
        brief=brief,
    )
    page = Page(
        kind=f"{'Short report' if brief else 'Report'} of a run",
        title=view.case.title or run.name,
        name=run.name,
        hash=str(view.result.case_hash or ""),
        signature=(signature or Signature()).completed(view.case.named) if view.finished else None,
        scripts=["player.js"] if view.played else [],
        data={"run": view.played} if view.played else {},
    )
    return html_of(page, "run.html.j2", view=view, **SAID)


def _broken(result: RunResult) -> list[float]:
    """When stops and ties broke, in the order of the case; empty where none was computed [s]."""
    links = (*(result.stops or ()), *(result.ties or ()))
    return [math.inf if link.broken_at_s is None else link.broken_at_s for link in links]


def _stepping(case: Case, numerics: Numerics) -> list[tuple[str, str]]:
    """How the run was stepped: name and value."""
    solver, least = case.solver, numerics.smallest_step_s
    tiny = least is not None and 0.0 < least < 1e-7
    smallest = quantity(least, "ns", 1e9, 3) if tiny else quantity(least, "µs", 1e6, 3)
    scheme = f"spectral radius {short(solver.spectral_radius)}"
    if solver.scheme == "newmark":
        scheme = f"β {short(solver.newmark_beta)}, γ {short(solver.newmark_gamma)}"
    penalty, penetrations = (
        numerics.normal_penalty_Pa_m,
        (numerics.static_penetration_m, numerics.max_penetration_m),
    )
    return [
        ("unknowns, contact nodes", f"{numerics.unknowns}, {numerics.contact_nodes}"),
        ("scheme", f"{solver.scheme}, {scheme}"),
        ("steps, rejected", f"{numerics.steps}, {numerics.rejected}"),
        ("step, smallest to largest", f"{smallest} to {quantity(numerics.largest_step_s, 'ms', 1000, 3)}"),
        ("element size, order", f"{quantity(solver.element_size_m, 'mm', 1000, 3)}, {solver.order}"),
        *([("contact penalty", quantity(penalty, "GPa/m", 1e-9))] if penalty is not None else []),
        (
            "penetration, static and largest",
            ", ".join(quantity(penetration, "µm", 1e6, 3) for penetration in penetrations),
        ),
    ]


def _history(run: OpenedRun, message: Callable[[str], None]) -> History:
    try:
        return run.history
    except FolderError as error:
        if run.status in RUN.finished:
            raise
        message(f"{error}; the report is made without it")
        return History.empty()


def _fields(run: OpenedRun, message: Callable[[str], None]) -> Fields | None:
    try:
        return run.fields
    except FolderError as error:
        message(f"the animation shows no stresses: {error}")
        return None
