"""A claim of the paper, what its check showed, and the rule from comparisons to a conclusion.

A conclusion is never written down: it follows from findings, which compare numbers with limits, by `conclude`.
Rotation > 0 tilts toward +x; SI units, each with its number.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import Enum
from typing import Any, Literal, NamedTuple, TypeVar

from evidence.findings import Finding, failures
from evidence.pages import Picture
from matplotlib.figure import Figure
from paper.cases import PaperCase
from paper.experiments import Experiments, VariantBand

from fem.figures.style import GREY, WIDTH, house_style, svg_of
from fem.runtime.arrays import FloatArray


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


#: distinguishable without colour vision (Okabe and Ito) and dark enough on white
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#7a4d9f", "#333333", "#b8860b")
HEIGHT = 3.3  #: [inch]


class Curve(NamedTuple):
    """A line, or points where the style of matplotlib says so."""

    x: Sequence[float] | FloatArray
    y: Sequence[float] | FloatArray
    label: str = ""
    style: str = "-"


def draw_curves(
    name: str,
    caption: str,
    labels: str,
    lines: Sequence[Curve],
    *,
    levels: Mapping[str, float] | None = None,
    log_x: bool = False,
    y_limits: tuple[float, float] | None = None,
) -> Picture:
    """Curves over one pair of axes, labelled "x | y"; `levels` are horizontal lines with a name."""
    with house_style():
        figure = Figure(figsize=(WIDTH, HEIGHT), layout="constrained")
        across, up = labels.split(" | ")
        axes = figure.add_subplot(xlabel=across, ylabel=up)
        for line, colour in zip(lines, COLOURS * (1 + len(lines) // len(COLOURS)), strict=False):
            axes.plot(line.x, line.y, line.style, color=colour, label=line.label, linewidth=1.4, markersize=4)
        for text, level in (levels or {}).items():
            axes.axhline(level, color=GREY, linewidth=0.8, linestyle=":")
            coordinates = ("axes fraction", "data")
            axes.annotate(text, (1.0, level), xycoords=coordinates, ha="right", va="bottom", color=GREY)
        if log_x:
            axes.set_xscale("log")
        if y_limits is not None:
            axes.set_ylim(*y_limits)
        if any(line.label for line in lines):
            figure.legend(loc="outside lower center", ncols=4)
        axes.margins(x=0.02)
    return Picture(name=name, caption=caption, svg=svg_of(figure))


@dataclass(frozen=True, kw_only=True)
class ClaimResult:
    """What the check of a claim showed."""

    comparisons: Sequence[Finding]
    reading: str  #: what the numbers say, in a sentence or two
    bounds: str = ""  #: of the comparisons marked `inside`; empty: the claim as the paper makes it
    kind: ClaimKind = "statement"
    cases: Sequence[PaperCase] = ()
    tables: Sequence[ClaimTable] = ()
    figures: Sequence[Picture] = ()
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
            "rule": self.rule if self.comparisons else "",
        }

    @property
    def rule(self) -> str:
        """How many comparisons hold, in all and inside the bounds."""
        failed, count = failures(self.comparisons), len(self.comparisons)
        inside = [finding for finding in self.comparisons if finding.inside]
        within = f"; {len(inside) - failures(inside)} of {len(inside)} inside the bounds"
        return f"{count - failed} of {count} comparisons hold" + (within if self.bounds and failed else "")


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


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A sentence, equation or number of the paper that a run or a closed form can check."""

    name: str  #: short, stable: anchor in the page, option of the command
    section: str
    quote: str
    tried: str  #: how it is checked, in a sentence
    check: Callable[[Experiments], ClaimResult]


#: what the check of a claim yields, in any order; text is the reading
Evidence = Iterator[Finding | PaperCase | ClaimTable | Picture | VariantBand | str]
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
                figures=of(Picture),
                band=next(iter(of(VariantBand)), None),
            )

        name = function.__name__.replace("_", "-")
        tried = " ".join((function.__doc__ or "").split())
        return Claim(name=name, section=section, quote=quote, tried=tried, check=check)

    return claimed_by
