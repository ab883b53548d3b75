"""A claim of the paper, what its check found, and the rule from comparisons to a conclusion.

A conclusion is never written down: it follows from comparisons of measured numbers with limits by `conclude`.
Rotation > 0 tilts toward +x; SI units, each with its number.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from enum import Enum
from typing import Any, Literal, TypeVar

from fem.evidence.paper.cases import PaperCase
from fem.evidence.paper.experiments import Experiments, VariantBand


class Conclusion(Enum):
    """Result of checking a claim."""

    CONFIRMED = "confirmed"
    BOUNDED = "confirmed within stated bounds"
    REFUTED = "refuted"
    UNDECIDED = "not computed"
    MISPRINT = "misprint"
    REMARK = "remark"


#: a statement can be refuted; a printed number or sign is right or a misprint; a remark is what runs add to a sentence
#: that claims nothing they could refute
ClaimKind = Literal["statement", "print", "remark"]


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """A measured number against a limit."""

    what: str
    measured: float
    relation: Literal["=", "<=", ">="]
    limit: float
    unit: str = "-"
    tolerance: float = 0.0  #: of "=", absolute
    inside: bool = True  #: whether it is made inside the stated bounds of the claim

    def __post_init__(self) -> None:
        # of a count, a truth value or a numpy number
        object.__setattr__(self, "measured", float(self.measured))

    @property
    def holds(self) -> bool:
        """Whether the measured number satisfies the relation; nan never does."""
        if self.relation == "=":
            return abs(self.measured - self.limit) <= self.tolerance
        return self.measured <= self.limit if self.relation == "<=" else self.measured >= self.limit


def at_most(what: str, measured: float, limit: float, unit: str = "-", *, inside: bool = True) -> Comparison:
    """The measured number must not exceed the limit."""
    return Comparison(what=what, measured=measured, relation="<=", limit=limit, unit=unit, inside=inside)


def at_least(what: str, measured: float, limit: float, unit: str = "-", *, inside: bool = True) -> Comparison:
    """The measured number must reach the limit."""
    return Comparison(what=what, measured=measured, relation=">=", limit=limit, unit=unit, inside=inside)


def equal(
    what: str, measured: float, limit: float, tolerance: float, unit: str = "-", *, inside: bool = True
) -> Comparison:
    """The measured number must be within an absolute tolerance of the limit."""
    one = at_most(what, measured, limit, unit, inside=inside)
    return replace(one, relation="=", tolerance=tolerance)


@dataclass(frozen=True, kw_only=True)
class ClaimTable:
    """Rows for people; numbers in full, rounded by the page."""

    caption: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]


def table(caption: str, columns: str, rows: Sequence[Sequence[Any]]) -> ClaimTable:
    """A table; the names of the columns are separated by " | "."""
    return ClaimTable(caption=caption, columns=columns.split(" | "), rows=rows)


def outcomes(caption: str, experiments: Experiments, cases: Sequence[PaperCase]) -> ClaimTable:
    """Outcome, rotation and slip of each case."""
    columns = ("outcome", "rotation_ratio", "max_slip_m")
    rows = [[row[name] for name in columns] for row in experiments.rows(cases)]
    return table(
        caption,
        "run | outcome | rotation ratio [-] | largest slip [m]",
        [(case.what, *row) for case, row in zip(cases, rows, strict=True)],
    )


@dataclass(frozen=True, kw_only=True)
class ClaimFigure:
    """A figure of the page."""

    name: str  #: of its file, without suffix
    caption: str
    svg: str


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Result of the check of a claim."""

    comparisons: Sequence[Comparison]
    reading: str  #: what the numbers say, in a sentence or two
    bounds: str = ""  #: of the comparisons marked `inside`; empty: the claim as the paper makes it
    kind: ClaimKind = "statement"
    cases: Sequence[PaperCase] = ()
    tables: Sequence[ClaimTable] = ()
    figures: Sequence[ClaimFigure] = ()
    band: VariantBand | None = None

    @property
    def conclusion(self) -> Conclusion:
        """By `conclude`."""
        return conclude(self.comparisons, self.bounds, self.kind)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for `study.json`, without the contents of the figures."""
        return {
            "comparisons": [asdict(one) | {"holds": one.holds} for one in self.comparisons],
            "reading": self.reading,
            "bounds": self.bounds,
            "setups": [{"what": case.what, "command": case.command} for case in self.cases],
            "tables": [asdict(table) for table in self.tables],
            "drawings": [{"name": figure.name, "caption": figure.caption} for figure in self.figures],
            "band": None if self.band is None else self.band.to_dict(),
            "verdict": self.conclusion.value,
            "rule": counts_in_words(self.comparisons, self.bounds) if self.comparisons else "",
        }


def conclude(comparisons: Sequence[Comparison], bounds: str, kind: ClaimKind = "statement") -> Conclusion:
    """Confirmed if every comparison holds; within bounds if bounds are stated, all comparisons inside them hold and
    there is one; else refuted, or a misprint. A remark compares nothing; a claim without comparisons is undecided.
    """
    if kind == "remark":
        return Conclusion.REMARK
    if not comparisons:
        return Conclusion.UNDECIDED
    if all(one.holds for one in comparisons):
        return Conclusion.CONFIRMED
    inside = [one.holds for one in comparisons if one.inside]
    if bounds and inside and all(inside):
        return Conclusion.BOUNDED
    return Conclusion.MISPRINT if kind == "print" else Conclusion.REFUTED


def counts_in_words(comparisons: Sequence[Comparison], bounds: str) -> str:
    """How many comparisons hold, in all and inside the bounds."""
    holding = sum(one.holds for one in comparisons)
    text = f"{holding} of {len(comparisons)} comparisons hold"
    if bounds and holding < len(comparisons):
        inside = [one.holds for one in comparisons if one.inside]
        text += f"; {sum(inside)} of {len(inside)} inside the bounds"
    return text


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A sentence, equation or number of the paper that a run or a closed form can check."""

    name: str  #: short, stable: anchor in the page, option of the command
    section: str
    quote: str
    tried: str  #: how it is checked, in a sentence
    check: Callable[[Experiments], Finding]


#: what the check of a claim yields, in any order; text is the reading
Evidence = Iterator[Comparison | PaperCase | ClaimTable | ClaimFigure | VariantBand | str]
Kind = TypeVar("Kind")


def claim(
    section: str, quote: str, *, bounds: str = "", kind: ClaimKind = "statement"
) -> Callable[[Callable[[Experiments], Evidence]], Claim]:
    """Decorator: make a claim of the function that yields the evidence for and against it.

    The function gives the claim its name, with dashes, and its docstring says how it is checked. `bounds` are those of
    the comparisons marked `inside`.
    """

    def claimed_by(function: Callable[[Experiments], Evidence]) -> Claim:
        def check(experiments: Experiments) -> Finding:
            found = list(function(experiments))

            def of(kind: type[Kind]) -> list[Kind]:
                return [one for one in found if isinstance(one, kind)]

            return Finding(
                comparisons=of(Comparison),
                reading=" ".join(of(str)),
                bounds=bounds,
                kind=kind,
                cases=of(PaperCase),
                tables=of(ClaimTable),
                figures=of(ClaimFigure),
                band=next(iter(of(VariantBand)), None),
            )

        name = function.__name__.replace("_", "-")
        tried = " ".join((function.__doc__ or "").split())
        return Claim(name=name, section=section, quote=quote, tried=tried, check=check)

    return claimed_by
