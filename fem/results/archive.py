"""The checkpoint of a run: its state in one file that is whole or refused.

An npz archive (plain arrays, nothing pickled, nothing compressed) with a page `about.json`: whose run it is,
which program wrote it, how far it had come. A SHA-256 of every byte before it stands at the very end, as the
comment of the archive. The arrays go back into the run bit for bit, so that it goes on as if nothing had
happened; that holds for the program and the libraries that wrote them alone, so every other is refused.
"""

import contextlib
import hashlib
import io
import json
import os
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

FORMAT = 1
ABOUT = "about.json"
DIGEST_LENGTH = 64
REMEDY = "begin the run anew with --force"


class CheckpointError(ValueError):
    """A checkpoint that cannot be gone on from; the message names the file, the reason and the way out."""

    def __init__(self, path: Path, reason: str, remedy: str = REMEDY) -> None:
        super().__init__(f"{path}: {reason}; {remedy}")
        self.path, self.reason = path, reason


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
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(ABOUT, json.dumps({"format": FORMAT, **about}))
        for name, array in arrays.items():
            archive.writestr(f"{name}.npy", _to_bytes(array))
        archive.comment = bytes(DIGEST_LENGTH)  # the last bytes of the file
    content = stream.getvalue()[:-DIGEST_LENGTH]
    part = path.with_name(f".{path.name}.part")
    try:
        with open(part, "wb") as file:
            file.write(content)
            file.write(_digest(content))
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            part.unlink()
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(path)) from None
        raise


def read_checkpoint(path: Path, *, case_hash: str, program: Mapping[str, str]) -> Checkpoint:
    """Read a checkpoint of this case, written by this program.

    Raises:
        CheckpointError: damaged, of another format, of another version of the program, of another case.
    """
    try:
        page, arrays = _read(path.read_bytes())
    except OSError as error:
        raise CheckpointError(path, f"cannot be read ({error.strerror or error})") from None
    except Exception as error:  # a reader of broken archives fails in every way there is
        raise CheckpointError(path, f"damaged, or no checkpoint ({error})") from None
    if page.get("format") != FORMAT or page.get("program") != dict(program):
        raise CheckpointError(
            path,
            "written by another version of the program or of a library it computes with "
            f"({_difference(page.get('program'), program)}), which would not go on to the same bits",
            f"go on with that version, or {REMEDY}",
        )
    if page.get("case_hash") != case_hash:
        raise CheckpointError(path, f"belongs to another case ({page.get('case_hash')!s:.12})")
    return Checkpoint(about=page, arrays=arrays)


def _read(content: bytes) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """The page and the arrays; an archive that is not compressed takes no more memory than it has bytes."""
    if _digest(content[:-DIGEST_LENGTH]) != content[-DIGEST_LENGTH:]:
        raise ValueError("its checksum does not fit its content")
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        if any(entry.compress_type != zipfile.ZIP_STORED for entry in archive.infolist()):
            raise ValueError("it is compressed")
        page = json.loads(archive.read(ABOUT))
        if not isinstance(page, dict):
            raise ValueError(f"{ABOUT} holds no table")
        names = [name for name in archive.namelist() if name != ABOUT]
        return page, {name.removesuffix(".npy"): _to_array(archive.read(name)) for name in names}


def _digest(content: bytes) -> bytes:
    return hashlib.sha256(content).hexdigest().encode()


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
