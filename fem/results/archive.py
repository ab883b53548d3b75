"""A checkpoint file: arrays and notes in one npz archive that is whole or refused.

Plain arrays, nothing pickled, nothing compressed, with a page `about.json`: whose they are, which program wrote them,
how far it was. A SHA-256 of every byte before it is the comment of the archive, at the very end. The arrays come back
bit for bit. A run that continues from them reaches the same bits only with the program and the libraries that wrote
them, so every other version is refused.
"""

import hashlib
import io
import json
import threading
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.results.errors import FolderError
from fem.runtime.own_files import write_atomically
from fem.runtime.user_files import parsed_json, read_own

FORMAT = 1
ABOUT = "about.json"
DIGEST_LENGTH = 64
REMEDY = "start over with --force"
#: numpy parses the head of an array with `ast`, which before Python 3.11.8 counts its depth for all threads together
#: (CPython issue 106905): two readers at once may then find sound files damaged
ONE_READER = threading.Lock()


class CheckpointError(FolderError):
    """A checkpoint that cannot be continued from; the message names the file, the reason and the way out."""

    def __init__(self, path: Path, reason: str, remedy: str = REMEDY) -> None:
        super().__init__(f"{path}: {reason}; {remedy}")
        self.path, self.reason = path, reason


@dataclass(frozen=True, kw_only=True, eq=False)
class Archive:
    """Content of a checkpoint file."""

    about: dict[str, Any]  #: notes: case_hash, program, and more
    arrays: dict[str, NDArray[Any]]


def write_archive(path: Path, about: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Replace a checkpoint file in one step.

    Args:
        path: of the file.
        about: notes that JSON can hold; floats come back bit for bit. `read_checkpoint` needs case_hash and program.
        arrays: of plain numbers, or records of them.

    Raises:
        OSError: the file cannot be written; the old one is still there.
    """
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(ABOUT, json.dumps({"format": FORMAT, **about}))
        for name, array in arrays.items():
            plain = io.BytesIO()
            np.lib.format.write_array(plain, np.asarray(array), allow_pickle=False)
            archive.writestr(f"{name}.npy", plain.getvalue())
        archive.comment = bytes(DIGEST_LENGTH)  # the last bytes of the file
    content = stream.getvalue()[:-DIGEST_LENGTH]
    write_atomically(path, content + _digest(content))


def read_archive(path: Path) -> Archive:
    """Read a checkpoint file, whoever wrote it; CheckpointError where it is missing or damaged."""
    try:
        about, arrays = _read(read_own(path))
    except OSError as error:
        raise CheckpointError(path, f"cannot be read ({error.strerror or error})") from None
    except Exception as error:  # a reader of broken archives fails in every way there is
        raise CheckpointError(path, f"damaged, or not a checkpoint ({error})") from None
    return Archive(about=about, arrays=arrays)


def read_checkpoint(path: Path, *, case_hash: str, program: Mapping[str, str]) -> Archive:
    """Read a checkpoint of this case, written by this program.

    Raises:
        CheckpointError: missing, damaged, of another format, of another version of the program, of another case.
    """
    checkpoint = read_archive(path)
    theirs = checkpoint.about.get("program")
    if checkpoint.about.get("format") != FORMAT or theirs != dict(program):
        difference = "unknown"
        if isinstance(theirs, dict):
            difference = ", ".join(
                f"{name} {theirs.get(name)!s:.16}, here {program.get(name)!s:.16}"
                for name in {**program, **theirs}
                if theirs.get(name) != program.get(name)
            )
        raise CheckpointError(
            path,
            "written by another version of the program or of a library it computes with "
            f"({difference}), which would not give the same bits",
            f"continue with that version, or {REMEDY}",
        )
    if checkpoint.about.get("case_hash") != case_hash:
        raise CheckpointError(path, f"belongs to another case ({checkpoint.about.get('case_hash')!s:.12})")
    return checkpoint


def _read(content: bytes) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """The page and the arrays; an archive that is not compressed takes no more memory than it has bytes."""
    if _digest(content[:-DIGEST_LENGTH]) != content[-DIGEST_LENGTH:]:
        raise ValueError("its checksum does not match its content")
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        if any(entry.compress_type != zipfile.ZIP_STORED for entry in archive.infolist()):
            raise ValueError("it is compressed")
        page = parsed_json(archive.read(ABOUT).decode())
        if not isinstance(page, dict):
            raise ValueError(f"{ABOUT} is not a table")
        streams = {name: io.BytesIO(archive.read(name)) for name in archive.namelist() if name != ABOUT}
    with ONE_READER:
        return page, {
            name.removesuffix(".npy"): np.asarray(np.lib.format.read_array(stream, allow_pickle=False))
            for name, stream in streams.items()
        }


def _digest(content: bytes) -> bytes:
    return hashlib.sha256(content).hexdigest().encode()
