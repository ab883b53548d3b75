"""Outer shape and section of a container standing on z = 0, centred on x = 0. Lengths in m."""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from mesh.cells import FloatArray
from mesh.errors import MeshError


class Section(Enum):
    """How the elevation of a box is made up."""

    SHELL = "shell"  #: a steel box: ring, front and back sheets, fill
    SOLID = "solid"  #: a block without walls, for benchmarks


@dataclass(frozen=True, kw_only=True)
class CornerPost:
    """A square hollow section of steel over the height of a box, flush with its sides, at each of its four edges.

    Raises MeshError for dimensions that are not positive and finite, or walls thicker than half the width.
    """

    width: float  #: outer width [m]
    wall: float  #: thickness [m]

    def __post_init__(self) -> None:
        for name in ("width", "wall"):
            _require_length(f"post {name}", getattr(self, name))
        if not 2.0 * self.wall <= self.width:
            raise MeshError(
                f"two walls of {self.wall} m leave no room in a post of {self.width} m; take half of it for a solid one"
            )

    @property
    def lines(self) -> tuple[float, ...]:
        """Distances of its faces from the side of the box, rising [m]."""
        inner = (self.wall, self.width - self.wall, self.width)
        return inner if inner[0] < inner[1] else inner[1:]

    def thickness(self, distance: FloatArray) -> FloatArray:
        """Of both posts behind each other, out of the plane, at distances from the side of the box [m].

        That of their four flanges and four webs, so that area, second moment and shear area are theirs.
        """
        flange = (distance < self.wall) | (distance > self.width - self.wall)
        return np.where(distance < self.width, np.where(flange, 2.0 * self.width, 4.0 * self.wall), 0.0)


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
    post: CornerPost | None = None  #: shell only
    round: bool = False  #: a vertical cylinder whose diameter is width and depth

    def __post_init__(self) -> None:
        for name in ("width", "height", "depth"):
            _require_length(name, getattr(self, name))
        if isinstance(self.boxes, bool) or not isinstance(self.boxes, int) or self.boxes < 1:
            raise MeshError(f"container boxes must be a whole number, 1 or more, got {self.boxes!r}")
        if not isinstance(self.section, Section):
            raise MeshError(f"container section must be a Section, got {self.section!r}")
        if self.section is Section.SHELL:
            if self.wall is None:
                raise MeshError("a shell section needs a wall thickness in m; 0.008 m is usual for steel")
            _require_length("wall", self.wall)
            for name in ("width", "height", "depth"):
                if not 2.0 * self.wall < getattr(self, name):
                    raise MeshError(
                        f"two walls of {self.wall} m leave no room in a {name} of {getattr(self, name)} m; "
                        "thinner walls, or section solid"
                    )
        elif self.wall is not None:
            raise MeshError(f"a solid section has no wall, got wall {self.wall} m; use section shell")
        if self.post is None:
            return
        if self.section is not Section.SHELL:
            raise MeshError("a solid section has no posts; use section shell")
        for name in ("width", "depth"):
            if not 2.0 * self.post.width < getattr(self, name):
                raise MeshError(
                    f"two posts of {self.post.width} m leave no room in a {name} of {getattr(self, name)} m"
                )

    def chords(self, left: FloatArray, right: FloatArray, *, inside: float = 0.0) -> FloatArray:
        """Mean depth of a cylinder between two distances from its axis (m,) [m].

        That of the circle `inside` its surface by so much [m], the integral of 2 sqrt(r^2 - x^2) over the interval.
        """
        radius = 0.5 * self.width - inside
        low, high = (np.clip(np.asarray(x) / radius, -1.0, 1.0) for x in (left, right))
        area = [x * np.sqrt(1.0 - x * x) + np.arcsin(x) for x in (low, high)]
        return radius**2 * (area[1] - area[0]) / (np.asarray(right) - np.asarray(left))

    @property
    def total_height(self) -> float:
        """Height of all boxes together [m]."""
        return self.boxes * self.height


def _require_length(name: str, value: float) -> None:
    if not (value > 0.0 and math.isfinite(value)):  # also refuses nan
        raise MeshError(f"container {name} must be positive and finite, got {value} m")
