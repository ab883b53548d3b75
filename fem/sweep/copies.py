"""The copies that a cell of a sweep may have: what each changes, by a name that is the same in every cell.

Small changes of motion and contact (`perturbation`), and the changes by which a run tries its unknown inputs
(`fem.case.uncertainty`). An input that is an axis is not varied: its effect is what the sweep shows.
"""

from collections import Counter
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from fem.batch.container_cache import container_key
from fem.case.case import Case
from fem.case.tables.input_keys import SUPPORT, TOLERANCE
from fem.case.uncertainty import InputChange, all_changes, as_changed
from fem.model.geometry import build_container
from fem.model.motion import build_motions
from fem.model.support import normal_penalty
from fem.run.solve import chosen_values
from fem.sweep.perturbation import SMALL
from fem.sweep.plan import Sweep
from mesh.container import ContainerMesh

#: cells of which the copies are remembered
REMEMBERED = 4096
#: draws of a cell over those of the band of a run
SHARE_OF_DRAWS = 0.25
#: what the copies of a deformable container, which take twenty times as long, leave out
LEFT_OUT = (
    "values between the ends of a range, pairs, draws of all inputs at once, a tighter energy tolerance"
)


def left_out(sweep: Sweep) -> str:
    """What the copies of a sweep leave out of the band of a run, in words; nothing where they leave out nothing."""
    chosen, rigid = sweep.perturbation.cells, sweep.base.solver.model == "rigid"
    if chosen == "none" or (chosen == "auto" and sweep.base.solver.model == "full"):
        return "all"
    cells = "cells away from a change of outcome" if chosen == "near" else ""
    return ", ".join(filter(None, (cells, "contact of the base", "" if rigid else LEFT_OUT)))


@dataclass(frozen=True, kw_only=True)
class Copy:
    """What a copy of a cell changes."""

    name: str  #: of the change, the same in all cells: its keys, and which one of these it is
    change: InputChange
    #: that make its case of that of the cell: the change, and what a run of the cell chose
    values: Mapping[str, Any]

    @property
    def drawn(self) -> bool:
        """Whether it changes all unknown inputs at once."""
        return self.change.kind == "draw"

    @property
    def small(self) -> bool:
        """Whether it is a small change, which matters near a change of outcome alone."""
        return self.change.share == SMALL


class CellCopies:
    """The copies of the cells of a sweep; those asked for last are remembered."""

    def __init__(self, sweep: Sweep) -> None:
        self._sweep = sweep
        self._axes = {axis.key for axis in sweep.axes}
        self._known: dict[int, tuple[float, tuple[Copy, ...]]] = {}
        self._mesh: tuple[Hashable, ContainerMesh] | None = None  #: the last one, and its key

    def of(self, cell: int) -> tuple[Copy, ...]:
        """The copies of a cell: each change once, the draws last."""
        return self._of(cell)[1]

    def width(self, cell: int) -> float:
        """Width of the container of a cell [m]."""
        return self._of(cell)[0]

    def _of(self, cell: int) -> tuple[float, tuple[Copy, ...]]:
        if cell not in self._known:
            if len(self._known) >= REMEMBERED:
                self._known.clear()
            case = self._sweep.case(cell)
            self._known[cell] = case.stack[0].width, tuple(self._copies(case))
        return self._known[cell]

    def _copies(self, case: Case) -> Iterator[Copy]:
        seen: list[object] = []
        count = Counter[str]()
        mesh = self._mesh_of(case)
        chosen = chosen_values(case, mesh, build_motions(case))
        penalty = None if case.floor.is_slab else normal_penalty(case, mesh)
        for change in (*self._sweep.perturbation.changes(case), *self._over_ranges(case, penalty)):
            if change.values and change.values not in seen:
                seen.append(change.values)
                keys = "draw" if change.kind == "draw" else " ".join(change.values)
                values = chosen | as_changed(case, change.values)
                yield Copy(name=f"{keys} {count[keys]}", change=change, values=values)
                count[keys] += 1

    def _mesh_of(self, case: Case) -> ContainerMesh:
        key = container_key(case)
        if self._mesh is None or self._mesh[0] != key:
            self._mesh = key, build_container(case)
        return self._mesh[1]

    def _over_ranges(self, case: Case, penalty: float | None) -> Iterator[InputChange]:
        """The changes of a run's band, without the inputs that are axes."""
        count = self._sweep.perturbation.draws
        if count is None:
            count = round(SHARE_OF_DRAWS * case.uncertainty.draws)
        changes, pairs, draws = all_changes(case, penalty, count)
        if case.solver.model == "rigid":
            changes = (*changes, *pairs, *draws)
        else:
            changes = tuple(
                change for change in changes if change.share == 1.0 and TOLERANCE not in change.values
            )
        for change in changes:
            if SUPPORT in change.values:  # as a rule takes longer than all other copies together
                continue
            kept = {key: value for key, value in change.values.items() if key not in self._axes}
            coordinates = zip(change.values, change.place, strict=False)
            yield replace(change, values=kept, place=tuple(x for key, x in coordinates if key in kept))
