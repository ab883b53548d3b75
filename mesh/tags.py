"""The region of every cell of a mesh file, from the names in the file.

Files name groups of cells in different ways. They are searched in this order: named sets of cells (Gmsh 4 physical
groups, Abaqus element sets), Gmsh physical groups by number and name, an integer field `region` with the numbers of
`Region`, one 0/1 field a region (`wall`, `sheet`, ...), and one integer field with a joined name such as
`wall-sheet-fill`, which meshio makes of sets in VTU and VTK. The first one with a known region is used; every cell must
then be in exactly one region.
"""

import difflib
import re
from collections.abc import Iterator, Mapping
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
    """Region (m,) of every cell, one of those `allowed` in this section of container.

    A MeshError lists the tags found: none with the name of a region; a region that the section does not have; cells in
    no or several regions.
    """
    tagged: dict[str, BoolArray] = {}
    known = _join([region.name.lower() for region in allowed])
    for found in _groupings(tags):
        groups = {name: cells for name, cells in found.items() if cells.any()}
        tagged = {**groups, **tagged}
        if any(name in REGION_NAMES for name in groups):
            break
    else:
        raise MeshError(
            f"no cell is tagged with a region ({known}); found {_listing(tagged, tags)}: name the groups of cells "
            "(Gmsh physical surfaces, element sets) after the regions"
        )
    region = np.full(tags.count, -1, dtype=np.int64)
    owners = np.zeros(tags.count, dtype=np.int64)
    for name, cells in groups.items():
        if name in REGION_NAMES:
            region[cells] = REGION_NAMES[name]
            owners[cells] += 1
    listing = _listing(groups, None)
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
        unknown = {name: difflib.get_close_matches(name.lower(), REGION_NAMES, n=1) for name in groups}
        meant = (
            f"; did you mean {near[0]} by {name}?"
            for name, near in unknown.items()
            if near and name not in REGION_NAMES
        )
        raise MeshError(
            f"{int(np.sum(owners == 0))} cells are in no region, the first is cell {int(np.argmin(owners))}; "
            f"found {listing}: each cell belongs to one of {known}{next(meant, '')}"
        )
    return region


def _groupings(tags: CellTags) -> Iterator[Mapping[str, BoolArray]]:
    """Groups of cells by name, in each of the ways in which files name them; one way is asked after the other."""
    yield tags.sets
    numbers, codes = tags.data.get("gmsh:physical"), tags.data.get("region")
    if numbers is not None:
        yield {
            tags.physical_names.get(int(number), f"physical group {number} without a name"): numbers == number
            for number in np.unique(numbers[np.isfinite(numbers)])
        }
    if codes is not None:
        names = {int(region): name for name, region in REGION_NAMES.items()}
        finite = np.unique(codes[np.isfinite(codes)])
        yield {names.get(code, f"region {code}"): codes == code for code in finite}
    flags = {name: tags.data[name] for name in REGION_NAMES if name in tags.data}
    for name, values in flags.items():
        if not np.isin(values, (0, 1)).all():
            raise MeshError(
                f"cell field {name} must be 0 or 1 in every cell, got {np.unique(values)[:5].tolist()}"
            )
    yield {name: values == 1 for name, values in flags.items()}
    for key, values in tags.data.items():
        parts = re.split(r"[-_#+/]", key)
        if len(parts) > 1 and any(name in REGION_NAMES for name in parts):
            yield {name: values == number for number, name in enumerate(parts)}
            return


def _listing(groups: Mapping[str, BoolArray], tags: CellTags | None) -> str:
    listed = [f"{name} ({int(cells.sum())} cells)" for name, cells in groups.items()]
    if tags is not None:
        listed += [f"field {name}" for name in tags.data if name not in ("gmsh:geometrical", "gmsh:physical")]
    return _join(listed) if listed else "no tags at all"


def _join(names: list[str]) -> str:
    return ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")
