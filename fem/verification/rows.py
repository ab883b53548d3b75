"""One row of the verification table: what is compared with what, how near it must come, and whether it does.

The reference is `analytic` (a closed form, or a statement such as symmetry), `printed` (by somebody else) or
`computed` (by code that shares nothing with what is checked: an event-driven integration, a converged limit). A
row is judged by its error against its tolerance, by its observed order of convergence, or by both.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

Kind = Literal["analytic", "printed", "computed"]


@dataclass(frozen=True, kw_only=True)
class Convergence:
    """Errors against what was refined, and the order at which they are to fall."""

    against: str  #: what was refined, with its unit
    sizes: tuple[float, ...]  #: of the refinement, all positive
    errors: tuple[float, ...]
    expected: float  #: order
    tolerance: float  #: of the order
    at_least: bool = False  #: a higher order passes as well

    @property
    def observed(self) -> float:
        """Slope of log(error) over log(size), least squares; nan where an error is not positive."""
        if not min(self.errors) > 0.0:
            return math.nan
        return float(np.polyfit(np.log(self.sizes), np.log(self.errors), 1)[0])

    @property
    def passed(self) -> bool:
        """Whether the observed order is the expected one."""
        difference = self.observed - self.expected
        return difference >= -self.tolerance and (self.at_least or difference <= self.tolerance)


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
        """Within the tolerance and of the expected order, as far as either is asked for."""
        if self.tolerance is not None and not self.error <= self.tolerance:  # nan does not pass
            return False
        return self.convergence is None or self.convergence.passed

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data; what is not a finite number becomes None."""
        document = asdict(self) | {"error": self.error, "passed": self.passed}
        if self.convergence is not None:
            document["convergence"]["observed"] = self.convergence.observed
        return {key: _plain(value) for key, value in document.items()}


@dataclass(frozen=True, kw_only=True)
class Check:
    """Rows that are computed together, named after the statement they prove."""

    name: str
    rows: Callable[[], list[Row]]
    quick: bool = True  #: part of the quick ladder


def count_row(*, case: str, compared: str, wrong: int, kind: Kind, source: str, note: str = "") -> Row:
    """A row of a statement that is true or false many times over: how often it was false."""
    return Row(
        case=case,
        compared=compared,
        value=float(wrong),
        reference=0.0,
        kind=kind,
        source=source,
        tolerance=0.0,
        note=note,
    )


def order_row(
    *,
    case: str,
    compared: str,
    convergence: Convergence,
    kind: Kind,
    source: str,
    tolerance: float | None = None,
    note: str = "",
) -> Row:
    """A row of errors that must vanish at an order; its value is the error at the finest."""
    finest = convergence.errors[int(np.argmin(convergence.sizes))]
    return Row(
        case=case,
        compared=compared,
        value=finest,
        reference=0.0,
        kind=kind,
        source=source,
        tolerance=tolerance,
        convergence=convergence,
        note=note,
    )


def failed_row(check: Check, error: Exception) -> Row:
    """The row of a check that could not be computed."""
    return Row(
        case=check.name,
        compared="computed at all",
        value=math.nan,
        reference=0.0,
        kind="analytic",
        source="",
        tolerance=0.0,
        note=f"{type(error).__name__}: {error}",
    )


def as_floats(values: Sequence[float]) -> tuple[float, ...]:
    """Plain floats, for tuples that end in JSON."""
    return tuple(float(value) for value in values)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
