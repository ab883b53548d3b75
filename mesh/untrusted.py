"""Checks of a mesh file before it is parsed.

A mesh file may come from anywhere. Only formats with plain numbers are read (no pickles, no HDF5 with links to other
files). Contents that would make a small file allocate much memory, or read another file, are refused. In addition, the
memory of the process is limited while the file is parsed (Linux only).
"""

import contextlib
import re
from collections.abc import Iterator
from pathlib import Path

from mesh.errors import MeshError
from mesh.grid import MOST_CELLS

try:
    import resource
except ImportError:  # Windows has no such limits
    resource = None  # type: ignore[assignment]

#: Suffixes of the formats read, with their names.
FORMATS = {".msh": "Gmsh", ".vtu": "VTU", ".vtk": "legacy VTK", ".inp": "Abaqus"}

#: Largest file read [bytes]; two million cells in ASCII take about this much.
MOST_BYTES = 400_000_000

#: Largest zlib-compressed VTU read [bytes]: it can grow a thousandfold in memory.
MOST_COMPRESSED_BYTES = 4_000_000

#: Largest count or label in a header: cells of a few blocks with their points.
MOST_ENTRIES = 10 * MOST_CELLS

#: Address space that a parser may add: constant part, and multiple of the size of the file [bytes, -].
SPARE_BYTES = 1_000_000_000
SPARE_PER_BYTE = 50

_MEMORY_IN_PAGES = Path("/proc/self/statm")


def require_harmless(path: Path) -> None:
    """Refuse a mesh file by its suffix, size and headers.

    Raises:
        MeshError: not a file, an unknown format, larger than `MOST_BYTES`, or with contents that would take much
            more memory than the file or name another file.
    """
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        known = ", ".join(f"{each} ({name})" for each, name in FORMATS.items())
        raise MeshError(
            f"mesh file {path}: format {suffix or 'without suffix'} is not read; known are {known}"
        )
    if not path.is_file():
        raise MeshError(f"mesh file {path}: no such file")
    size = path.stat().st_size
    if size == 0:  # as files of the kernel state, which may never end
        raise MeshError(f"mesh file {path}: it is empty")
    if size > MOST_BYTES:
        raise MeshError(
            f"mesh file {path}: {size} bytes, at most {MOST_BYTES} are read; take larger elements"
        )
    contents = path.read_bytes()
    objection = {".msh": _gmsh, ".vtu": _vtu, ".vtk": _vtk, ".inp": _abaqus}[suffix](contents)
    if objection:
        raise MeshError(f"mesh file {path}: {objection}")


@contextlib.contextmanager
def bounded_memory(path: Path) -> Iterator[None]:
    """Limit what parsing a file may allocate; beyond it the parser sees a MemoryError.

    The limit applies to the process, so other threads should not allocate much meanwhile. Without /proc there is no
    limit.
    """
    if resource is None or not _MEMORY_IN_PAGES.exists():
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    present = int(_MEMORY_IN_PAGES.read_text().split()[0]) * resource.getpagesize()
    limits = [present + SPARE_BYTES + SPARE_PER_BYTE * path.stat().st_size, soft, hard]
    limit = min(each for each in limits if each != resource.RLIM_INFINITY)
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def _gmsh(contents: bytes) -> str | None:
    header = re.match(
        rb"(?:\$Comments.*?\$EndComments\s*)?\$MeshFormat\s+(\d)[.\d]*\s+([01])", contents, re.S
    )
    if header is None:
        return "it does not begin like a Gmsh file ($MeshFormat); .msh files of other programs are not read"
    binary_counts = header[1] != b"2" and header[2] == b"1"
    for section in re.finditer(rb"^\$(Entities|Nodes|Elements|PhysicalNames)\r?\n", contents, re.M):
        rest = contents[section.end() : section.end() + 200]
        if binary_counts and section[1] != b"PhysicalNames":
            counts = [int.from_bytes(rest[at : at + 8], "little") for at in (0, 8)]
        else:
            counts = [int(word) for word in rest.split(b"\n", 1)[0].split()[:4] if word.isdigit()]
        if counts and max(counts) > MOST_ENTRIES:
            return (
                f"{max(counts)} entries in its section {section[1].decode()}, at most {MOST_ENTRIES} are read"
            )
    return None


def _vtu(contents: bytes) -> str | None:
    if b"\0" in contents[:64] or re.search(rb"<!(DOCTYPE|ENTITY)", contents):
        return "VTU files are read as plain UTF-8 XML without DOCTYPE or entities"
    compressor = re.search(rb"compressor\s*=\s*[\"'](\w+)", contents)
    if compressor is None:
        return None
    if compressor[1] != b"vtkZLibDataCompressor":
        return f"compressed with {compressor[1].decode()}; write it uncompressed or with zlib"
    if len(contents) > MOST_COMPRESSED_BYTES:
        return f"{len(contents)} bytes compressed, at most {MOST_COMPRESSED_BYTES}; write it uncompressed"
    return None


def _vtk(contents: bytes) -> str | None:
    kinds = {kind.upper() for kind in re.findall(rb"^\s*DATASET\s+(\w+)", contents, re.M | re.I)}
    if kinds != {b"UNSTRUCTURED_GRID"}:
        listed = ", ".join(sorted(kind.decode() for kind in kinds)) or "none"
        return f"of legacy VTK only DATASET UNSTRUCTURED_GRID is read, found {listed}"
    return None


def _abaqus(contents: bytes) -> str | None:
    generating = False
    for line in contents.decode(errors="replace").replace("\r", "\n").split("\n"):
        # The reader drops every asterisk from a keyword, so this does too.
        if line.partition(",")[0].strip().replace("*", "").upper() == "INCLUDE":
            return "*INCLUDE is not followed; put the whole mesh in one file"
        if line.startswith("*"):
            generating = "GENERATE" in line.upper()
        elif generating and (label := max(map(_label, line.split(",")))) > MOST_ENTRIES:
            return f"a set generated up to label {label}, at most {MOST_ENTRIES} are read"
    return None


def _label(word: str) -> int:
    try:
        return int(word)
    except ValueError:
        return 0
