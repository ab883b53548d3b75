"""Compare what two checkouts of the program compute, byte by byte.

    python tests/golden.py compute CHECKOUT RESULTS [-j JOBS] [--only WORDS] [--quick]
    python tests/golden.py compare BEFORE AFTER [--show LINES]

`compute` runs the commands of `ITEMS` with the program of a checkout: every shipped case, sweep, ensemble and site, a
response curve, `size`, `verify`, `study`, `validate` and their pages, and cases of every body, law and motion.
`compare` ends with 1 where a file differs: CSV and fields as bytes, JSON as parsed, pages as their text. Left out are
times of computing, versions, and hashes of the program.
"""

import argparse
import difflib
import html
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

#: a sweep with copies and thresholds, small
SWEEP = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"solver.duration_s" = 4.0
[axes]
"motion.angular_frequency_rad_s" = { from = 2.0, to = 6.0, count = 4 }
"motion.peak_acceleration_m_s2" = { from = 2.0, to = 14.0, count = 5 }
[derived]
"contact.mu_kinetic" = "0.5 * contact.mu_static"
"""
#: a hall
LIST = "name,count,tag,width_m,mu_static,x_m,y_m\nA,2,a,1.0,0.5,0,0\nB,1,b,0.6,,3,0\nbad,1,a,-1,,,\nC,1,a,2.4,0.2,0,3\n"
RECORD = "0 1.2 -2.5 3.9 -4.4 3.0 -1.1 0.4 0 0 0"
PULSE = ("motion.kind=pulse", "motion.shape=sine", "motion.peak_acceleration_m_s2=3.8", "motion.pulse_s=1.0")
LINKS = (
    "stop=[{side = 'right', height_m = 0.1, gap_m = 0.02, stiffness_N_m = 1e8, restitution = 0.5, mu = 0.3}]",
    "tie=[{from = 'left', height_m = 0.5, slack_m = 0.01, stiffness_N_m = 1e6, strength_N = 2e4}]",
)
VERTICAL = ("vertical.kind=harmonic", "vertical.peak_acceleration_m_s2=2.0", "vertical.frequency_Hz=3.0")
LOOSE = "container.joints=loose"


@dataclass(frozen=True)
class Item:
    """Commands whose results are compared, in a folder of their own."""

    name: str
    commands: tuple[tuple[str, ...], ...]  #: words behind `python -m fem`
    long: bool = False  #: left out by --quick


def run(name: str, case: str, *keys: str, options: Sequence[str] = (), long: bool = False) -> Item:
    """A run and its page."""
    words = [word for key in keys for word in ("--set", key)]
    commands = (("run", case, "--out", "out", *words, *options), ("report", "out", "-q"))
    return Item(name, commands, long)


def study(command: str, name: str, *options: str, long: bool = False) -> Item:
    """A study in a folder, and its page."""
    label = f"{command} {Path(name).stem}".strip()
    return Item(label, ((command, name, *options, "--out", "out"), ("report", "out", "-q")), long)


ALONE, SIZE = ("--no-band",), "size width"
SEED = ("seed_box", "seed_stack", "seed_stack_plateau", "stack_on_concrete")
CASES = ("free_rocking", "overturning", "rocking", *SEED, "sliding")
ITEMS = (
    *(run(f"run {case}", case) for case in CASES),
    *(Item(f"check {case}", (("check", case), ("check", case, "--json"))) for case in CASES),
    Item("check site", (("check", "site"), ("check", "site", "--json"))),
    run("run rigid", "rocking", "solver.model=rigid", options=["--check-rigid"]),
    run("run rigid floor", "rocking", "floor.kind=rigid", options=["--no-band"]),
    run("run full", "free_rocking", "solver.model=full", "solver.duration_s=1", options=["--no-band"]),
    run("run flat", "seed_stack_plateau", "support.kind=flat", "solver.duration_s=4", options=["--no-band"]),
    run("run feet", "seed_stack_plateau", "support.kind=feet", "support.foot_m=0.15", options=["--no-band"]),
    run("run loose", "rocking", LOOSE, "solver.model=rigid", "solver.duration_s=8"),
    run("run loose reduced", "rocking", LOOSE, "solver.duration_s=3", options=["--no-band"]),
    run("run loose full", "rocking", LOOSE, "solver.model=full", "solver.duration_s=0.5", options=ALONE),
    run("run regularised", "sliding", "contact.friction=regularised", options=["--no-band"]),
    run("run weakening", "sliding", "contact.weakening_m=2e-4", options=["--no-band"]),
    run("run pulse", "rocking", *PULSE, "solver.model=rigid"),
    run("run slope", "rocking", "floor.slope_percent=3", "solver.model=rigid"),
    run("run vertical", "rocking", *VERTICAL, "solver.model=rigid"),
    run("run links", "rocking", *LINKS, "solver.model=rigid"),
    run("run record", "record.toml", options=["--check-rigid"]),
    run("run newmark", "sliding", "solver.scheme=newmark", "solver.step_s=1e-3", options=["--no-band"]),
    Item("modes", (("modes", "rocking", "--out", "out"),)),
    study("sweep", "small.toml"),
    *(study("sweep", name, long=True) for name in ("friction_slenderness", "outcome_map", "rigid_to_soft")),
    study("sweep", "loose_stack", long=True),
    *(study("sweep", name, long=True) for name in ("kerb_gap", "neighbour_gap")),
    *(study("ensemble", name, long=True) for name in ("boundary", "fragility")),
    study("response", "rocking", "--from", "0.8", "--to", "1.6", "--count", "5"),
    study("assess", "site", long=True),
    study("batch", "list.csv", "--case", "rocking.toml"),
    replace(study("size", "site.toml", "--over", "container.width_m", "--count", "3", long=True), name=SIZE),
    Item("verify", (("verify", "--out", "out"),), long=True),
    Item("study", (("study", "seed", "--out", "out"),), long=True),
    Item("validate", (("validate", "--out", "out"),)),
    Item("schema", (("schema",), ("schema", "sweep"), ("schema", "site"), ("list",))),
)

#: keys of JSON and columns of tables that are times, versions or hashes of the program
LEFT_OUT = re.compile(
    r"wall_s|cpu_s|stepping_cpu_s|compile_s|price_s|left_out|versions?|.*hash|asked|request_hash|digest|program|seconds|sha256|created"
)
#: the same in text
CLOCK = re.compile(
    r"[0-9a-f]{12,64}|(?<=computing time)[^\n]*(?:\n {10,}[^\n]*)*"
    r"|[\d.]+ (?:CPU )?(?:s|ms|min|minutes|runs/s)\b(?= (?:wall|on|of which|in all|stepping))"
    r"|(?:in|took|after) [\d.:]+ ?(?:s|min|ms)\b|\d\d:\d\d|20\d\d-\d\d-\d\d"
)
SKIPPED = {".npz", ".png", ".log", ".lock"}


def compute_item(checkout: Path, results: Path, item: Item) -> bool:
    """Whether a command of an item failed; what they print stands in `terminal.txt`."""
    folder = results / item.name.replace(" ", "-")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "small.toml").write_text(SWEEP)
    (folder / "list.csv").write_text(LIST)
    rows = "\n".join(f"{0.1 * k:.1f} {value}" for k, value in enumerate(RECORD.split()))
    (folder / "record.txt").write_text(rows + "\n")
    python = own if (own := checkout / ".venv/bin/python").exists() else Path(sys.executable)
    environment = os.environ | {"PYTHONPATH": str(checkout), "COLUMNS": "80", "NO_COLOR": "1"}

    def call(*arguments: str) -> tuple[int, str]:
        words = [str(python), "-m", "fem", *arguments]
        done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout

    call("init", "rocking", "--to", "rocking.toml")
    call("init", "site", "--to", "site.toml")
    case = (folder / "rocking.toml").read_text()
    motion = "[motion]\nkind = 'table'\nfile = 'record.txt'\nunit = 'm/s2'\n\n["
    (folder / "record.toml").write_text(re.sub(r"^\[motion\].*?^\[", motion, case, flags=re.M | re.S))
    said, failed = [], False
    for command in item.commands:
        code, text = call(*command)
        failed |= code not in (0, 3)
        said.append(f"$ {' '.join(command)}\n{text}exit code {code}\n")
    (folder / "terminal.txt").write_text("\n".join(said))
    print(f"{'FAILED  ' if failed else 'computed'} {item.name}", flush=True)
    return failed


def compare(before: Path, after: Path, lines: int) -> int:
    """Print what differs; the number of files that do."""
    names = sorted(
        {path.relative_to(root).as_posix() for root in (before, after) for path in root.rglob("*")}
    )
    counts, differing = 0, []
    for name in names:
        one, other = before / name, after / name
        if one.is_dir() or other.is_dir() or one.suffix in SKIPPED or other.suffix in SKIPPED:
            continue
        counts += 1
        if not (one.exists() and other.exists()):
            differing.append(name)
            print(f"only {'before' if one.exists() else 'after'}: {name}")
        elif (old := contents(one)) != (new := contents(other)):
            differing.append(name)
            print(f"differs: {name}")
            if isinstance(old, str) and isinstance(new, str):
                shown = difflib.unified_diff(old.splitlines(), new.splitlines(), lineterm="", n=0)
                print("\n".join(f"    {line[:200]}" for line in list(shown)[2 : 2 + lines]))
    print(f"{counts} files compared, {len(differing)} differ")
    return len(differing)


def contents(path: Path) -> str | bytes:
    """What of a file is compared."""
    data = path.read_bytes()
    if path.suffix == ".json":
        return json.dumps(without_clock(json.loads(data)), indent=1, ensure_ascii=False)
    if path.suffix == ".csv":
        return table_without_clock(data.decode())
    if path.suffix == ".html":
        return CLOCK.sub("..", page_text(data.decode()))
    if path.suffix == ".vtu" or b"\0" in data:
        return data
    return CLOCK.sub("..", data.decode(errors="replace"))


def without_clock(block: Any) -> Any:
    """JSON without times, versions and hashes; keys in the order of the alphabet."""
    if isinstance(block, dict):
        return {key: without_clock(block[key]) for key in sorted(block) if not LEFT_OUT.fullmatch(key)}
    if isinstance(block, list):
        return [without_clock(item) for item in block]
    return CLOCK.sub("..", block) if isinstance(block, str) else block


def table_without_clock(text: str) -> str:
    """A table without the columns of times."""
    lines = text.split("\n")
    dropped = [k for k, name in enumerate(lines[0].split(",")) if LEFT_OUT.fullmatch(name)]
    if not dropped:
        return text
    rows = (line.split(",") for line in lines)
    return "\n".join(",".join(word for k, word in enumerate(row) if k not in dropped) for row in rows)


def page_text(page: str) -> str:
    """The text of a page, a line an element, wherever its source breaks the line."""
    body = re.sub(r"<(style|script)\b.*?</\1>", "", page, flags=re.S)
    text = html.unescape(re.sub(r"<[^>]*>", "\n", re.sub(r"\s+", " ", body)))
    return "\n".join(line for raw in text.split("\n") if (line := " ".join(raw.split())))


def main(arguments: Sequence[str] | None = None) -> int:
    """Compute or compare."""
    parser = argparse.ArgumentParser(description="Compare what two checkouts compute.")
    commands = parser.add_subparsers(dest="command", required=True)
    computing = commands.add_parser("compute")
    computing.add_argument("checkout", type=Path)
    computing.add_argument("results", type=Path)
    computing.add_argument("-j", "--jobs", type=int, default=1)
    computing.add_argument("--only", default="", help="items whose name contains these words")
    computing.add_argument("--quick", action="store_true", help="leave out the long items")
    comparing = commands.add_parser("compare")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    comparing.add_argument("--show", type=int, default=12, help="lines of each difference")
    options = parser.parse_args(arguments)
    if options.command == "compute":
        checkout, results = options.checkout.resolve(), options.results.resolve()
        chosen = [one for one in ITEMS if options.only in one.name and not (options.quick and one.long)]
        with ThreadPoolExecutor(options.jobs) as pool:
            return int(any(list(pool.map(lambda item: compute_item(checkout, results, item), chosen))))
    return int(compare(options.before, options.after, options.show) > 0)


if __name__ == "__main__":
    sys.exit(main())
