"""The checkpoint of a run: its state in one file that is whole or refused.

An npz archive (plain arrays, nothing pickled, nothing compressed) beside a page `about.json`: whose run it is,
which program wrote it, how far it had come, and a SHA-256 over all of it. Its bits go back into the run as they
were, so that it goes on as if nothing had happened; that holds for the program and the libraries that wrote it
alone, so every other is refused.
"""

import contextlib
import hashlib
import io
import json
import os
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

FORMAT = 1
ABOUT = "about.json"
REMEDY = "begin the run anew with --force"
#: what reading a damaged archive may raise
DAMAGE = (
    zipfile.BadZipFile,
    zlib.error,
    ValueError,
    KeyError,
    TypeError,
    EOFError,
    NotImplementedError,
    RuntimeError,
    MemoryError,
)


class CheckpointError(ValueError):
    """A checkpoint that cannot be gone on from; the message names the file, the reason and the way out."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Checkpoint:
    """What a checkpoint holds."""

    about: dict[str, Any]  #: case_hash, program, and the run's own notes
    arrays: dict[str, NDArray[Any]]


def write_checkpoint(path: Path, about: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Replace a checkpoint in one step; it reaches the disk before the old one goes.

    Args:
        path: the file.
        about: notes that JSON can hold, with `case_hash` and `program`; floats come back bit for bit.
        arrays: of plain numbers, or records of them.

    Raises:
        OSError: the file cannot be written; the old one is still there.
    """
    members = {f"{name}.npy": _to_bytes(array) for name, array in arrays.items()}
    page: dict[str, Any] = {"format": FORMAT, **about}
    page["sha256"] = _digest(page, members)
    part = path.with_name(f".{path.name}.part")
    try:
        with open(part, "wb") as file:
            with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
                archive.writestr(ABOUT, json.dumps(page))
                for name, content in members.items():
                    archive.writestr(name, content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink()
        raise


def read_checkpoint(path: Path, *, case_hash: str, program: Mapping[str, str]) -> Checkpoint:
    """Read a checkpoint of this case, written by this program.

    Raises:
        CheckpointError: damaged, of another format, of another version of the program, of another case.
    """
    try:
        page, members = _read(path)
        found = page.pop("sha256")
        if found != _digest(page, members):
            raise ValueError("its checksum does not fit its content")
        arrays = {name.removesuffix(".npy"): _to_array(content) for name, content in members.items()}
    except OSError as error:
        raise CheckpointError(f"{path}: cannot be read ({error.strerror or error}); {REMEDY}") from None
    except DAMAGE as error:
        raise CheckpointError(f"{path}: damaged, or no checkpoint ({error}); {REMEDY}") from None
    if page.get("format") != FORMAT or page.get("program") != dict(program):
        raise CheckpointError(
            f"{path}: written by another version of the program or of a library it computes with "
            f"({_difference(page.get('program'), program)}), which would not go on to the same bits; go on "
            f"with that version, or {REMEDY}"
        )
    if page.get("case_hash") != case_hash:
        raise CheckpointError(f"{path}: belongs to another case ({page.get('case_hash')!s:.12}); {REMEDY}")
    return Checkpoint(about=page, arrays=arrays)


def _read(path: Path) -> tuple[dict[str, Any], dict[str, bytes]]:
    """The page and the raw members; no more memory is taken than the file has bytes."""
    with open(path, "rb") as file:
        room = os.fstat(file.fileno()).st_size
        with zipfile.ZipFile(file) as archive:
            members: dict[str, bytes] = {}
            for entry in archive.infolist():
                room -= entry.file_size
                if entry.compress_type != zipfile.ZIP_STORED or room < 0 or entry.filename in members:
                    raise ValueError(f"its member {entry.filename[:40]!r} is not as it was written")
                members[entry.filename] = archive.read(entry)
    page = json.loads(members.pop(ABOUT))
    if not isinstance(page, dict):
        raise ValueError(f"{ABOUT} holds no table")
    return page, members


def _digest(page: Mapping[str, Any], members: Mapping[str, bytes]) -> str:
    digest = hashlib.sha256(json.dumps(page, sort_keys=True).encode())
    for name in sorted(members):
        digest.update(f"\n{name} {len(members[name])}\n".encode())
        digest.update(members[name])
    return digest.hexdigest()


def _to_bytes(array: NDArray[Any]) -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.asarray(array), allow_pickle=False)
    return stream.getvalue()


def _to_array(content: bytes) -> NDArray[Any]:
    return np.asarray(np.lib.format.read_array(io.BytesIO(content), allow_pickle=False))


def _difference(found: Any, program: Mapping[str, str]) -> str:
    if not isinstance(found, dict):
        return "unknown"
    names = [name for name in {**program, **found} if found.get(name) != program.get(name)]
    return ", ".join(f"{name} {found.get(name)!s:.16}, here {program.get(name)!s:.16}" for name in names)
