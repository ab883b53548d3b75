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
        self._recoveries = WeakKeyDictionary[Container, Recovery]()

    def container_of(self, case: Case) -> Container:
        """The container of a case, built if it is missing; from one that differs little, where that serves."""
        key = container_key(case)
        with self._lock:
            earlier = self._held.pop(key, None)
            promise = earlier or Future[Container]()
            self._held[key] = promise  # the one used last is last
            while len(self._held) > self._most:
                del self._held[next(iter(self._held))]
            if earlier is None:
                alike = container_key(case, mass=case.solver.model != "rigid", gaps=False)
                own, first = self._alike.setdefault(alike, (case, promise))
                while len(self._alike) > self._most:
                    del self._alike[next(iter(self._alike))]
        if earlier is None:
            try:
                unlike = first is promise or first.exception() is not None
                built = discretise(case) if unlike else changed_container(case, first.result(), own)
                promise.set_result(built)
            except BaseException as error:
                promise.set_exception(error)
        return promise.result()

    def recovery_of(self, model: Model) -> Recovery:
        """What recovers the stresses of a model's container; built once a container."""
        recovery = self._recoveries.get(model.container)
        if recovery is None:
            recovery = self._recoveries[model.container] = recovery_of(model)
        return recovery


#: normal penalties, by container and without its modes
_PENALTIES: dict[Hashable, float] = {}


def penalty_of(case: Case) -> float | None:
    """Normal penalty of a case, chosen where it says "auto" [Pa/m]; None of a slab, which has none."""
    if case.floor.is_slab:
        return None
    key = container_key(case), case.contact.normal_penalty_Pa_m
    if key not in _PENALTIES:
        if len(_PENALTIES) >= MOST_PENALTIES:
            _PENALTIES.clear()
        _PENALTIES[key] = normal_penalty(case, build_container(case))
    return _PENALTIES[key]
