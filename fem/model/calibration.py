"""The contact that gives a stated restitution: `contact.restitution_over_housner`, found by free rocking.

A rigid container loses at an impact what Housner's block loses if its corners neither bounce nor sink in (Housner,
BSSA 53, 1963). So more than that is left by a dashpot smaller than the usual one, and less by a softer floor under the
usual dashpot. The search goes from the usual contact outwards, until the restitution is passed, and then bisects.
Restitution is the root of the ratio of the potential energies above rest at the turning points after and before the
first impact of a container released from half its slenderness angle: bounces belong to the impact. In smaller
swings a soft floor takes more. What is possible depends on support and slenderness.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np

from fem.case.case import Case, CaseError
from fem.case.floors import FloorTable
from fem.case.quantities import RESTITUTION
from fem.case.tables import ContactTable, InitialTable, MotionTable, OutputTable, SolverTable, VerticalTable
from fem.model.container import Container
from fem.model.static_checks import CREDIBLE_RESTITUTION, StaticChecks, static_checks_of
from fem.model.support import normal_penalty
from fem.solid.reduction import ReducedBasis

USUAL_DAMPING = 2.0  #: ratio with which two stiff corners give Housner's restitution
LEAST_DAMPING = 0.02  #: below, corners bounce on and on, and what is left changes irregularly
#: sinking under the weight over width times slenderness angle, at most: a tenth of what makes a soft floor unstable
MOST_SINKING = 0.05
REFINEMENT = 10.0**0.125  #: from one contact of the search to the next
BISECTIONS = 14
LEAST_RATIO = RESTITUTION.least or 0.0  #: that a case may state
CLOSE_ENOUGH = 1e-3  #: to the restitution asked for
TOLERANCE = 0.1  #: of the energy balance: with larger steps the restitution of a soft floor scatters
#: time in which a container released from half its slenderness angle has turned round twice [1/p]
TWO_SWINGS = 6.0


@dataclass(frozen=True, kw_only=True)
class RockingContact:
    """What decides the restitution of a rigid container."""

    penalty: float  #: normal stiffness of the base over width times depth [Pa/m]
    damping_ratio: float  #: c/(2 sqrt(k m)), the whole mass on the spring of one corner [-]


class RestitutionError(ValueError):
    """No contact of the support gives the restitution; nan where it does not swing back at all."""

    def __init__(self, least: float, most: float) -> None:
        super().__init__(f"{least:.4g} to {most:.4g}")
        self.least, self.most = float(least), float(most)


#: contacts found, by container and by what else decides them
_FOUND = WeakKeyDictionary[Container, dict[tuple[float, ...], RockingContact]]()


def found_contact(case: Case, container: Container, restitution: Callable[[Case, Container], float]) -> Case:
    """The case with the penalty and the damping ratio that give its `restitution_over_housner`.

    They are those of the rigid container, whatever its model; one that deforms loses more.

    Args:
        restitution: of the first impact of a case; nan where the container does not swing back.

    Raises:
        CaseError: its support does not give that restitution.
    """
    ratio = case.contact.restitution_over_housner
    assert ratio is not None
    known = _FOUND.setdefault(container, {})
    key = (ratio, case.gravity_m_s2, case.contact.tangential_ratio)
    if key not in known:
        known[key] = _search(case, container, ratio, restitution)
    return _on(case, known[key])


def _search(
    case: Case, container: Container, ratio: float, restitution: Callable[[Case, Container], float]
) -> RockingContact:
    """The contact with which the rigid container has a restitution of this ratio to Housner's."""
    none = ReducedBasis(angular_frequencies=np.zeros(0), shapes=container.basis.shapes[:0])
    rigid = replace(container, basis=none, free_modes=0, first=math.inf)
    mesh, static = container.mesh, static_checks_of(case, container.mesh, 0.0)
    housner = static.housner_restitution
    released = _released(case, static)
    area = float(container.support.normal_stiffness(1.0).sum())
    deepest = MOST_SINKING * mesh.width * static.slenderness_angle
    try:
        return find_contact(
            ratio * housner
            if static.housner_credible
            else math.inf,  # of which the search fails with the range
            penalty=normal_penalty(case, mesh),
            softest=static.weight / (deepest * area),
            restitution=lambda contact: restitution(_on(released, contact), rigid),
        )
    except RestitutionError as error:
        stated = f"[contact] restitution_over_housner = {ratio:g}: "
        if not static.housner_credible:
            raise CaseError(
                f"{stated}the container is too squat: Housner's restitution is {housner:.3g}, below "
                f"{CREDIBLE_RESTITUTION:g}, and no measure of its impacts, which leave {error.least:.3g} to "
                f"{error.most:.3g} in all on this support; give damping_ratio"
            ) from None
        least, most = max(LEAST_RATIO, error.least / housner), error.most / housner
        jumps = f", but not {ratio:g}, where another bounce begins" if least < ratio < most else ""
        raise CaseError(
            f"{stated}with the softness and damping of its contact, this container on {case.support.kind} can have "
            f"{least:.4g} to {most:.4g} times Housner's restitution, {housner:.4g}{jumps}; choose a value that it can "
            "have, or give damping_ratio"
        ) from None


