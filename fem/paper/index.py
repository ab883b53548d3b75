"""Every statement of the paper that is tried, by subject, and those that are not, with the reason."""

from dataclasses import dataclass

from fem.paper import (
    amplification,
    counting,
    example,
    friction,
    numbers,
    overturning,
    quasi_static,
    rocking,
    shape,
    sliding,
)
from fem.paper.claims import Statement


@dataclass(frozen=True, kw_only=True)
class Untried:
    """A sentence of the paper that no run can confirm or refute."""

    section: str
    quote: str
    reason: str


GROUPS: dict[str, tuple[Statement, ...]] = {
    "The central claim, counted": counting.STATEMENTS,
    "The example of section 7": example.STATEMENTS,
    "The printed numbers": numbers.STATEMENTS,
    "Limit conditions": quasi_static.STATEMENTS,
    "Sliding": sliding.STATEMENTS,
    "Friction": friction.STATEMENTS,
    "Rocking": rocking.STATEMENTS,
    "Response": amplification.STATEMENTS,
    "Overturning": overturning.STATEMENTS,
    "The body": shape.STATEMENTS,
}

UNTRIED = (
    Untried(
        section="3",
        quote="For simplicity ... the seismic action is assumed to be a harmonic ground motion",
        reason='An assumption, not a statement; recorded motions are another study (motion.kind = "table").',
    ),
    Untried(
        section="3",
        quote="the asperity of both contact surfaces being represented by constant coefficients",
        reason="An assumption; what the coefficients change is tried under sliding.",
    ),
    Untried(
        section="4.1",
        quote=(
            "there is no simple engineering solution published, which includes friction with belt-reversals"
        ),
        reason=(
            "A statement on the literature. Westermo and Udwadia (1983) give the sliding oscillator on a "
            "reversing floor in closed form; rocking and sliding together have criteria of initiation "
            "(Shenton 1996), no more."
        ),
    ),
    Untried(
        section="4.3",
        quote=(
            "values are given for steel on concrete: 0,3 <= mu_s <= 0,4; big differences result from "
            "higher displacement rates"
        ),
        reason="A matter of tests on materials.",
    ),
    Untried(
        section="6",
        quote="the tuning of the driving frequency can be difficult",
        reason="A remark on method; `python -m fem response` follows a frequency up and down.",
    ),
)


def all_statements() -> list[tuple[str, Statement]]:
    """Group and statement, in the order of the page."""
    return [(group, statement) for group, statements in GROUPS.items() for statement in statements]
