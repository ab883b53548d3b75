"""Fuzz: the program fed with what hypothesis draws: `python tests/fuzz/fuzz.py 10000 [SEED [FOLDER [KIND ..]]]`.

Every input goes through the command line, in this process: it must end with 0, 2 (refused, with words), 3 (failed,
with words) or 4 (stopped by the clock here, which a long run must hear), never with a traceback, and within two
minutes; a file that is no motion, within two seconds of computing and 300 MB. What breaks this is kept as files in
FOLDER, to be looked at again: `(cd FOLDER/case_17 && sh command)`.
"""

import collections
import contextlib
import faulthandler
import gc
import io
import os
import resource
import shutil
import signal
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import data_inputs
import inputs
from folders import damaged_folders
from hypothesis import HealthCheck, Phase, given, seed, settings
from inputs import Input
from options import options

from fem.__main__ import main
from fem.case.case import load_case
from fem.model.model import build_model
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

KINDS = (
    inputs.KINDS
    | data_inputs.KINDS
    | {
        "folder": (damaged_folders(), 0.03),
        "option": (options(reading=False), 0.1),
        "reading": (options(reading=True), 0.02),
    }
)
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
    took_s: float
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
    said, before = io.StringIO(), Path.cwd()
    clock = threading.Timer(LONG, os.kill, (os.getpid(), signal.SIGINT))
    # A collection of garbage over what a whole suite holds takes up to 1.5 s, which no user of the program has.
    gc.freeze()
    began, cpu_began = time.monotonic(), time.process_time()

    def end(code: int | None, words: str) -> End:
        return End(
            code=code,
            words=words,
            took_s=time.monotonic() - began,
            cpu_s=time.process_time() - cpu_began,
            bounded=given_input.bounded,
        )

    try:
        write_input(given_input, folder)
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


def write_input(given_input: Input, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in given_input.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    for name, make in given_input.made.items():
        make(folder / name)


def warm_up() -> None:
    """Import and compile before the clocks run: an import that is interrupted leaves half a module behind."""
    for model in ("rigid", "reduced", "full"):
        built = build_model(load_case("seed_box", [f"solver.model={model}", "solver.duration_s=0.02"]))
        simulate(built, Recorder(built))


def fuzz(kind: str, count: int, number: int, kept: Path) -> collections.Counter[str]:
    """Answers to so many inputs of one kind, counted; what is broken, slow or stopped is kept and told."""
    ends: collections.Counter[str] = collections.Counter()

    @seed(number)
    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(KINDS[kind][0])
    def feed(given_input: Input) -> None:
        end = end_of(given_input)
        name = f"{kind}_{ends.total()}"
        ends["broken" if end.broken else str(end.code)] += 1
        if end.broken or end.code in (3, 4) or end.took_s > LONG:
            write_input(given_input, kept / name)
            (kept / name / "command").write_text(
                f"python -m fem {' '.join(map(repr, given_input.arguments))}\n"
            )
            (kept / name / "answer").write_text(f"{end.code} after {end.took_s:.1f} s\n{end.words}")
        if end.broken or end.code == 4:
            print(f"{kept / name}: exit {end.code} after {end.took_s:.1f} s {end.words[-300:]}", flush=True)

    feed()
    return ends


if __name__ == "__main__":
    warm_up()
    wanted, first = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    place = Path(sys.argv[3] if len(sys.argv) > 3 else tempfile.mkdtemp(prefix="fuzz-kept-"))
    for each in sys.argv[4:] or KINDS:
        share = KINDS[each][1]
        start = time.monotonic()
        found = fuzz(each, round(share * wanted), first, place)
        print(each, found.total(), dict(found), f"{time.monotonic() - start:.0f} s", flush=True)
