"""Fields of a run for ParaView, pyvista and meshio: one VTU file a frame, and a PVD file that lists them by time.

The elevation is in the x-y plane of the viewer: points and vectors are (x, z, 0), since a vector of two components
aborts ParaView's Warp By Vector. Points are those of the unstressed container on the floor at t = 0. Displacement
includes the floor's motion: warping by it shows the container where it is. Numbers are single precision, compressed.
A frame is complete before the list, replaced in one step, names it: the series is valid at every moment.
Written straight: meshio, which reads it, spends 5 ms on what takes 0.3 ms here. The arrays follow the XML as raw bytes,
each one block of zlib, fast for what varies from frame to frame (2 ms a frame of 2600 nodes, which saves a quarter of
it). What all frames share is compressed once, well.
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import importlib
import os
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from fem.runtime.arrays import FloatArray, IntArray
from fem.runtime.own_files import place_in, remove, write_atomically
from fem.runtime.user_files import read_text

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

Reals = NDArray[np.float32] | NDArray[np.float64]
Array = Reals | NDArray[np.int32] | NDArray[np.uint8]

#: VTK's numbers of cells by their nodes: corners first, then mid-sides, then the centre
CELL_TYPES = {4: 9, 9: 28}
SMALLEST = 9  #: level of zlib of what all frames share
TYPES = {"float32": "Float32", "float64": "Float64", "int32": "Int32", "uint8": "UInt8"}
HEAD = (
    '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
    'header_type="UInt32" compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n'
)
#: what ParaView takes as the time of a file that it opens without the series
TIME = (
    '<FieldData>\n<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{!r}</DataArray>\n'
    "</FieldData>\n"
)


class FrameFormat:
    """The frames of a run as bytes.

    Args:
        points: (n, 3).
        cells: nodes of each cell in the order of VTK, shape (m, 4) or (m, 9).
        cell_data: numbers of the cells, shape (m,), by name.
    """

    def __init__(
        self,
        *,
        points: Reals,
        cells: NDArray[np.int32],
        cell_data: Mapping[str, NDArray[np.int32]],
    ) -> None:
        count, size = cells.shape
        self._piece = f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">\n'
        ends = np.arange(size, size * count + 1, size, dtype=np.int32)
        self._points = {"Points": _coded(points, SMALLEST)}
        self._cells = {
            "connectivity": _coded(cells.ravel(), SMALLEST),
            "offsets": _coded(ends, SMALLEST),
            "types": _coded(np.full(count, CELL_TYPES[size], dtype=np.uint8), SMALLEST),
        }
        self._cell_data = {name: _coded(values, SMALLEST) for name, values in cell_data.items()}

    def frame(self, point_data: Mapping[str, Reals], time: float | None = None) -> bytes:
        """A frame with these arrays at its points, shape (n,) or (n, 3), and its time [s], where it has one."""
        sections = {
            "PointData": {name: _coded(values) for name, values in point_data.items()},
            "CellData": self._cell_data,
            "Points": self._points,
            "Cells": self._cells,
        }
        parts = [HEAD, "" if time is None else TIME.format(time), self._piece]
        # The last array is the first of the bytes: meshio 5.3 replaces one offset after the other and looks for the
        # next among all, the first in the document first; in the same order one that it replaced may be taken for it.
        blocks = [block for arrays in sections.values() for _, block in arrays.values()]
        offset = sum(map(len, blocks))
        for section, arrays in sections.items():
            parts.append(f"<{section}>\n")
            for name, (kind, block) in arrays.items():
                offset -= len(block)
                parts.append(f'<DataArray Name="{name}" {kind} format="appended" offset="{offset}"/>\n')
            parts.append(f"</{section}>\n")
        parts.append('</Piece>\n</UnstructuredGrid>\n<AppendedData encoding="raw">\n_')
        return b"".join(
            [*(part.encode() for part in parts), *blocks[::-1], b"\n</AppendedData>\n</VTKFile>\n"]
        )


def _coded(values: Array, level: int = 1) -> tuple[str, bytes]:
    """Attributes of an array, and its bytes: one block of zlib behind its sizes."""
    kind = f'type="{TYPES[values.dtype.name]}"'
    if values.ndim == 2:
        kind += f' NumberOfComponents="{values.shape[1]}"'
    raw = values.astype(values.dtype.newbyteorder("<"), copy=False).tobytes()
    block = zlib.compress(raw, level)
    return kind, struct.pack("<4I", 1, len(raw), len(raw), len(block)) + block


SERIES = "run.pvd"
STOP, TIE = 10, 11  #: regions of the cells of stops and ties, which are behind all others

# Up to so many frames, the list of frames is rewritten with each of them. A longer list is rewritten when it has grown
# by one in so many: rewriting it with every frame would take longer than the frames.
PROMPT_FRAMES = 20


#: fields of a frame with a value at each node
NODAL = ("points", "displacement", "velocity", "von_mises", "contact_pressure")


class FieldError(ValueError):
    """A frame cannot be read; the message names its file."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameFields:
    """Fields at one time, of n nodes."""

    time: float  #: [s]
    #: position minus reference position, the floor's motion included, shape (n, 2) [m]
    displacement: FloatArray
    velocity: FloatArray  #: absolute, shape (n, 2) [m/s]
    von_mises: FloatArray | None  #: shape (n,) [Pa]; None for a rigid container
    contact_pressure: FloatArray  #: compression positive, zero off the base, shape (n,) [Pa]
    floor_displacement: float  #: of the floor along x [m]
    floor_lift: float = 0.0  #: of the floor upward [m]


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame(FrameFields):
    """A frame with its mesh, in single precision."""

    points: FloatArray  #: reference positions (x, z), shape (n, 2) [m]
    cells: IntArray  #: nodes of each cell in the order of VTK, shape (m, 4 or 9)
    region: IntArray  #: shape (m,)
    box: IntArray  #: of the stack, from 1 at the floor; 0: a stop or a tie, shape (m,)

    @property
    def of_links(self) -> IntArray:
        """The cells of stops and ties, shape (k, 4 or 9)."""
        return self.cells[self.region >= STOP]

    def without_links(self) -> "Frame":
        """Its containers alone."""
        own = self.region < STOP
        nodes = len(self.points) - self.of_links.size
        values = {name: value[:nodes] for name in NODAL if (value := getattr(self, name)) is not None}
        return replace(
            self, **values, **{name: getattr(self, name)[own] for name in ("cells", "region", "box")}
        )


