"""What the static rule and the paper predict for a motion, and how often such a criterion is right.

A criterion says whether the container stands or overturns; the run decides. A criterion is right, conservative (it
says "overturns", the container stands) or unconservative (it says "stands", the container overturns).
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from paper.cases import KEYS, PaperCase
from paper.dimensions import GRAVITY, HALF_WIDTH, HEIGHT, WIDTH

from fem.results.outcome import Outcome


@dataclass(frozen=True, kw_only=True)
class MapMotion:
    """What a criterion knows of a cell of a map."""

    angular_frequency: float  #: [rad/s]
    peak: float  #: [m/s2]
    slenderness: float  #: c/a
    mu_static: float
    mu_kinetic: float

    @property
    def amplitude(self) -> float:
        """A of the floor [m]."""
        return self.peak / self.angular_frequency**2

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

    @property
    def tilts_while_sliding(self) -> bool:
        """Eqs. (9) to (11): once it slides, the shear is mu_k G."""
        return self.mu_kinetic > 1.0 / self.slenderness


def motion_of(case: PaperCase) -> MapMotion:
    """What a criterion knows of a case of a map."""
    values = case.values
    return MapMotion(
        angular_frequency=values[KEYS["frequency"]],
        peak=values[KEYS["peak"]],
        slenderness=round(values.get("container.height_m", HEIGHT) / WIDTH, 6),
        mu_static=values[KEYS["mu_static"]],
        mu_kinetic=values[KEYS["mu_kinetic"]],
    )


Criterion = Callable[[MapMotion], bool]


def static_rule(motion: MapMotion) -> bool:
    """Lateral force method under the run's own peak: it overturns as soon as M_T exceeds M_R."""
    return motion.tilts


def static_rule_or_sliding(motion: MapMotion) -> bool:
    """The strict quasi-static reading of section 1: loss of stiction is loss of bearing capacity as well."""
    return motion.tilts or motion.slides


def half_width_rule(motion: MapMotion) -> bool:
    """Section 5.4: A > a/2 overturns, A <= a/2 does not."""
    return motion.amplitude > HALF_WIDTH


def tilting_rule(motion: MapMotion) -> bool:
    """Eqs. (8) to (13) alone: it overturns as soon as it tilts, before or while it slides."""
    return motion.tilts and (not motion.slides_first or motion.tilts_while_sliding)


def paper_rule(motion: MapMotion) -> bool:
    """Eqs. (8) to (13) with A > a/2: it tilts, and the amplitude suffices."""
    return tilting_rule(motion) and half_width_rule(motion)


CRITERIA: Mapping[str, Criterion] = {
    "static rule, own peak": static_rule,
    "static rule, tilting or sliding": static_rule_or_sliding,
    "A <= a/2": half_width_rule,
    "Eqs. 8 to 13": tilting_rule,
    "Eqs. 8 to 13 and A <= a/2": paper_rule,
}


@dataclass(frozen=True, kw_only=True)
class Contingency:
    """How often a criterion was right, over some cells."""

    cells: int
    conservative: int
    unconservative: int

    @property
    def right(self) -> int:
        """Cells of which it says what happens."""
        return self.cells - self.conservative - self.unconservative

    @property
    def share_right(self) -> float:
        """Right predictions over all cells."""
        return self.right / max(self.cells, 1)


def contingency(says_overturns: Sequence[bool], overturned: Sequence[bool]) -> Contingency:
    """Count a criterion against the runs."""
    counts = Counter(zip(says_overturns, overturned, strict=True))
    return Contingency(
        cells=counts.total(), conservative=counts[True, False], unconservative=counts[False, True]
    )


def predicted_mode(motion: MapMotion) -> Outcome:
    """The mode of section 5 that Eqs. (8) to (13) predict."""
    if paper_rule(motion):
        return Outcome.OVERTURNED
    if motion.tilts and not motion.slides_first:
        return Outcome.ROCK
    if motion.slides:
        return Outcome.SLIDE_ROCK if motion.tilts and motion.tilts_while_sliding else Outcome.SLIDE
    return Outcome.REST
