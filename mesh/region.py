"""The kinds of cell in the elevation of a container, numbered as they are written to files."""

from enum import IntEnum


class Region(IntEnum):
    """What a cell of the mesh is made of."""

    WALL = 0  #: the ring: floor, lid and side walls, as deep as the container
    SHEET = 1  #: front and back sheets, no fill behind them
    FILL = 2  #: front and back sheets with fill between them: mass without stiffness
    SOLID = 3  #: a block, as deep as the container


#: Names of the regions in mesh files.
REGION_NAMES = {region.name.lower(): region for region in Region}
