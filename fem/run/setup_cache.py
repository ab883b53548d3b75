"""Parts of a long set-up in the folder of its run: one that was cut off goes on after those that it has.

A quarter of a minute after the last time, what has been made since is written into a file of its own in the hidden
folder `.setup`: part after part, in the order in which a set-up asks for them, each file a checkpoint with its sum.
A set-up that goes on reads them in that order, up to the first that is missing, damaged or of another case or program,
and makes the rest. They go when the run is finished. A set-up of less than that never writes one.
"""

import time
from collections.abc import Callable

from fem.results.archive import CheckpointError, read_checkpoint, write_archive
from fem.results.disk import free_disk
from fem.results.lock import FolderLock
from fem.results.run_folder import RunFolder, naming_what_cannot_be_written
from fem.run.checkpoint import CHECKPOINT_S
from fem.runtime.arrays import FloatArray
from fem.runtime.identity import program_identity
from fem.runtime.progress import Reporter

#: over the size of the parts: room that their file must leave on the disk, for the run itself
ROOM = 4


class PartFolder:
    """Keeps the parts of a set-up in the folder of its run.

    Args:
        place: the folder; lock: by which it is held.
        case_hash: of the run.
        reporter: told of parts that are gone on with, and of those refused.
    """

    def __init__(self, place: RunFolder, lock: FolderLock, *, case_hash: str, reporter: Reporter) -> None:
        self._place, self._lock, self._reporter = place, lock, reporter
        self._case_hash, self._program = case_hash, program_identity()
        self._number = 1  #: of the file that is read or written next
        self._going_on = place.part(1).exists()
        self._ahead: dict[str, FloatArray] = {}  #: read, and not asked for yet
        self._made: dict[str, FloatArray] = {}  #: not written yet
        self._last = time.monotonic()

    def fill(self, name: str, target: FloatArray, make: Callable[[], FloatArray]) -> None:
        """See `fem.solid.setup_parts.Parts`.

        Raises:
            OutputError: the folder is no longer ours, or cannot be written.
        """
        found = self._kept(name)
        if found is not None and found.shape == target.shape:
            target[...] = found
            return
        self._going_on = False
        self._ahead.clear()
        target[...] = make()
        self._made[name] = target
        if time.monotonic() - self._last >= CHECKPOINT_S:
            self._write()

    def _kept(self, name: str) -> FloatArray | None:
        if self._going_on and not self._ahead:
            path = self._place.part(self._number)
            try:
                self._ahead = read_checkpoint(path, case_hash=self._case_hash, program=self._program).arrays
                self._number += 1
            except CheckpointError as error:
                if path.exists():
                    self._reporter.warning(
                        f"{path} is refused ({error.reason}): the set-up continues with the parts before it"
                    )
        return self._ahead.pop(name, None) if self._going_on else None

    def _write(self) -> None:
        with naming_what_cannot_be_written(self._place.path, "the same command begins anew"):
            self._lock.check()
        path = self._place.part(self._number)
        size = sum(array.nbytes for array in self._made.values())
        room = free_disk(self._place.path, ())
        if room is None or room > ROOM * size:
            with naming_what_cannot_be_written(self._place.path, "the same command goes on with the set-up"):
                path.parent.mkdir(exist_ok=True)
                write_archive(path, {"case_hash": self._case_hash, "program": self._program}, self._made)
            self._number += 1
        else:
            self._reporter.message(
                f"{path.parent}: {size / 1e9:.2g} GB of the set-up are not kept, for the disk has {room / 1e9:.2g} GB "
                "free; a set-up that is cut off loses them"
            )
        self._made.clear()
        self._last = time.monotonic()
