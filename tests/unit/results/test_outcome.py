"""The outcomes of runs and studies."""

from contact.stepping import modes
from fem.results.outcome import MODES, Ending, Outcome, ending_of


def test_every_mode_of_the_kernel_is_an_outcome():
    assert MODES[modes.REST] == "rest" and MODES[modes.FALLEN] == "overturned"
    assert MODES[modes.ROCK + modes.SLIDE] == "slide-rock"
    assert len(MODES) == len(Outcome) - 1 == modes.HOP + 1 and Outcome.INVALID not in MODES.values()


def test_what_failed_or_is_not_valid_never_stands():
    assert ending_of("completed", "invalid") == ending_of("overturned", "invalid") == Ending.INVALID
    assert ending_of("failed", None) == ending_of("failed", "rest") == ending_of("interrupted", None)
    assert ending_of("failed", None) == Ending.FAILED
    assert ending_of("completed", "slide-rock") == Ending.STANDING
    assert ending_of("overturned", "overturned") == Ending.OVERTURNED