class FieldWriter:
    """Writes the frames of a run into a folder.

    Args:
        folder: made if it is missing.
        points: reference positions of the nodes (x, z), shape (n, 2) [m].
        cells: nodes of each cell in the order of VTK, shape (m, 4) or (m, 9).
        region: kind of each cell, shape (m,).
        box: of each cell, from 1 at the floor, shape (m,).
        kept_times: times of the frames of an interrupted run that are kept [s]; other old frames are removed.

    Raises:
        OSError: the folder or a file cannot be written.
    """

    def __init__(
        self,
        folder: Path,
        *,
        points: FloatArray,
        cells: IntArray,
        region: IntArray,
        box: IntArray,
        kept_times: Sequence[float] = (),
    ) -> None:
        place_in(folder.parent, f"{folder.name}/{SERIES}")
        self.folder = folder
        self._nodes = len(points)
        self._format = FrameFormat(
            points=_padded(points),
            cells=cells.astype(np.int32),
            cell_data={"region": region.astype(np.int32), "box": box.astype(np.int32)},
        )
        self._times = list(kept_times)
        self._entries = [_entry(i, time) for i, time in enumerate(self._times)]
        self._listed = 0
        self._synced = len(self._times)
        self._list_frames()
        kept = {frame_name(i) for i in range(len(self._times))}
        for old in folder.glob("frame_*.vtu"):
            if old.name not in kept:
                remove(old)

    @property
    def times(self) -> tuple[float, ...]:
        """Times of the frames so far [s], for a checkpoint."""
        return tuple(self._times)

    def sync(self) -> None:
        """Bring the frames written since the last call to the disk."""
        while self._synced < len(self._times):
            with open(self.folder / frame_name(self._synced), "rb") as file:
                os.fsync(file.fileno())
            self._synced += 1

    def write(self, frame: FrameFields) -> Path:
        """Write a frame and list it; returns its file."""
        floor = np.full((self._nodes, 2), (frame.floor_displacement, frame.floor_lift))
        stress = {} if frame.von_mises is None else {"von_mises_Pa": _single(frame.von_mises)}
        content = self._format.frame(
            {
                "displacement_m": _padded(frame.displacement),
                "velocity_m_s": _padded(frame.velocity),
                **stress,
                "contact_pressure_Pa": _single(frame.contact_pressure),
                "floor_displacement_m": _padded(floor),
            },
            frame.time,
        )
        path = self.folder / frame_name(len(self._times))
        write_atomically(path, content, to_disk=False)
        self._entries.append(_entry(len(self._times), frame.time))
        self._times.append(frame.time)
        if len(self._times) - self._listed > len(self._times) // PROMPT_FRAMES:
            self._list_frames()
        return path

    def close(self) -> None:
        """List the last frames of a long series."""
        if self._listed < len(self._times):
            self._list_frames()

    def _list_frames(self) -> None:
        text = (
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
            f"  <Collection>\n{''.join(self._entries)}  </Collection>\n</VTKFile>\n"
        )
        write_atomically(self.folder / SERIES, text, to_disk=False)
        self._listed = len(self._times)


