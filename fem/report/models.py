"""The same container and motion by four models: analytic block, rigid body, elastic on rigid ground, and on a slab.

Knoedel and Hrabowski drop the rigid body assumption (abstract, section 6); what that changes stands side by side here.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from fem.case.case import Case, case_hash, load_case
from fem.model.model import build_model
from fem.results.kinds import RUN
from fem.results.outcome import Outcome
from fem.results.reader import OpenedRun
from fem.results.run_result import Verdict
from fem.run.compute import compute, has_analytic_block
from fem.run.rigid_check import analytic_block
from fem.runtime.units import MILLIMETRES, PERCENT, RATIO

RIGID_GROUND, CONCRETE = {"floor.kind": "rigid"}, {"floor.kind": "slab", "floor.preset": "concrete C25/30"}
SLIDES_M = 1e-3  #: slip from which that is said
ALIKE = 0.1  #: rotations that differ by less agree, over the larger


@dataclass(frozen=True, kw_only=True)
class OfModel:
    """What one model finds."""

    model: str
    found: Verdict  #: without an outcome: it left the floor, which no formula follows
    own: bool = False  #: it is the run whose page this is
    needs: float | None = None  #: friction with which the analytic block rocks and does not slide

    @property
    def did(self) -> str:
        """What it did, in words."""
        return "leaves the floor" if self.found.outcome is None else self.found.outcome.verb

    @property
    def slip(self) -> str:
        """How far it slid [mm], in words."""
        slip = self.found.max_slip_m
        return "0" if slip == 0.0 else MILLIMETRES.text(slip, figures=3, bare=True)

    @property
    def margin(self) -> str:
        """At how many times the motion it overturns; empty where that was not tried."""
        margin = self.found.margin
        if margin is None:
            return ""
        at, tried_to = margin.factor, margin.largest_tried
        return f"not up to {tried_to:.3g} times" if at is None else f"{at:.3g} times"


def of_run(run: OpenedRun) -> Sequence[OfModel]:
    """What four models find of the container of a run in a folder, in some seconds; none without a verdict."""
    result = run.typed_result
    if result.verdict is None or result.status not in RUN.finished:
        return ()
    try:
        given = load_case(str(run.place.case), result.overrides or (), allow_outside=True)
        return side_by_side(given, result.verdict)
    except (ValueError, ArithmeticError, RuntimeError):  # its files are not here any more
        return ()


def side_by_side(given: Case, own: Verdict | None = None) -> Sequence[OfModel]:
    """What four models find of a container under its motion; fewer where one cannot be computed.

    Args:
        given: the case, of a container for whose motion there is an analytic block; of another one none.
        own: of its run, which is not repeated; None: of none.
    """
    rigid = given.replace(RIGID_GROUND)
    if not has_analytic_block(rigid) or given.solver.model == "full":
        return []
    slab: dict[str, str] = {} if given.floor.is_slab else CONCRETE
    ground = (given.floor.preset or "slab") if given.floor.is_slab else CONCRETE["floor.preset"]
    models = {
        "rigid body, rigid ground": RIGID_GROUND | {"solver.model": "rigid"},
        "elastic container, rigid ground": RIGID_GROUND | {"solver.model": "reduced"},
        f"elastic container, {ground}": slab | {"solver.model": "reduced"},
    }
    block, asked = own.analytic if own else None, case_hash(given)
    if block is None:
        model = build_model(rigid)
        block = analytic_block(model, model.duration)
    found = [
        OfModel(
            model="analytic rigid block",
            found=Verdict(
                outcome=None if block.outcome is None else Outcome(block.outcome),
                rotation_ratio=block.rotation_ratio,
                max_slip_m=block.max_slip_m,
            ),
            needs=block.friction_needed,
        )
    ]
    for name, changes in models.items():
        with suppress(ValueError, ArithmeticError, RuntimeError):  # no wall that would bear on a slab, say
            case = given.replace(changes)
            known = own if case_hash(case) == asked else None
            verdict = known or compute(case.without_fields(), band=False, margin=True).verdict
            found.append(OfModel(model=name, found=verdict, own=known is not None))
    return found


def compared_in_words(given: Case, found: Sequence[OfModel]) -> str:
    """Whether the models agree, and what makes them differ, in sentences; empty of fewer than two."""
    turned = sorted(
        (one.found.rotation_ratio, one.model) for one in found if one.found.rotation_ratio is not None
    )
    if len(turned) < 2:
        return ""
    (low, least), (high, most) = turned[0], turned[-1]
    if Outcome.OVERTURNED in (ends := {one.found.outcome for one in found}):
        fell = [one.model for one in found if one.found.outcome == Outcome.OVERTURNED]
        words = "All overturn." if len(ends) == 1 else f"It overturns by some only: {', '.join(fell)}."
    elif high - low <= max(ALIKE * high, RATIO.least):
        words = f"Rotations agree: {RATIO.range_text((low, high))} of the slenderness angle."
    else:
        words = f"Rotations differ: {RATIO.text(low)} ({least}) to {RATIO.text(high)} ({most})."
    slips = [one.found.max_slip_m for one in found if one.found.max_slip_m is not None]
    if slips and max(slips) > SLIDES_M:
        words += f" Slip is {MILLIMETRES.text(min(slips), figures=2)} to {MILLIMETRES.text(max(slips), figures=2)}."
    block, elastic = found[0], found[-1]
    static, kinetic = given.contact.mu_static, given.contact.mu_kinetic
    slides = elastic.found.slipped > SLIDES_M > block.found.slipped
    if block.needs is not None and kinetic < block.needs < static and slides:
        words += (
            f" To rock without sliding takes friction of {block.needs:.2g}, between kinetic ({kinetic:g}) and static "
            f"({static:g}): the block keeps to it, and a landing breaks the elastic container loose."
        )
    if bounces := max((one.found.flight_share or 0.0 for one in found), default=0.0):
        words += (
            f" Elastic, it is in the air for up to {PERCENT.text(bounces)} of the time in which it rocks."
        )
    return words
