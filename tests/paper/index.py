"""Every claim of the paper that is checked, by topic, and those that are not, with the reason."""

from paper import counting, example, overturning, quasi_static, rocking, shape, sliding, stacking
from paper.claims import Claim

TOPICS = {
    # in the order of its file
    title: tuple(claim for claim in vars(module).values() if isinstance(claim, Claim))
    for title, module in {
        "The central claim, counted": counting,
        "The example of section 7": example,
        "Limit conditions": quasi_static,
        "Sliding and friction": sliding,
        "Rocking and response": rocking,
        "Overturning": overturning,
        "The body": shape,
        "Boxes without bolts": stacking,
    }.items()
}

#: sentences of the paper that no run can confirm or refute: section, quote, reason
UNTRIED = (
    (
        "3",
        "For simplicity ... the seismic action is assumed to be a horizontal harmonic ground motion",
        'An assumption, not a claim; recorded motions are another study (motion.kind = "table").',
    ),
    (
        "3",
        "the asperity of both contact surfaces being represented by constant coefficients",
        "An assumption; the effect of the coefficients is checked under sliding.",
    ),
    (
        "4.1",
        "there is no simple engineering solution published, which includes friction with “belt-reversals”",
        "A statement on the literature. Westermo and Udwadia (1983) give the sliding oscillator on a reversing floor "
        "in closed form; rocking and sliding together have criteria of initiation (Shenton 1996), not more.",
    ),
    (
        "4.3",
        "values are given for steel on concrete ... big differences result from higher displacement rates",
        "A matter of tests on materials.",
    ),
    (
        "6",
        "the tuning of the driving frequency can be difficult",
        "A remark on method; `python -m fem response` follows a frequency up and down.",
    ),
)


def all_claims() -> list[Claim]:
    """All checked claims, in the order of the page."""
    return [claim for claims in TOPICS.values() for claim in claims]