@dataclass(frozen=True, kw_only=True, eq=False)
class Fields:
    """A series of frames: on disk, read one at a time, or kept in memory."""

    times: FloatArray  #: shape (n_frames,) [s]
    files: tuple[Path, ...] = ()  #: of the frames, in order
    kept: tuple[Frame, ...] = ()  #: in place of files

    def __repr__(self) -> str:
        """One line, for a notebook."""
        span = f" from {self.times[0]:g} to {self.times[-1]:g} s" if len(self) else ""
        return f"<fields: {len(self)} frames{span}>"

    def __len__(self) -> int:
        return len(self.times)

    def __iter__(self) -> Iterator[Frame]:
        """Frames in order, each read when it is reached."""
        return (self.frame(index) for index in range(len(self)))

    def nearest(self, time: float) -> int:
        """Index of the frame nearest to a time [s]; of two as near, the earlier."""
        return int(np.argmin(np.abs(self.times - time)))

    def index_at(self, time: float) -> int:
        """Index of the frame of a time [s], within half an interval; FieldError where there is none."""
        if not len(self):
            raise FieldError("there are no frames; compute the case with output.fields_s > 0")
        first, last = float(self.times[0]), float(self.times[-1])
        beside = (last - first) / (2 * len(self)) + 1e-9
        if not first - beside <= time <= last + beside:  # true for nan
            raise FieldError(f"frames lie from {first:g} to {last:g} s, not at {time:g} s")
        return self.nearest(time)

    def frame(self, index: int) -> Frame:
        """A frame, read from its file where there is one; FieldError where that is missing or damaged."""
        if self.kept:
            return self.kept[index]
        path = self.files[index]
        if not path.is_file():
            raise FieldError(f"{path}: this frame is missing; run the case again with --force")
        try:
            mesh = importlib.import_module("meshio.vtu").read(path)
            (block,), data = mesh.cells, mesh.point_data
            return Frame(
                time=float(self.times[index]),
                points=mesh.points[:, :2],
                cells=block.data,
                region=mesh.cell_data["region"][0],
                # former versions wrote no numbers of boxes
                box=mesh.cell_data.get("box", [np.ones(len(block.data), dtype=np.int32)])[0],
                displacement=data["displacement_m"][:, :2],
                velocity=data["velocity_m_s"][:, :2],
                von_mises=data.get("von_mises_Pa"),
                contact_pressure=data["contact_pressure_Pa"],
                floor_displacement=float(data["floor_displacement_m"][0, 0]),
                floor_lift=float(data["floor_displacement_m"][0, 1]),
            )
        # A parser of broken files fails in every way there is.
        except (Exception, SystemExit) as error:
            raise FieldError(
                f"{path}: this frame is damaged ({type(error).__name__}: {error}); "
                "run the case again with --force"
            ) from None


