"""Arrays of a long set-up in the folder of its run: an interrupted set-up continues with those it has.

15 s after the last time, the arrays computed since are written into a file in the hidden folder `.setup`, in the order
in which a set-up asks for them. A set-up that continues reads the files in that order, up to the first that is missing,
damaged or of another case or program, and computes the rest. They are removed when the run is finished. A set-up of
less than 15 s writes none.
"""

import time
from collections.abc import Callable

from fem.results.archive import CheckpointError, read_checkpoint, write_archive
from fem.results.disk import free_disk, in_units
from fem.results.folder import ResultFolder
from fem.results.run_files import RunFiles
from fem.run.checkpoint import CHECKPOINT_S
from fem.runtime.arrays import FloatArray
from fem.runtime.identity import program_identity
from fem.runtime.progress import Reporter

#: over the size of the arrays: room that their file must leave on the disk, for the run itself
ROOM = 4


class SetupCache:
    """Stores the arrays of a set-up; an `ArrayCache` of `fem.solid.array_cache`.

    Args:
        folder: of the run.
        case_hash: of the run.
        reporter: for files that are refused, and for arrays that the disk has no room for.
    """

    def __init__(self, folder: ResultFolder, *, case_hash: str, reporter: Reporter) -> None:
        self._folder, self._files, self._reporter = folder, RunFiles(folder.path), reporter
        self._case_hash, self._program = case_hash, program_identity()
        self._number = 1  #: of the file that is read or written next
        self._reading = self._files.setup_part(1).exists()
        self._read: dict[str, FloatArray] = {}  #: and not asked for yet
        self._computed: dict[str, FloatArray] = {}  #: and not written yet
        self._last = time.monotonic()

    def __call__(self, name: str, target: FloatArray, compute: Callable[[], FloatArray]) -> None:
        """Fill an array with what is stored under its name, or with the computed values.

        Raises:
            OSError: the folder was lost, or cannot be written.
        """
        stored = self._stored(name) if self._reading else None
        if stored is not None and stored.shape == target.shape:
            target[...] = stored
            return
        self._reading = False
        self._read.clear()
        target[...] = compute()
        self._computed[name] = target
        if time.monotonic() - self._last >= CHECKPOINT_S:
            self._write()

    def _stored(self, name: str) -> FloatArray | None:
        path = self._files.setup_part(self._number)
        if not self._read and path.exists():
            try:
                self._read = read_checkpoint(path, case_hash=self._case_hash, program=self._program).arrays
                self._number += 1
            except CheckpointError as error:
                self._reporter.warning(
                    f"{path} is refused ({error.reason}): the set-up continues with the parts before it"
                )
        return self._read.pop(name, None)

    def _write(self) -> None:
        self._folder.check()
        path = self._files.setup_part(self._number)
        size = sum(array.nbytes for array in self._computed.values())
        room = free_disk(self._folder.path)
        if room is None or room > ROOM * size:
            path.parent.mkdir(exist_ok=True)
            about = {"case_hash": self._case_hash, "program": self._program}
            write_archive(path, about, self._computed)
            self._number += 1
        else:
            self._reporter.message(
                f"{path.parent}: {in_units(size)} of the set-up are not stored, since the disk has only "
                f"{in_units(room)} free; an interrupted set-up loses them"
            )
        self._computed.clear()
        self._last = time.monotonic()
