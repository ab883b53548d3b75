"""Inputs of every kind, the same ones every time; `FUZZ=100` tries a hundred times as many.

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
from dataclasses import dataclass, replace
from pathlib import Path

import data_inputs
import inputs
import pytest
from data_inputs import BY_A_FILE, HOSTILE, NAMED, SIZES, SPECIAL, hostile, special
from hypothesis import HealthCheck, given, settings
from inputs import FIELDS, Input, values_of
from options import options
from random_cases import random_case

import fem
from fem.__main__ import main
from fem.case.case import load_case
from fem.case.tables.all_tables import TABLES
from fem.case.validation import known_keys
from fem.model.model import build_model
from fem.results.outcome import Outcome
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

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
def little_memory():
    """Limit what this process may allocate besides what it has."""
    present = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (present + MOST_BYTES, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """Import and compile before the clocks run: an import that is interrupted leaves half a module behind."""
    for model in ("rigid", "reduced", "full"):
        built = build_model(load_case("seed_box", [f"solver.model={model}", "solver.duration_s=0.02"]))
        simulate(built, Recorder(built))


MANY = int(os.environ.get("FUZZ", "1"))
COUNTS = {"text": 20, "mesh": 20, "table": 20, "record": 15, "hostile": 5, "case": 15, "option": 8}


@pytest.mark.parametrize("share", [MANY, pytest.param(3 * MANY, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("kind", "count"), COUNTS.items())
def test_any_input_is_refused_with_words_or_computed(kind, count, share):
    @settings(max_examples=share * count, derandomize=True, suppress_health_check=list(HealthCheck))
    @given(KINDS[kind])
    def feed(given_input):
        end = end_of(given_input)
        assert not end.broken, end.words
        codes.add(end.code)

    codes = set()
    feed()
    # Some of it is wrong, and found to be; some of it is computed: of cases a half, of all else a fifth or less.
    assert codes >= ({0, 2} if kind == "case" else {2})


@pytest.mark.parametrize("name", HOSTILE)
def test_a_large_file_is_refused_as_soon_as_a_small_one(name):
    end = end_of(hostile(name, SIZES[-2]))
    assert end.code == 2 and not end.broken, (end.cpu_s, end.words)


@pytest.mark.parametrize("name", NAMED)
def test_what_is_no_regular_file_is_refused_where_a_file_is_read(name):
    for kind in SPECIAL:
        end = end_of(special(name, kind))
        assert end.code == 2 and not end.broken, (kind, end.cpu_s, end.words)
        assert name in end.words, kind


@pytest.mark.parametrize("name", BY_A_FILE)
def test_a_file_names_none_in_another_folder_by_a_link(name, tmp_path):
    (tmp_path / "secret").write_text("a word that no message may quote", encoding="utf-8")
    to_elsewhere = {name: lambda path: path.symlink_to(tmp_path / "secret")}
    end = end_of(replace(special(name, "pipe"), made=to_elsewhere))
    assert end.code == 2 and name in end.words and "quote" not in end.words, end.words


def test_every_key_of_the_schema_is_fuzzed():
    assert {f"{table}.{key}" for table, model in TABLES.items() for key in known_keys(model)} <= set(FIELDS)
    for key in FIELDS:
        values_of(key, None).validate()


def outcome_of(case):
    """What a case comes to, or why it comes to nothing."""
    try:
        run = fem.compute(case, band=False, margin=False)
    except ValueError as error:
        return f"refused: {error}"
    return run.verdict.outcome or f"failed: {run.result['error']}"


def test_random_valid_cases_end_with_an_outcome_a_failure_or_a_refusal():
    ends = [outcome_of(random_case(number, "rigid", 5.0)) for number in range(1, 17)]
    assert all(end in tuple(Outcome) or end.startswith(("refused: ", "failed: ")) for end in ends)
    assert sum(end in tuple(Outcome) for end in ends) > 8


BLOCK = ("container.section=solid", "container.density_kg_m3=2000.0")
AXES = {  # key -> its extremes, and what is set beside them
    "container.youngs_modulus_Pa": ((1e6, 1e13), ()),
    "container.width_m": ((0.02, 0.05, 5.0, 20.0), BLOCK),
    "container.boxes": ((1, 10, 50), ()),
    "contact.mu_static": ((0.0,), ("contact.mu_kinetic=0.0",)),
    "contact.mu_kinetic": ((0.4,), ("contact.mu_static=5.0",)),
    "motion.amplitude_m": ((0.0, 1e-6, 10.0), ()),
    "motion.frequency_Hz": ((0.01, 100.0), ("motion.amplitude_m=0.001",)),
    "solver.duration_s": ((1e-3, 100.0), ()),
    "container.wall_m": ((1e-6, 0.1, 0.49), ("container.wall_density_kg_m3=50.0",)),
    "support.kind": (("feet", "flat"), ()),
}
SHORT = ("solver.model=rigid", "solver.duration_s=2", "output.fields_s=0", "solver.element_size_m=0.5")


@pytest.mark.parametrize(
    ("key", "value", "beside"),
    [(key, value, beside) for key, (values, beside) in AXES.items() for value in values],
)
def test_an_extreme_is_computed_or_refused_with_a_reason(key, value, beside):
    end = outcome_of(load_case("seed_stack_plateau", (*SHORT, f"{key}={value}", *beside)))
    assert end in tuple(Outcome) or end.startswith("refused: ")
    assert end.startswith("refused: ") == ("[floor] " in end)  # nothing but a slab that gives way
