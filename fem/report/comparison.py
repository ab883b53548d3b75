"""Rows of a report: the static rules beside the run."""

import math
from typing import NamedTuple

from fem.html.units import number, quantity, short, typeset
from fem.model.static_checks import StaticChecks
from fem.results.run_result import Verdict
from fem.run.static_words import rule_says
from fem.run.summary import own_motion_name, run_lifted, run_slid, run_tilted

EDITION = "EN 1998-1:2004, "  #: of the clauses; the head of their column names it


class Compared(NamedTuple):
    """The static rule under one action, and what the run found where the two may be compared."""

    check: str
    action: str
    demand: str
    capacity: str
    utilisation: str
    exceeded: bool
    clause: str
    rule: str  #: what the rule says
    run: str  #: what the run found; empty where it is not to be compared


def compared_rows(static: StaticChecks, verdict: Verdict) -> list[Compared]:
    """Sliding and overturning under the run's own peak, then under the code's base shear."""
    compared = static.own_motion, static.own_motion_vertical
    actions = [(static.own_motion, typeset(own_motion_name(static.to_result())))]
    if static.own_motion_vertical is not None:
        peak = quantity(static.peak_vertical_acceleration, "m/s²", figures=3)
        actions.append((static.own_motion_vertical, f"own peak, and {peak} vertical"))
    if (code := static.by_code) is not None:
        q = code.values.behaviour_factor
        codes = [(code.as_given, f"code, q = {short(q)}"), (code.q1, "code, q = 1")]
        actions += codes if q != 1.0 else codes[:1]
    if static.wind is not None:
        actions.append((static.wind, "wind"))
    rows = [
        Compared(
            check=check,
            action=name,
            demand=quantity(rule.demand, f"k{rule.unit}", 1e-3),
            capacity=quantity(rule.capacity, f"k{rule.unit}", 1e-3),
            utilisation="∞" if rule.utilisation == math.inf else number(rule.utilisation),
            exceeded=not rule.passed,
            clause=rule.clause.removeprefix(EDITION).removesuffix(f", {check}"),
            rule=rule_says(check, rule.utilisation),
            run=typeset(words_of(verdict))
            if verdict.outcome and any(action is own for own in compared)
            else "",
        )
        for action, name in actions
        for check, rule, words_of in (
            ("sliding", action.sliding, run_slid),
            ("overturning", action.overturning, run_tilted),
        )
    ]
    lifting = static.to_result().ruling.utilisation_lifting
    if lifting is not None and lifting > 1.0:
        rows.append(
            Compared(
                check="lifting",
                action="own peak, vertical",
                demand=quantity(lifting * static.weight, "kN", 1e-3),
                capacity=quantity(static.weight, "kN", 1e-3),
                utilisation=number(lifting),
                exceeded=True,
                clause="",
                rule=rule_says("lifting", lifting),
                run=typeset(run_lifted(verdict)) if verdict.outcome else "",
            )
        )
    return rows
