"""A claim of the paper, what its check showed, and the rule from comparisons to a conclusion.

A conclusion is never written down: it follows from findings, which compare numbers with limits, by `conclude`.
Rotation > 0 tilts toward +x; SI units, each with its number.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from enum import Enum
from typing import Any, Literal, TypeVar

from evidence.findings import Finding, failures
from paper.cases import PaperCase
from paper.experiments import Experiments, VariantBand


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


#: keys of a comparison in study.json, with the attributes of the finding that they hold
KEYS = {"measured": "value", "limit": "reference"} | {
    name: name for name in ("what", "relation", "unit", "tolerance", "inside", "holds")
}


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
class ClaimResult:
    """What the check of a claim showed."""

    comparisons: Sequence[Finding]
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
            "comparisons": [finding.document(KEYS) for finding in self.comparisons],
            "reading": self.reading,
            "bounds": self.bounds,
            "setups": [{"what": case.what, "command": case.command} for case in self.cases],
            "tables": [asdict(table) for table in self.tables],
            "drawings": [{"name": figure.name, "caption": figure.caption} for figure in self.figures],
            "band": None if self.band is None else self.band.to_dict(),
            "verdict": self.conclusion.value,
            "rule": counts_in_words(self.comparisons, self.bounds) if self.comparisons else "",
        }


def conclude(comparisons: Sequence[Finding], bounds: str, kind: ClaimKind = "statement") -> Conclusion:
    """Confirmed if every comparison holds; within bounds if bounds are stated, all comparisons inside them hold and
    there is one; else refuted, or a misprint. A remark compares nothing; a claim without comparisons is undecided.
    """
    if kind == "remark":
        return Conclusion.REMARK
    if not comparisons:
        return Conclusion.UNDECIDED
    if all(finding.holds for finding in comparisons):
        return Conclusion.CONFIRMED
    inside = [finding.holds for finding in comparisons if finding.inside]
    if bounds and inside and all(inside):
        return Conclusion.BOUNDED
    return Conclusion.MISPRINT if kind == "print" else Conclusion.REFUTED


def counts_in_words(comparisons: Sequence[Finding], bounds: str) -> str:
    """How many comparisons hold, in all and inside the bounds."""
    failed = failures(comparisons)
    text = f"{len(comparisons) - failed} of {len(comparisons)} comparisons hold"
    if bounds and failed:
        inside = [finding for finding in comparisons if finding.inside]
        text += f"; {len(inside) - failures(inside)} of {len(inside)} inside the bounds"
    return text


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A sentence, equation or number of the paper that a run or a closed form can check."""

    name: str  #: short, stable: anchor in the page, option of the command
    section: str
    quote: str
    tried: str  #: how it is checked, in a sentence
    check: Callable[[Experiments], ClaimResult]


#: what the check of a claim yields, in any order; text is the reading
Evidence = Iterator[Finding | PaperCase | ClaimTable | ClaimFigure | VariantBand | str]
Kind = TypeVar("Kind")


def claim(
    section: str, quote: str, *, bounds: str = "", kind: ClaimKind = "statement"
) -> Callable[[Callable[[Experiments], Evidence]], Claim]:
    """Decorator: make a claim of the function that yields the evidence for and against it.

    The function gives the claim its name, with dashes, and its docstring says how it is checked. `bounds` are those of
    the comparisons marked `inside`.
    """

    def claimed_by(function: Callable[[Experiments], Evidence]) -> Claim:
        def check(experiments: Experiments) -> ClaimResult:
            evidence = list(function(experiments))

            def of(kind: type[Kind]) -> list[Kind]:
                return [item for item in evidence if isinstance(item, kind)]

            return ClaimResult(
                comparisons=of(Finding),
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
