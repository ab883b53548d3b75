"""What a statement of the paper is, what trying it gave, and the rule that makes a verdict of it.

A verdict is never written down: it follows from comparisons of measured numbers with limits by `verdict_of`.
Rotation > 0 tilts toward +x; SI units, each with its number.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any, Literal

from fem.case.case import Case, load_case

if TYPE_CHECKING:
    from fem.paper.experiments import Laboratory

Relation = Literal["=", "<=", ">="]


class Verdict(Enum):
    """What became of a statement."""

    CONFIRMED = "confirmed"
    BOUNDED = "confirmed within stated bounds"
    REFUTED = "refuted"
    UNDECIDED = "not computed"


@dataclass(frozen=True, kw_only=True)
class Setup:
    """A case that a reader can run again: a shipped case and what is changed of it."""

    base: str  #: name of a shipped case
    values: Mapping[str, Any] = field(default_factory=dict)  #: dotted keys
    what: str = ""  #: for people

    def but(self, values: Mapping[str, Any], what: str = "") -> "Setup":
        """This setup with more keys changed."""
        return Setup(base=self.base, values={**self.values, **values}, what=what or self.what)

    @property
    def case(self) -> Case:
        """The case itself, without fields.

        Raises:
            CaseError: as for a case file.
        """
        return load_case(self.base).with_values({**self.values, "output.fields_s": 0.0})

    @property
    def key(self) -> tuple[Any, ...]:
        """Equal for setups that compute the same."""
        return self.base, *sorted(self.values.items())

    @property
    def command(self) -> str:
        """The line that runs it."""
        changes = "".join(f" --set {key}={_literal(value)}" for key, value in self.values.items())
        return f"python -m fem run {self.base}{changes} --out outputs/try"


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """A measured number against a limit."""

    what: str
    measured: float
    relation: Relation
    limit: float
    unit: str
    tolerance: float = 0.0  #: of "=", absolute
    inside: bool = True  #: whether it lies inside the bounds of the statement

    @property
    def holds(self) -> bool:
        """Whether the measured number stands in the relation; nan never does."""
        match self.relation:
            case "=":
                return abs(self.measured - self.limit) <= self.tolerance
            case "<=":
                return self.measured <= self.limit
            case ">=":
                return self.measured >= self.limit


@dataclass(frozen=True, kw_only=True)
class Table:
    """Rows for people; numbers as they are, formatted by the page."""

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """A figure of the page."""

    name: str  #: of its file, without ending
    caption: str
    svg: str


@dataclass(frozen=True, kw_only=True)
class Member:
    """The statement's own case on another container or floor."""

    what: str
    command: str
    outcome: str | None  #: None where the run failed
    value: float | None
    holds: bool | None  #: whether the statement's criterion holds there; None where the run failed


@dataclass(frozen=True, kw_only=True)
class Band:
    """What elasticity, contact and support make of one number that a statement rests on."""

    quantity: str
    unit: str
    criterion: str
    members: tuple[Member, ...]

    @property
    def low(self) -> float:
        """Smallest value of the members that were computed; nan if there is none."""
        return min(self._values, default=math.nan)

    @property
    def high(self) -> float:
        """Largest value of the members that were computed; nan if there is none."""
        return max(self._values, default=math.nan)

    @property
    def holding(self) -> int:
        """In how many members the criterion holds."""
        return sum(member.holds is True for member in self.members)

    @property
    def summary(self) -> str:
        """One line: how often the criterion holds, and whether elasticity, contact or support decide."""
        total = len(self.members)
        failed = sum(member.holds is None for member in self.members)
        lost = f", {failed} not computed" if failed else ""
        if self.holding == total:
            change = "deformation, contact and support do not change it"
        elif self.holding == 0:
            change = "it holds in none of them"
        else:
            change = "it depends on deformation, contact or support"
        return f"holds in {self.holding} of {total}{lost}: {change}"

    @property
    def _values(self) -> list[float]:
        return [member.value for member in self.members if member.value is not None]


@dataclass(frozen=True, kw_only=True)
class Finding:
    """What trying a statement gave."""

    comparisons: tuple[Comparison, ...]
    reading: str  #: what the numbers say, in a sentence or two
    bounds: str = ""  #: under which the comparisons marked `inside` are made; empty: as the paper claims it
    setups: tuple[Setup, ...] = ()
    tables: tuple[Table, ...] = ()
    drawings: tuple[Drawing, ...] = ()
    band: Band | None = None

    @property
    def verdict(self) -> Verdict:
        """By `verdict_of`."""
        return verdict_of(self.comparisons, self.bounds)

    def to_dict(self) -> dict[str, Any]:
        """Plain data, without the drawings' contents."""
        document = asdict(self)
        document["verdict"] = self.verdict.value
        document["rule"] = rule_applied(self.comparisons, self.bounds)
        for entry, comparison in zip(document["comparisons"], self.comparisons, strict=True):
            entry["holds"] = comparison.holds
        document["setups"] = [{"what": setup.what, "command": setup.command} for setup in self.setups]
        document["drawings"] = [{"name": one.name, "caption": one.caption} for one in self.drawings]
        if self.band is not None:
            document["band"] |= {"low": self.band.low, "high": self.band.high, "summary": self.band.summary}
        return document


@dataclass(frozen=True, kw_only=True)
class Statement:
    """A sentence, equation or number of the paper that a run or a closed form can try."""

    name: str  #: short, stable: anchors of the page, files of the figures
    section: str
    quote: str
    tried: str  #: how, in a sentence
    examine: Callable[["Laboratory"], Finding]
    seconds: float = 1.0  #: about, on one core; only for the time left


def verdict_of(comparisons: tuple[Comparison, ...], bounds: str) -> Verdict:
    """Confirmed if every comparison holds; within bounds if bounds are stated, all comparisons inside them
    hold and there is one; refuted otherwise. Without comparisons nothing is decided.
    """
    if not comparisons:
        return Verdict.UNDECIDED
    if all(one.holds for one in comparisons):
        return Verdict.CONFIRMED
    inside = [one for one in comparisons if one.inside]
    if bounds and inside and all(one.holds for one in inside):
        return Verdict.BOUNDED
    return Verdict.REFUTED


def rule_applied(comparisons: tuple[Comparison, ...], bounds: str) -> str:
    """The rule with its numbers, for people."""
    holding = sum(one.holds for one in comparisons)
    text = f"{holding} of {len(comparisons)} comparisons hold"
    if bounds and holding < len(comparisons):
        inside = [one for one in comparisons if one.inside]
        text += f"; {sum(one.holds for one in inside)} of {len(inside)} inside the bounds"
    return text


def _literal(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, int | float) else str(value)