def _released(case: Case, static: StaticChecks) -> Case:
    """The rigid container at half its slenderness angle on a level floor at rest, with friction that holds."""
    tables = {
        "contact": ContactTable(mu_static=2.0, tangential_ratio=case.contact.tangential_ratio),
        "floor": FloorTable(),
        "motion": MotionTable(kind="none"),
        "vertical": VerticalTable(),
        "initial": InitialTable(rotation_rad=0.5 * static.slenderness_angle),
        "solver": SolverTable(
            model="rigid",
            energy_tolerance=TOLERANCE,
            duration_s=TWO_SWINGS / static.frequency_parameter,
            element_size_m=case.solver.element_size_m,
            order=case.solver.order,
        ),
        "output": OutputTable(fields_s=0.0, stop_when_overturned=case.output.stop_when_overturned),
    }
    return case.model_copy(update=tables)


def _on(case: Case, found: RockingContact) -> Case:
    """The case on a contact in numbers."""
    numbers = {
        "restitution_over_housner": None,
        "normal_penalty_Pa_m": found.penalty,
        "damping_ratio": found.damping_ratio,
    }
    return case.model_copy(update={"contact": case.contact.model_copy(update=numbers)})


def find_contact(
    wanted: float, *, penalty: float, softest: float, restitution: Callable[[RockingContact], float]
) -> RockingContact:
    """The contact that gives a restitution and is nearest to the usual one; six digits of its numbers.

    Args:
        wanted: restitution [-].
        penalty: of the usual contact [Pa/m]; softest: least penalty [Pa/m].
        restitution: of a contact, by free rocking; nan where the container does not swing back.

    Raises:
        RestitutionError: none gives it.
    """
    usual = RockingContact(penalty=penalty, damping_ratio=USUAL_DAMPING)
    start = restitution(usual)
    paths = (_softer(usual, softest), -1.0), (_less_damped(usual), 1.0)
    here, below, values = usual, start < wanted, [start]
    for further, value in _monotone(*paths[below], start, restitution):
        values.append(value)
        if (value < wanted) != below:
            found = _between(here, further, wanted, restitution)
            if abs(restitution(found) - wanted) <= CLOSE_ENOUGH:  # else it jumps: another bounce
                return found
            below = not below
        here = further
    values += [value for _, value in _monotone(*paths[start >= wanted], start, restitution)]
    raise RestitutionError(np.nanmin(values), np.nanmax(values))


def _monotone(
    path: Iterator[RockingContact],
    sign: float,
    start: float,
    restitution: Callable[[RockingContact], float],
) -> Iterator[tuple[RockingContact, float]]:
    """The contacts of a path with their restitutions, until these turn back or end.

    Beyond, a foot or bed is so soft that its springs throw the container, or a corner bounces once more.
    """
    before, went = start, False
    for contact in path:
        value = restitution(contact)
        goes = sign * (value - before)
        if math.isnan(value) or (went and goes < 0.0):
            return
        before, went = value, went or goes > 0.0
        yield contact, value


def _between(
    low: RockingContact, high: RockingContact, wanted: float, restitution: Callable[[RockingContact], float]
) -> RockingContact:
    """Bisects between two contacts, on whose two sides the restitution lies."""
    rises = restitution(low) < wanted
    for _ in range(BISECTIONS):
        middle = _mean(low, high)
        if (restitution(middle) < wanted) == rises:
            low = middle
        else:
            high = middle
    return _mean(low, high)


def _mean(one: RockingContact, other: RockingContact) -> RockingContact:
    return RockingContact(
        penalty=_short(math.sqrt(one.penalty * other.penalty)),
        damping_ratio=_short(math.sqrt(one.damping_ratio * other.damping_ratio)),
    )


def _softer(usual: RockingContact, softest: float) -> Iterator[RockingContact]:
    penalty = usual.penalty / REFINEMENT
    while penalty >= softest:
        yield RockingContact(penalty=penalty, damping_ratio=usual.damping_ratio)
        penalty /= REFINEMENT


def _less_damped(usual: RockingContact) -> Iterator[RockingContact]:
    ratio = usual.damping_ratio / REFINEMENT
    while ratio >= LEAST_DAMPING:
        yield RockingContact(penalty=usual.penalty, damping_ratio=ratio)
        ratio /= REFINEMENT


def _short(value: float) -> float:
    """Six digits."""
    return float(f"{value:.6g}")
