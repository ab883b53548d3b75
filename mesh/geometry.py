"""Outer shape and section of a container standing on z = 0, centred on x = 0. Lengths in m."""

import math
from dataclasses import dataclass
from enum import Enum

from mesh.errors import MeshError


class Section(Enum):
    """How the elevation of a box is made up."""

    SHELL = "shell"  #: a steel box: ring, front and back sheets, fill
    SOLID = "solid"  #: a block without walls, for benchmarks


@dataclass(frozen=True, kw_only=True)
class ContainerGeometry:
    """Outer dimensions of a container: equal boxes, bolted one on top of the other.

    Raises MeshError for a dimension that is not positive and finite, a number of boxes that is not a
    whole number above zero, a shell without a wall or with walls that meet, a solid with a wall.
    """

    width: float  #: along x [m]
    height: float  #: of one box, along z [m]
    depth: float  #: out of the plane [m]
    boxes: int = 1  #: bolted boxes, one on top of the other
    section: Section = Section.SHELL
    wall: float | None = None  #: thickness of the steel, shell only [m]

    def __post_init__(self) -> None:
        for name in ("width", "height", "depth"):
            _require_length(name, getattr(self, name))
        if isinstance(self.boxes, bool) or not isinstance(self.boxes, int) or self.boxes < 1:
            raise MeshError(f"container boxes must be a whole number, 1 or more, got {self.boxes!r}")
        if not isinstance(self.section, Section):
            raise MeshError(f"container section must be a Section, got {self.section!r}")
        if self.section is Section.SHELL:
            self._require_room_between_walls()
        elif self.wall is not None:
            raise MeshError(f"a solid section has no wall, got wall {self.wall} m; use section shell")

    def _require_room_between_walls(self) -> None:
        if self.wall is None:
            raise MeshError("a shell section needs a wall thickness in m; 0.008 m is usual for steel")
        _require_length("wall", self.wall)
        for name in ("width", "height", "depth"):
            if not 2.0 * self.wall < getattr(self, name):
                raise MeshError(
                    f"two walls of {self.wall} m leave no room in a {name} of {getattr(self, name)} m; "
                    "thinner walls, or section solid"
                )

    @property
    def total_height(self) -> float:
        """Height of all boxes together [m]."""
        return self.boxes * self.height


def _require_length(name: str, value: float) -> None:
    if not (value > 0.0 and math.isfinite(value)):  # also refuses nan
        raise MeshError(f"container {name} must be positive and finite, got {value} m")
