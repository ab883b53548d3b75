"""Warnings: what the reader must know before relying on a result. `warnings.txt.j2` says when, and in which words."""

import math
from typing import Any

from contact.stepping.ledger import GAIN_LIMIT, LOSS_LIMIT, LOSS_SHARE_LIMIT
from contact.stepping.modes import ROCKING
from fem.case.case import Case
from fem.case.tables.duration import MOST_FREE_MOTION, ends_at_rest, longest_time
from fem.case.tables.input_ranges import DASHPOT, WEAKENING
from fem.results.run_result import (
    ActionResult,
    Band,
    ChangedRun,
    Energy,
    MotionResult,
    Numerics,
    RunResult,
    StaticResult,
    Verdict,
    to_overturn,
)
from fem.run.card import line
from fem.run.described import doubts
from fem.run.ranges import plastic_corner
from fem.run.sureness import numerical
from fem.run.words import paragraphs

LIMITS: dict[str, Any] = {
    "NEAR": 0.5,  #: share of a limit from which there is a warning
    "REJECTED_SHARE": 0.05,
    "FLIGHT": 0.05,  #: share of the rocking in the air from which it is said
    #: largest von Mises stress over Young's modulus up to which `reduced` and `full` agree within 5 %: blocks of one to
    #: ten boxes, corners and flat, of 1e9 to 1.5e6 Pa; at 0.024 they differ by 9 % (`fem/README.md`)
    "SMALL_STRAIN": 0.01,
    #: relaxation time of the contact over the time scale of rocking 1/p, from which the dashpot is more than a loss at
    #: impacts: the rotation ratio of a rigid `rocking` on its flat base is 0.85 at 0.006, 0.68 at 0.15, 0.49 at 0.31
    "FAST_RELAXATION": 0.1,
    "ROCKING": ROCKING,
    "GAIN_LIMIT": GAIN_LIMIT,
    "MOST_FREE_MOTION": MOST_FREE_MOTION,
}
#: slip over the width, and its change over the larger one, from which a scatter is said
SLIPS, SCATTER = 1e-3, 0.2


def warnings_for(result: RunResult, case: Case) -> list[str]:
    """All warnings that apply to a result, the most important first."""
    verdict, static = result.verdict or Verdict(), result.static or StaticResult()
    numerics, energy = result.numerics or Numerics(), result.energy or Energy()
    reference = energy.reference_J or math.inf
    parts = (energy.friction_J, energy.contact_damping_J, energy.material_damping_J, energy.crushing_J)
    known = energy.reference_J and energy.numerical_J is not None
    width, angle = case.stack[0].width, static.slenderness_angle_rad
    own_dashpot = {case.contact_damping_ratio: verdict.rotation_ratio}
    varied = {ratio: run.rotation_ratio for ratio, run in _changed_alone(verdict, DASHPOT).items()}
    # dashpot over spring, of the whole mass on half the base's stiffness: see contact.penalty.relaxation_time
    frequency, ratio = (
        numerics.contact_frequency_Hz,
        numerics.contact_damping_ratio or case.contact.damping_ratio,
    )
    return paragraphs(
        "warnings.txt.j2",
        **LIMITS,
        case=case,
        result=result,
        verdict=verdict,
        static=static,
        own=static.ruling,
        numerics=numerics,
        sureness=line(result, "sureness"),
        by_weakening=_changed_alone(verdict, WEAKENING),
        by_dashpot=own_dashpot | varied,
        scatter=_scatter(verdict, width),
        doubts=doubts(result.motion or MotionResult(), case.gravity_m_s2),
        ends_at_rest=ends_at_rest(case),
        longest_time=longest_time(case),
        gained=-(energy.numerical_J or 0.0) / reference,
        lost=(energy.closure_error or 0.0) * reference if known else 0.0,
        lost_limit=max(LOSS_SHARE_LIMIT * sum(part or 0.0 for part in parts), LOSS_LIMIT * reference),
        to_overturn=to_overturn(bool(case.neighbour)),
        tilted=(numerics.max_penetration_m or 0.0) / (width * angle) if angle else 0.0,
        creep=_creep(case, static.ruling),
        relaxation=2.0 * ratio * math.sqrt(2.0) / (2.0 * math.pi * frequency) if frequency else 0.0,
        damping_ratio=ratio,
        plastic_corner=plastic_corner(verdict),
    )


def _changed_alone(verdict: Verdict, key: str) -> dict[float, ChangedRun]:
    """The variations of a run that change nothing but a number, by that number."""
    return {
        float(member.values[key]): member
        for member in (verdict.band or Band()).members
        if member.values is not None and [*member.values] == [key] and member.rotation_ratio is not None
    }


def _scatter(verdict: Verdict, width: float) -> float | None:
    """The slip with steps ten times as accurate, where it is another one and as likely as that of the run [m]."""
    band, own = verdict.band or Band(), verdict.max_slip_m
    finer = next((member.max_slip_m for member in band.members[1:] if numerical(member)), None)
    if own is None or finer is None or band.max_slip_m is None:
        return None
    low, high = band.max_slip_m
    small = max(own, finer) < SLIPS * width or abs(own - finer) < SCATTER * max(own, finer)
    return None if small or not low <= finer <= high else finer  # beyond: it fell, or destroyed a corner


def _creep(case: Case, own: ActionResult) -> float | None:
    """v = v_reg artanh(s) under a steady load of share s of what friction carries, over the run: no true stick [m]."""
    share = own.utilisation_sliding
    if case.contact.sticks or share is None or not 0.0 < share < 1.0:
        return None
    return case.contact.regularisation_velocity_m_s * math.atanh(share) * longest_time(case)
