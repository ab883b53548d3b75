"""Meshed and reduced containers, shared by the cases that have the same one."""

import threading
from collections.abc import Hashable
from concurrent.futures import Future
from weakref import WeakKeyDictionary

from fem.case.case import Case
from fem.case.tables.links import holder_of
from fem.case.tables.neighbours import OWN
from fem.model.container import Container, changed_container, discretise
from fem.model.geometry import build_container
from fem.model.model import Model
from fem.model.recovery import Recovery, recovery_of
from fem.model.support import normal_penalty

#: values for keys of [support] that say how a container stands on its points
STANDING = {"effective_width": 1.0, "casting_m": None, "rocking_damping_ratio": 0.0}

MOST_PENALTIES = 4096  #: that are remembered


def container_key(case: Case, *, mass: bool = True, gaps: bool = True) -> Hashable:
    """Equal for cases whose containers are the same, whatever floor they stand on and however they are damped.

    `mass`: also the places of their mass; `gaps`: also those of a row.
    """
    solver = case.solver
    places = {} if mass else {"centroid_m": 0.0, "eccentricity_m": 0.0}
    return (
        case.container.model_copy(update={"damping_ratio": 0.0, "corner_post_N": None, **places}),
        case.support.model_copy(update=STANDING),
        case.foot,
        case.gravity_m_s2,
        case.folder,
        solver.model,
        solver.elastic_modes if solver.model == "reduced" else None,
        solver.element_size_m,
        solver.order,
        case.output.stop_when_overturned,
        tuple((link.side, link.height_m, holder_of(case, link)) for link in case.links),
        tuple(
            (
                neighbour.side,
                neighbour.gap_m if gaps else None,
                neighbour.case,
                *(getattr(neighbour, name) for name in OWN),
            )
            for neighbour in case.neighbour
        ),
    )


class ContainerCache:
    """The containers used last; safe for threads, and no container is built twice at once."""

    def __init__(self, most: int = 8) -> None:
        self._most = most
        self._lock = threading.Lock()
        self._held: dict[Hashable, Future[Container]] = {}
        #: containers that serve others as well, with their cases: rigid ones share all but their mass, those of a row
        #: all but their gaps
        self._alike: dict[Hashable, tuple[Case, Future[Container]]] = {}
        #: the one asked for last, with its case: most cases of a study differ in what a container does not depend on
        self._last: tuple[Case, Container] | None = None
        self._recoveries = WeakKeyDictionary[Container, Recovery]()

    def container_of(self, case: Case) -> Container:
        """The container of a case, built if it is missing; from one that differs little, where that serves.

        Raises:
            CaseError, MeshError: bad input.
        """
        with self._lock:
            if self._last is not None and _from_the_same_tables(case, self._last[0]):
                return self._last[1]
        key = container_key(case)
        alike = container_key(case, mass=case.solver.model != "rigid", gaps=False)
        with self._lock:
            earlier = self._held.pop(key, None)
            promise = earlier or Future[Container]()
            self._held[key] = promise  # the one used last is last
            own, first = self._alike.setdefault(alike, (case, promise))
            for held in (self._held, self._alike):
                while len(held) > self._most:
                    del held[next(iter(held))]
        if earlier is None:
            try:
                unlike = first is promise or first.exception() is not None
                built = discretise(case) if unlike else changed_container(case, first.result(), own)
                promise.set_result(built)
            except BaseException as error:
                promise.set_exception(error)
        container = promise.result()
        with self._lock:
            self._last = case, container
        return container

    def recovery_of(self, model: Model) -> Recovery:
        """What recovers the stresses of a model's container; built once a container."""
        recovery = self._recoveries.get(model.container)
        if recovery is None:
            recovery = self._recoveries[model.container] = recovery_of(model)
        return recovery


def _from_the_same_tables(case: Case, other: Case) -> bool:
    """Whether two cases have the very tables, not only equal ones, of which `container_key` is made."""
    tables = ("container", "support", "solver", "stop", "tie", "neighbour")
    return (
        all(getattr(case, name) is getattr(other, name) for name in tables)
        and case.gravity_m_s2 == other.gravity_m_s2
        and case.folder == other.folder
        and case.output.stop_when_overturned == other.output.stop_when_overturned
    )


#: normal penalties, by container and without its modes
_PENALTIES: dict[Hashable, float] = {}


def penalty_of(case: Case) -> float | None:
    """Normal penalty of a case, chosen where it says "auto" [Pa/m]; None of a slab, which has none.

    Raises:
        CaseError, MeshError: bad input.
    """
    if case.floor.is_slab:
        return None
    key = container_key(case), case.contact.normal_penalty_Pa_m
    if key not in _PENALTIES:
        if len(_PENALTIES) >= MOST_PENALTIES:
            _PENALTIES.clear()
        _PENALTIES[key] = normal_penalty(case, build_container(case))
    return _PENALTIES[key]
