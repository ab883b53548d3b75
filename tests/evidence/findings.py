"""A number of the program beside its reference or limit, and whether it holds: the row of every table of evidence.

A reference is `analytic` (a closed form, or a statement such as symmetry), `printed` (in the literature), `computed`
(by code that shares nothing with what is checked, or as a converged limit), `measured` (in a laboratory), or a `limit`.
"""

import math
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import KW_ONLY, dataclass
from functools import partial
from typing import Any, Literal, SupportsFloat, TypeVar

import numpy as np

Kind = Literal["analytic", "printed", "computed", "measured", "limit"]
Value = float | str
ResultT = TypeVar("ResultT")


@dataclass(frozen=True)
class Convergence:
    """Errors over a refinement, and the order at which they must fall."""

    against: str  #: what was refined, with its unit
    errors: Mapping[float, SupportsFloat]  #: by the size of the refinement, all positive
    _: KW_ONLY
    order: float  #: expected
    within: float  #: tolerance of the order
    at_least: bool = False  #: a higher order passes as well

    @property
    def observed(self) -> float:
        """Slope of log(error) over log(size), least squares; nan if an error is not positive."""
        errors = [float(error) for error in self.errors.values()]
        if not min(errors) > 0.0:
            return math.nan
        return float(np.polyfit(np.log(list(self.errors)), np.log(errors), 1)[0])

    @property
    def finest(self) -> float:
        """The error at the smallest size."""
        return float(self.errors[min(self.errors)])

    @property
    def passed(self) -> bool:
        """Whether the observed order is the expected one."""
        difference = self.observed - self.order
        return difference >= -self.within and (self.at_least or difference <= self.within)

    @property
    def document(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "against": self.against,
            "sizes": list(self.errors),
            "errors": list(self.errors.values()),
            "expected": self.order,
            "tolerance": self.within,
            "at_least": self.at_least,
            "observed": self.observed,
        }


@dataclass(frozen=True)
class Finding:
    """A comparison; it holds by its numbers, or by a criterion in words that was set beforehand."""

    what: str  #: quantity, with its unit if `unit` has none
    value: Value
    reference: Value = 0.0  #: or limit
    unit: str = "-"
    _: KW_ONLY
    kind: Kind = "limit"  #: of the reference
    relation: Literal["=", "<=", ">="] = "="
    tolerance: float | None = 0.0  #: of "="; None: the order or a criterion decides
    relative: bool = False  #: tolerance and error are shares of the reference
    convergence: Convergence | None = None
    criterion: str = ""
    met: bool | None = None  #: the criterion; None: stated and not judged
    case: str = ""  #: what was computed
    source: str = ""  #: of the reference
    note: str = ""
    telling: bool = False  #: not judged, but named with the findings that are
    inside: bool = True  #: within the stated bounds of its claim

    def __post_init__(self) -> None:
        if self.kind == "limit":  # of a count, a truth value or a numpy number
            object.__setattr__(self, "value", float(self.value))
            object.__setattr__(self, "reference", float(self.reference))

    @property
    def name(self) -> str:
        """What was compared, of what case."""
        return f"{self.case}: {self.what}" if self.case else self.what

    @property
    def error(self) -> float:
        """|value - reference|, over |reference| if relative; nan if the value is, or where either is text."""
        if isinstance(self.value, str) or isinstance(self.reference, str):
            return math.nan
        difference = abs(self.value - self.reference)
        return difference / abs(self.reference) if self.relative else difference

    @property
    def holds(self) -> bool | None:
        """Whether relation, tolerance, order and criterion hold, as far as they are given; never for nan."""
        if self.kind == "measured":
            return self.met
        value, reference = float(self.value), float(self.reference)
        if self.relation != "=":
            return value <= reference if self.relation == "<=" else value >= reference
        if self.tolerance is not None and not self.error <= self.tolerance:
            return False
        return self.convergence is None or self.convergence.passed

    def document(self, names: Mapping[str, str]) -> dict[str, Any]:
        """Plain data for JSON: attributes under the keys of a suite."""
        return {key: getattr(self, name) for key, name in names.items()}


at_most = partial(Finding, relation="<=")
at_least = partial(Finding, relation=">=")
prediction = partial(Finding, kind="measured", tolerance=None)


def equal(
    what: str, value: Value, limit: float, tolerance: float, unit: str = "-", *, inside: bool = True
) -> Finding:
    """The value must be within an absolute tolerance of the limit."""
    return Finding(what, value, limit, unit, tolerance=tolerance, inside=inside)


def referred(
    kind: Kind,
    case: str,
    what: str,
    value: SupportsFloat | None = None,
    reference: SupportsFloat = 0.0,
    *,
    source: str,
    absolute: float | None = None,
    relative: float | None = None,
    convergence: Convergence | None = None,
    note: str = "",
) -> Finding:
    """A value against a reference, with an `absolute` or a `relative` tolerance, an order of convergence, or both.

    The reference of a difference is zero; the value of a convergence, if not given, is its finest error.
    """
    if value is None:
        value = math.nan if convergence is None else convergence.finest
    return Finding(
        what,
        float(value),
        float(reference),
        kind=kind,
        case=case,
        source=source,
        tolerance=absolute if relative is None else relative,
        relative=relative is not None,
        convergence=convergence,
        note=note,
    )


analytic = partial(referred, "analytic")
printed = partial(referred, "printed")
computed = partial(referred, "computed")


def failures(findings: Iterable[Finding]) -> int:
    """Number of findings that do not hold."""
    return sum(finding.holds is False for finding in findings)


def attempted(work: Callable[[], ResultT]) -> tuple[ResultT | None, str, float]:
    """Result of some work, or None and the reason why there is none; and its time [s]."""
    began = time.perf_counter()
    result, reason = None, ""
    try:
        result = work()
    except (ArithmeticError, ValueError, RuntimeError, LookupError, TypeError) as error:
        reason = f"{type(error).__name__}: {error}"
    return result, reason, time.perf_counter() - began
