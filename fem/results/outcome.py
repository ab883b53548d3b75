"""What a container did, and what a run of it counts as: the words and codes of runs, tables, figures and pages."""

from enum import IntEnum, StrEnum
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from contact.stepping import modes

UPRIGHT_OR_FALLEN = ("completed", "overturned")  #: statuses of a run that has an outcome


class Outcome(StrEnum):
    """What happened in a run, and the states of motion in its history; from the weakest to the worst."""

    REST = "rest", modes.REST, "rested"
    SLIDE = "slide", modes.SLIDE, "slid"
    HOP = "hop", modes.HOP, "hopped"
    ROCK = "rock", modes.ROCK, "rocked"
    SLIDE_ROCK = "slide-rock", modes.SLIDE_ROCK, "slid, rocked"
    OVERTURNED = "overturned", modes.FALLEN, "overturned"
    #: a corner was destroyed, and the laws of its contact do not hold; no state of motion, and no code of the kernel
    INVALID = "invalid", 15, "not valid"

    code: int  #: of the kernel
    verb: str
    __repr__ = str.__repr__  # in printed rows and lists, the word

    def __new__(cls, word: str, code: int = 0, verb: str = "") -> Self:
        """A word with its code and verb; `Outcome("rock")` finds one by its word alone."""
        member = str.__new__(cls, word)
        member._value_, member.code, member.verb = word, code, verb
        return member

    @classmethod
    def of(cls, *, slides: bool, rocks: bool, hops: bool = False) -> Self:
        """The outcome of what did not overturn; a hop counts where nothing rocks."""
        if rocks:
            return cls.SLIDE_ROCK if slides else cls.ROCK
        return cls.HOP if hops else cls.SLIDE if slides else cls.REST


def least_slide(width: float) -> float:
    """The path from which a container of this width counts as sliding [m]."""
    return max(modes.SLIDING * width, modes.LEAST_SLIDE)


#: by the code of the kernel
MODES = {outcome.code: outcome for outcome in Outcome if outcome is not Outcome.INVALID}
SLIDING = (Outcome.SLIDE, Outcome.SLIDE_ROCK)
ROCKING = (Outcome.ROCK, Outcome.SLIDE_ROCK)


class Ending(IntEnum):
    """What a run counts as in a study."""

    UNKNOWN, STANDING, OVERTURNED, FAILED, INVALID = 0, 1, 2, 3, 4

    @property
    def word(self) -> str:
        """As in tables."""
        return self.name.lower()


#: the endings that a study counts, by column
COUNTED = {
    "stood": Ending.STANDING,
    "overturned": Ending.OVERTURNED,
    "invalid": Ending.INVALID,
    "failed": Ending.FAILED,
}
COUNTED_AS = {ending: word for word, ending in COUNTED.items()}
#: of these, what does not stand: it overturned, or destroyed the corner on which it stood
NOT_STANDING = (Ending.OVERTURNED, Ending.INVALID)
#: of the outcomes of what does not stand
ENDINGS: dict[str, Ending] = {Outcome.OVERTURNED: Ending.OVERTURNED, Outcome.INVALID: Ending.INVALID}


def counts_of(endings: ArrayLike) -> dict[str, int]:
    """How many of some endings there are, by column."""
    return {word: int(np.count_nonzero(np.equal(endings, ending))) for word, ending in COUNTED.items()}


def ending_of(status: str, outcome: str | None) -> Ending:
    """The ending of a run by its status and outcome; a failed run never stands."""
    if status not in UPRIGHT_OR_FALLEN or not outcome:
        return Ending.FAILED
    return ENDINGS.get(outcome, Ending.STANDING)
