"""What static rule and paper say of a motion beforehand, and how often a criterion is right.

Each criterion says of a motion whether the container stands or overturns; the run says what happens. A criterion is
right, conservative (it says "overturns", the container stands) or unconservative (it says "stands", the container
overturns).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from fem.paper.cases import GRAVITY, WIDTH


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What a criterion may know of a cell."""

    peak: float  #: [m/s2]
    amplitude: float  #: [m]
    slenderness: float  #: c/a
    mu_static: float
    mu_kinetic: float

    @property
    def tilts(self) -> bool:
        """M_T of Eq. (9) above M_R of Eq. (10)."""
        return self.peak > GRAVITY / self.slenderness

    @property
    def slides(self) -> bool:
        """Base shear above the limit of Eq. (8)."""
        return self.peak > self.mu_static * GRAVITY

    @property
    def slides_first(self) -> bool:
        """Stiction is lost below the acceleration of tilting."""
        return self.mu_static < 1.0 / self.slenderness


def static_rule(motion: Motion) -> bool:
    """Lateral force method under the run's own peak: it overturns as soon as M_T exceeds M_R."""
    return motion.tilts


def static_rule_or_sliding(motion: Motion) -> bool:
    """The strict quasi-static reading of section 1: loss of stiction is loss of bearing capacity as well."""
    return motion.tilts or motion.slides


def half_width(motion: Motion) -> bool:
    """Section 5.4: A > a/2 overturns, A <= a/2 does not."""
    return motion.amplitude > 0.5 * WIDTH


def paper_criteria(motion: Motion) -> bool:
    """Eqs. (8) to (13) with A > a/2: it tilts before it slides, or while it slides, and the amplitude suffices.

    Once it slides, the shear is mu_k G, and Eqs. (9) to (11) tilt it only if mu_k > a/c.
    """
    tilted = motion.tilts and (not motion.slides_first or motion.mu_kinetic > 1.0 / motion.slenderness)
    return tilted and half_width(motion)


CRITERIA: Mapping[str, Callable[[Motion], bool]] = {
    "static rule, own peak": static_rule,
    "static rule, tilting or sliding": static_rule_or_sliding,
    "A <= a/2": half_width,
    "the paper's, Eqs. 8 to 13 and A": paper_criteria,
}


@dataclass(frozen=True, kw_only=True)
class Contingency:
    """How often a criterion was right, over some cells."""

    cells: int
    right: int
    conservative: int
    unconservative: int

    @property
    def shares(self) -> tuple[float, float, float]:
        """Right, conservative, unconservative, over all cells."""
        total = max(self.cells, 1)
        return self.right / total, self.conservative / total, self.unconservative / total


def contingency(says_overturns: Sequence[bool], overturned: Sequence[bool]) -> Contingency:
    """Count a criterion against the runs."""
    pairs = list(zip(says_overturns, overturned, strict=True))
    return Contingency(
        cells=len(pairs),
        right=sum(said == did for said, did in pairs),
        conservative=sum(said and not did for said, did in pairs),
        unconservative=sum(did and not said for said, did in pairs),
    )


def mode_said(motion: Motion) -> str:
    """The mode of section 5 that Eqs. (8) to (13) predict."""
    if paper_criteria(motion):
        return "overturned"
    if motion.tilts and not motion.slides_first:
        return "rock"
    if motion.slides:
        return "slide-rock" if motion.tilts and motion.mu_kinetic > 1.0 / motion.slenderness else "slide"
    return "rest"