class FrameKeeper:
    """Keeps the frames of a run in memory, in single precision as files do."""

    def __init__(self, *, points: FloatArray, cells: IntArray, region: IntArray, box: IntArray) -> None:
        self._mesh = {"points": _single(points), "cells": cells, "region": region, "box": box}
        self._kept: list[Frame] = []

    @property
    def fields(self) -> Fields:
        """The frames so far."""
        return Fields(times=np.array([frame.time for frame in self._kept]), kept=tuple(self._kept))

    def keep(self, frame: FrameFields) -> None:
        """Keep a frame."""
        single: dict[str, Any] = {
            name: _single(value) if isinstance(value, np.ndarray) else value
            for name, value in vars(frame).items()
        }
        single |= {name: float(np.float32(single[name])) for name in ("floor_displacement", "floor_lift")}
        self._kept.append(Frame(**self._mesh, **single))


def pyvista_grid(frame: Frame) -> "UnstructuredGrid":
    """A frame as a grid in the x-y plane, where the container stood, with its fields by their names in the files.

    `grid.warp_by_vector("displacement_m")` shows it where it is. Only who asks for one waits for pyvista, a second.
    """
    count, size = frame.cells.shape
    cells = np.column_stack([np.full(count, size), frame.cells]).ravel()
    grid: UnstructuredGrid = importlib.import_module("pyvista").UnstructuredGrid(
        cells, np.full(count, CELL_TYPES[size], dtype=np.uint8), spatial(frame.points)
    )
    grid.point_data["displacement_m"] = spatial(frame.displacement)
    grid.point_data["velocity_m_s"] = spatial(frame.velocity)
    if frame.von_mises is not None:
        grid.point_data["von_mises_Pa"] = frame.von_mises
    grid.point_data["contact_pressure_Pa"] = frame.contact_pressure
    grid.cell_data["region"] = frame.region
    grid.cell_data["box"] = frame.box
    return grid


def spatial(vectors: FloatArray) -> FloatArray:
    """(x, z) as (x, z, 0)."""
    return np.column_stack([vectors, np.zeros(len(vectors))])


def open_fields(folder: Path) -> Fields:
    """The frames in the folder `fields` of a run, finished or not.

    Raises:
        ValueError: a series that is damaged or names a file outside the folder.
        OSError: there is no series.
    """
    path = folder / SERIES
    try:
        sets = ElementTree.fromstring(read_text(path)).findall("./Collection/DataSet")
        listed = [(float(entry.attrib["timestep"]), entry.attrib["file"]) for entry in sets]
    except (ElementTree.ParseError, KeyError, ValueError):
        raise ValueError(f"{path}: damaged, or not a series of frames") from None
    for _, name in listed:
        if Path(name).name != name:
            raise ValueError(f"{path}: names {name!r}, which is not in its folder")
    return Fields(
        times=np.array([time for time, _ in listed]), files=tuple(folder / name for _, name in listed)
    )


def frame_name(index: int) -> str:
    """File name of a frame; the first has index 0."""
    return f"frame_{index:05d}.vtu"


def _entry(index: int, time: float) -> str:
    """A frame in the list of frames."""
    return f'    <DataSet timestep="{time!r}" part="0" file="{frame_name(index)}"/>\n'


def _single(values: FloatArray) -> Any:
    """In single precision."""
    return values.astype(np.float32)


def _padded(vectors: FloatArray) -> NDArray[np.float32]:
    """(x, z) as (x, z, 0) in single precision, shape (n, 3)."""
    padded = np.zeros((len(vectors), 3), dtype=np.float32)
    padded[:, :2] = vectors
    return padded
