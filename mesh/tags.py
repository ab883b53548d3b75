"""The region of every cell of a mesh file, from the names in the file.

Files name groups of cells in different ways. They are searched in this order: named sets of cells (Gmsh 4 physical
groups, Abaqus element sets), Gmsh physical groups by number and name, an integer field `region` with the numbers of
`Region`, one 0/1 field a region (`wall`, `sheet`, ...), and one integer field with a joined name such as
`wall-sheet-fill`, which meshio makes of sets in VTU and VTK. The first one with a known region is used; every cell must
then be in exactly one region.
"""

import difflib
import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mesh.cells import IntArray
from mesh.errors import MeshError
from mesh.region import REGION_NAMES, Region

BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class CellTags:
    """Tags of the `count` quadrilaterals of a file, one value per cell in each array."""

    count: int
    sets: Mapping[str, BoolArray]  #: membership of named sets
    data: Mapping[str, npt.NDArray[np.generic]]  #: named fields
    physical_names: Mapping[int, str]  #: names of the two-dimensional physical groups

    def of(self, cells: IntArray) -> "CellTags":
        """The tags of some of the cells."""
        return CellTags(
            count=len(cells),
            sets={name: members[cells] for name, members in self.sets.items()},
            data={name: values[cells] for name, values in self.data.items()},
            physical_names=self.physical_names,
        )


def cell_regions(tags: CellTags, allowed: tuple[Region, ...]) -> IntArray:
    """Region (m,) of every cell.

    Args:
        tags: names and fields of the file.
        allowed: regions of this section of container.

    Raises:
        MeshError: no tag with the name of a region; a region that the section does not have; cells in no or several
            regions. The message lists the tags found.
    """
    tagged: dict[str, BoolArray] = {}
    for source in (_from_sets, _from_physical_groups, _from_region_field, _from_flags, _from_joined_field):
        groups = {name: cells for name, cells in source(tags).items() if cells.any()}
        tagged = {**groups, **tagged}
        if any(name in REGION_NAMES for name in groups):
            return _one_region_each(groups, tags.count, allowed)
    known = _join([region.name.lower() for region in allowed])
    raise MeshError(
        f"no cell is tagged with a region ({known}); found {_listing(tagged, tags)}: name the groups of cells "
        "(Gmsh physical surfaces, element sets) after the regions"
    )


def _one_region_each(groups: dict[str, BoolArray], count: int, allowed: tuple[Region, ...]) -> IntArray:
    region = np.full(count, -1, dtype=np.int64)
    owners = np.zeros(count, dtype=np.int64)
    for name, cells in groups.items():
        if name in REGION_NAMES:
            region[cells] = REGION_NAMES[name]
            owners[cells] += 1
    listing = _listing(groups, None)
    known = _join([each.name.lower() for each in allowed])
    foreign = [Region(value).name.lower() for value in np.unique(region[region >= 0]) if value not in allowed]
    if foreign:
        raise MeshError(
            f"cells tagged {_join(foreign)} do not belong to this section ({known}); found {listing}"
        )
    if owners.max() > 1:
        raise MeshError(
            f"{int(np.sum(owners > 1))} cells are in several regions, the first is cell "
            f"{int(np.argmax(owners > 1))}; found {listing}: each cell belongs to one of {known}"
        )
    if owners.min() == 0:
        raise MeshError(
            f"{int(np.sum(owners == 0))} cells are in no region, the first is cell {int(np.argmin(owners))}; "
            f"found {listing}: each cell belongs to one of {known}{_suggestion(groups)}"
        )
    return region


def _from_sets(tags: CellTags) -> dict[str, BoolArray]:
    return dict(tags.sets)


def _from_physical_groups(tags: CellTags) -> dict[str, BoolArray]:
    numbers = tags.data.get("gmsh:physical")
    if numbers is None:
        return {}
    return {
        tags.physical_names.get(int(number), f"physical group {number} without a name"): numbers == number
        for number in np.unique(numbers[np.isfinite(numbers)])
    }


def _from_region_field(tags: CellTags) -> dict[str, BoolArray]:
    codes = tags.data.get("region")
    if codes is None:
        return {}
    names = {int(region): name for name, region in REGION_NAMES.items()}
    return {names.get(code, f"region {code}"): codes == code for code in np.unique(codes[np.isfinite(codes)])}


def _from_flags(tags: CellTags) -> dict[str, BoolArray]:
    flags = {name: tags.data[name] for name in REGION_NAMES if name in tags.data}
    for name, values in flags.items():
        if not np.isin(values, (0, 1)).all():
            raise MeshError(
                f"cell field {name} must be 0 or 1 in every cell, got {np.unique(values)[:5].tolist()}"
            )
    return {name: values == 1 for name, values in flags.items()}


def _from_joined_field(tags: CellTags) -> dict[str, BoolArray]:
    for key, values in tags.data.items():
        names = re.split(r"[-_#+/]", key)
        if len(names) > 1 and any(name in REGION_NAMES for name in names):
            return {name: values == number for number, name in enumerate(names)}
    return {}


def _listing(groups: Mapping[str, BoolArray], tags: CellTags | None) -> str:
    listed = [f"{name} ({int(cells.sum())} cells)" for name, cells in groups.items()]
    if tags is not None:
        listed += [f"field {name}" for name in tags.data if name not in ("gmsh:geometrical", "gmsh:physical")]
    return _join(listed) if listed else "no tags at all"


def _suggestion(groups: Mapping[str, BoolArray]) -> str:
    for name in groups:
        near = difflib.get_close_matches(name.lower(), REGION_NAMES, n=1)
        if name not in REGION_NAMES and near:
            return f"; did you mean {near[0]} by {name}?"
    return ""


def _join(names: list[str]) -> str:
    return ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")
