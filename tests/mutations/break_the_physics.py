"""A test of the tests: break the physics in one place after the other, and see that some test notices.

    python tests/mutations/break_the_physics.py [-j JOBS] [--only WORDS]

Each fault of `faults.toml` is put into a copy of the project, and the fast tests named beside it are run there. Every
fault has a copy and an empty kernel cache of its own, and random tests draw the same examples in every run, so that a
verdict does not depend on the faults before it, nor on chance. A fault that no test notices survives; then the script
ends with 1. It ends with 2 where a fault cannot be judged: its text is no longer there, or the tests do not pass
without it.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
COPIED = ("fem", "mesh", "contact", "tests")
TESTS_PASSED, TESTS_FAILED = 0, 1  #: exit codes of pytest; all others are no verdict
LONGEST = 900.0  #: [s] for the tests of one fault


@dataclass(frozen=True, kw_only=True)
class Mutation:
    """One fault: a piece of text that stands once in a file, and what it becomes."""

    name: str  #: what is wrong then
    file: str  #: from the root of the project
    old: str
    new: str
    tests: tuple[str, ...]  #: files from the folder of the tests, and options of pytest

    def broken(self, root: Path) -> str:
        """The file with the fault; empty where the text does not stand there just once."""
        path = root / self.file
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        return text.replace(self.old, self.new) if text.count(self.old) == 1 else ""


FAULTS = [
    Mutation(**one | {"tests": tuple(one["tests"])})
    for one in tomllib.loads((Path(__file__).parent / "faults.toml").read_text(encoding="utf-8"))["fault"]
]


class Finding(NamedTuple):
    """What became of one fault."""

    mutation: Mutation
    verdict: str  #: noticed | SURVIVES | no verdict
    by: str  #: the first test that failed, or why there is no verdict
    seconds: float


def main(arguments: Sequence[str] | None = None) -> int:
    """Break, test, print the table."""
    parser = argparse.ArgumentParser(description="Break the physics; see that some test notices.")
    parser.add_argument(
        "-j", "--jobs", type=int, default=len(os.sched_getaffinity(0)), help="faults at a time"
    )
    parser.add_argument("--only", default="", help="faults whose name or file contains these words")
    options = parser.parse_args(arguments)
    chosen = [m for m in FAULTS if options.only in f"{m.file}: {m.name}"]
    with tempfile.TemporaryDirectory(prefix="broken-physics-") as name:
        folder = Path(name)
        sound = soundness(folder, chosen)
        if sound:
            print(f"the tests do not pass on the physics as it is: {sound}", file=sys.stderr)
            return 2
        with ThreadPoolExecutor(options.jobs) as pool:
            findings = []
            for finding in pool.map(partial(judge, folder=folder), chosen):
                where = f"{finding.mutation.file:<24} {finding.mutation.name}\n{'':20} {finding.by}"
                print(f"{finding.verdict:<10} {finding.seconds:5.0f} s  {where}", flush=True)
                findings.append(finding)
    survivors, unjudged = (
        sum(one.verdict == word for one in findings) for word in ("SURVIVES", "no verdict")
    )
    print(f"{len(findings)} faults: {survivors} survive, {unjudged} without a verdict")
    return 2 if unjudged else int(survivors > 0)


def soundness(folder: Path, mutations: Sequence[Mutation]) -> str:
    """The first test that fails without any fault, or nothing."""
    with copied_tree(folder) as tree:
        ends = (run_tests(tree, tests) for tests in dict.fromkeys(one.tests for one in mutations))
        return next((by for code, by in ends if code != TESTS_PASSED), "")


def judge(mutation: Mutation, folder: Path) -> Finding:
    """Put one fault into a copy of its own and run its tests."""
    began = time.perf_counter()
    broken = mutation.broken(ROOT)
    if not broken:
        verdict, by = "no verdict", "its text does not stand once in its file"
    else:
        with copied_tree(folder) as tree:
            (tree / mutation.file).write_text(broken, encoding="utf-8")
            code, by = run_tests(tree, mutation.tests)
        verdict = {TESTS_PASSED: "SURVIVES", TESTS_FAILED: "noticed"}.get(code, "no verdict")
    return Finding(mutation=mutation, verdict=verdict, by=by, seconds=time.perf_counter() - began)


@contextmanager
def copied_tree(folder: Path) -> Iterator[Path]:
    """A copy of the project without what is made from it, for a while."""
    with tempfile.TemporaryDirectory(dir=folder) as name:
        tree = Path(name)
        for package in COPIED:
            shutil.copytree(ROOT / package, tree / package, ignore=shutil.ignore_patterns("__pycache__"))
        for file in ("pyproject.toml", "README.md"):
            shutil.copy2(ROOT / file, tree / file)
        yield tree


def run_tests(tree: Path, tests: Sequence[str]) -> tuple[int, str]:
    """Exit code of pytest up to the first failure, and that test."""
    cache = tree / "cache"
    cache.mkdir(exist_ok=True)
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith(("PYTEST", "NUMBA"))
    }
    environment |= {"XDG_CACHE_HOME": str(cache), "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1"}
    environment |= {"CI": "1"}  # random tests draw the same examples every time, see `conftest`
    named = [f"tests/{test}" if test.endswith(".py") else test for test in tests]
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:xdist", "-p", "no:cacheprovider", *named]
    try:
        result = subprocess.run(
            command, cwd=tree, env=environment, capture_output=True, text=True, timeout=LONGEST, check=False
        )
    except subprocess.TimeoutExpired:
        return TESTS_FAILED, f"no end within {LONGEST:.0f} s"
    failed = re.search(r"^_+ (?:ERROR at \w+ of )?(\S.*?) _+$", result.stdout, re.MULTILINE)
    last = (result.stdout.strip() or result.stderr.strip() or "nothing said").splitlines()[-1]
    return result.returncode, failed.group(1) if failed else last


if __name__ == "__main__":
    sys.exit(main())
