"""Rows of the verification table: a value, its reference, and how near the value must be.

A reference is `analytic` (a closed form, or a statement such as symmetry), `printed` (in the literature) or
`computed` (by code that shares nothing with what is checked, or as a converged limit). A row passes if its error is
within its tolerance and its observed order of convergence is the expected one, as far as either is given.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any, Literal, SupportsFloat

import numpy as np

Kind = Literal["analytic", "printed", "computed"]


@dataclass(frozen=True, kw_only=True)
class Convergence:
    """Errors over a refinement, and the order at which they must fall."""

    against: str  #: what was refined, with its unit
    sizes: tuple[float, ...]  #: of the refinement, all positive
    errors: tuple[float, ...]
    expected: float  #: order
    tolerance: float  #: of the order
    at_least: bool = False  #: a higher order passes as well

    @property
    def observed(self) -> float:
        """Slope of log(error) over log(size), least squares; nan if an error is not positive."""
        if not min(self.errors) > 0.0:
            return math.nan
        return float(np.polyfit(np.log(self.sizes), np.log(self.errors), 1)[0])

    @property
    def finest(self) -> float:
        """The error at the smallest size."""
        return self.errors[int(np.argmin(self.sizes))]

    @property
    def passed(self) -> bool:
        """Whether the observed order is the expected one."""
        difference = self.observed - self.expected
        return difference >= -self.tolerance and (self.at_least or difference <= self.tolerance)


def convergence(
    against: str,
    errors: Mapping[float, SupportsFloat],
    *,
    order: float,
    within: float,
    at_least: bool = False,
) -> Convergence:
    """Errors by size, and the order that they must have `within` a tolerance."""
    return Convergence(
        against=against,
        sizes=tuple(float(size) for size in errors),
        errors=tuple(float(error) for error in errors.values()),
        expected=order,
        tolerance=within,
        at_least=at_least,
    )


@dataclass(frozen=True, kw_only=True)
class Row:
    """A comparison; the error is absolute, or relative to the reference."""

    case: str
    compared: str  #: quantity, with its unit
    value: float
    reference: float
    kind: Kind
    source: str  #: of the reference
    tolerance: float | None  #: None: judged by its order alone
    relative: bool = False
    convergence: Convergence | None = None
    note: str = ""

    @property
    def error(self) -> float:
        """|value - reference|, over |reference| if relative; nan if the value is."""
        difference = abs(self.value - self.reference)
        return difference / abs(self.reference) if self.relative else difference

    @property
    def passed(self) -> bool:
        """Whether error and order are as required."""
        if self.tolerance is not None and not self.error <= self.tolerance:  # nan does not pass
            return False
        return self.convergence is None or self.convergence.passed

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data; a number that is not finite becomes None."""
        document = asdict(self) | {"error": self.error, "passed": self.passed}
        if self.convergence is not None:
            document["convergence"]["observed"] = self.convergence.observed
        return {key: _plain(value) for key, value in document.items()}


def row(
    kind: Kind,
    case: str,
    compared: str,
    value: SupportsFloat | None = None,
    reference: SupportsFloat = 0.0,
    *,
    source: str,
    absolute: float | None = None,
    relative: float | None = None,
    convergence: Convergence | None = None,
    note: str = "",
) -> Row:
    """A row with an `absolute` or a `relative` tolerance, an order of convergence, or both.

    The reference of a difference is zero; the value of a convergence, if not given, is its finest error.
    """
    if value is None:
        value = math.nan if convergence is None else convergence.finest
    return Row(
        case=case,
        compared=compared,
        value=float(value),
        reference=float(reference),
        kind=kind,
        source=source,
        tolerance=absolute if relative is None else relative,
        relative=relative is not None,
        convergence=convergence,
        note=note,
    )


analytic = partial(row, "analytic")
printed = partial(row, "printed")
computed = partial(row, "computed")


@dataclass(frozen=True, kw_only=True)
class Check:
    """Rows that are computed together; the title is the statement that they prove."""

    topic: str
    title: str
    rows: Callable[[], Iterable[Row]]
    quick: bool = True  #: computed with `--quick` as well


def check(topic: str, title: str, *, quick: bool = True) -> Callable[[Callable[[], Iterator[Row]]], Check]:
    """Make a check of a generator of rows; `fem.evidence.verification.suite` collects the checks of a module."""
    return lambda rows: Check(topic=topic, title=title, rows=rows, quick=quick)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
