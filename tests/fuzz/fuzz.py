"""The program fed with what hypothesis draws.

Every input goes through the command line, in this process: it must end with 0, 2 (refused, with words), 3 (failed,
with words) or 4 (stopped by the clock here, which a long run must hear), never with a traceback, and within two
minutes; a file that is no motion, within two seconds of computing and 300 MB.
"""

import contextlib
import faulthandler
import gc
import io
import os
import resource
import shutil
import signal
import tempfile
import threading
import time
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import data_inputs
import inputs
from inputs import Input
from options import options

from fem.__main__ import main

KINDS = inputs.KINDS | data_inputs.KINDS | {"option": options()}
MOST_CPU, MOST_BYTES = 2.0, 300_000_000  #: of an input that is bounded [s, bytes]
LONG, HANGING = 10.0, 120.0  #: a run is asked to stop after the one, and given up after the other [s]
ALLOWED = {0, 2, 3, 4}
SHORT_OF_WORDS = {2, 3}  #: of exit codes, those that owe an explanation
FOREIGN = ("Traceback", "pydantic", "Input should")  #: words of libraries, not of this program
MEMORY = Path("/dev/shm")  #: files that need not last, where there is such a place


@dataclass(frozen=True, kw_only=True)
class End:
    """How the program answered an input."""

    code: int | None  #: exit code; None: an exception came through
    words: str
    cpu_s: float
    bounded: bool

    @property
    def broken(self) -> bool:
        """A promise was not kept."""
        owed = self.code in SHORT_OF_WORDS and not self.words.strip()
        foreign = self.code != 0 and any(phrase in self.words for phrase in FOREIGN)
        slow = self.bounded and self.cpu_s > MOST_CPU
        return self.code not in ALLOWED or foreign or owed or slow


def end_of(given_input: Input) -> End:
    """How the program answers an input, in a folder of its own."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz", dir=MEMORY if MEMORY.is_dir() else None))
    for name, content in given_input.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    for name, make in given_input.made.items():
        make(folder / name)
    said, before = io.StringIO(), Path.cwd()
    clock = threading.Timer(LONG, os.kill, (os.getpid(), signal.SIGINT))
    # A collection of garbage over what a whole suite holds takes up to 1.5 s, which no user of the program has.
    gc.freeze()
    began = time.process_time()

    def end(code: int | None, words: str) -> End:
        took = time.process_time() - began
        return End(code=code, words=words, cpu_s=took, bounded=given_input.bounded)

    try:
        os.chdir(folder)
        faulthandler.dump_traceback_later(HANGING, exit=True)
        clock.start()
        with (
            contextlib.redirect_stdout(said),
            contextlib.redirect_stderr(said),
            little_memory() if given_input.bounded else contextlib.nullcontext(),
        ):
            code = main(given_input.arguments)
        return end(code, said.getvalue())
    except (Exception, KeyboardInterrupt):
        return end(None, traceback.format_exc())
    finally:
        gc.unfreeze()
        clock.cancel()
        faulthandler.cancel_dump_traceback_later()
        os.chdir(before)
        shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def little_memory() -> Iterator[None]:
    """Limit what this process may allocate besides what it has."""
    present = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (present + MOST_BYTES, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
