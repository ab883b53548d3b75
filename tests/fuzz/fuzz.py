"""Fuzz: what the program reads, damaged at random; by hand: `python tests/fuzz/fuzz.py 10000`.

Every input goes through the command line, in this process: it must end with 0, 2 (refused, with words), 3 (failed) or 4
(stopped by the clock here, which a long run must hear), never with a traceback, and within a minute. An input is
made from its kind and number alone, so it can be looked at again: `python tests/fuzz/fuzz.py case 17`.
"""

import collections
import contextlib
import faulthandler
import io
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import numpy as np
from random_cases import Tables, chance, log_uniform, pick, random_tables

from fem.__main__ import main
from fem.case import load_case
from fem.case_files import shipped_cases, shipped_text
from fem.case_quantities import Quantity
from fem.case_reading import known_keys, quantity_of
from fem.case_tables import TABLES
from fem.case_toml import toml_value
from fem.model import build_model
from fem.recorder import Recorder
from fem.simulation import simulate
from mesh.container import build_container_mesh
from mesh.files import write_container_mesh
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, Section

LONG, HANGING = 10.0, 120.0  #: a run is asked to stop after the one, and given up after the other [s]
ALLOWED = {0, 2, 3, 4}
NASTY = (
    "-1", "0", "1e-300", "1e300", "nan", "inf", "-inf", '"text"', '""', "true", "[]", "[1, 2]", "{}", "1979-05-27",
    "10000000000000000000000", '"../../etc/passwd"', '"/etc/passwd"', '"auto"', '"a\\u0000b"', "0x7fffffff", "1e-9",
)  # fmt: skip
TABLE = "time_s,acc_m_s2\n" + "".join(f"{0.01 * k:.2f},{np.sin(0.3 * k):.6f}\n" for k in range(60))


def damaged_case(rng: np.random.Generator, folder: Path) -> list[str]:
    """A valid case with up to three keys set to something else: nonsense, or anything in or at the end of its range."""
    model = pick(rng, "rigid", "rigid", "reduced", "reduced", "full")
    tables: Tables = random_tables(rng, model, 0.3 if model != "full" else 0.06)
    text = {
        name: {key: toml_value(value) for key, value in content.items()}
        if isinstance(content, dict)
        else content
        for name, content in tables.items()
    }
    for _ in range(int(rng.integers(0, 4))):
        table = pick(rng, *TABLES)
        content = text.setdefault(table, {})
        key, field = pick(rng, *known_keys(TABLES[table]).items())
        if chance(rng, 0.1) and content:
            content.pop(pick(rng, *content))
        elif chance(rng, 0.1):
            content[key[:-1] + "x"] = "1.0"
        elif chance(rng, 0.3):
            content[key] = pick(rng, *NASTY)
        else:
            content[key] = in_range(rng, quantity_of(field.annotation, field.metadata), field.annotation)
    lines = [f"{key} = {value}" for key, value in text.items() if not isinstance(value, dict)]
    for name, content in text.items():
        if isinstance(content, dict):
            lines += [f"[{name}]", *(f"{key} = {value}" for key, value in content.items())]
    (folder / "case.toml").write_text("\n".join(lines))
    return ["run", str(folder / "case.toml"), "--out", str(folder / "out"), "-q", "--no-band"]


def in_range(rng: np.random.Generator, quantity: Quantity | None, annotation: Any) -> str:
    """A value of a key as TOML: one of its words, or a number at an end of its range, or anywhere within."""
    if quantity is None:
        words = [word for part in (annotation, *get_args(annotation)) for word in get_args(part)]
        words += list(get_args(annotation))
        spelled = [word for word in words if isinstance(word, str)]
        return f'"{pick(rng, *spelled)}"' if spelled else pick(rng, "true", "false", '"x"')
    low = next((b for b in (quantity.least, quantity.above) if b is not None), -1e6)
    high = next((b for b in (quantity.most, quantity.below) if b is not None), 1e12)
    if isinstance(low, int) and isinstance(high, int):
        return str(pick(rng, low, high, int(rng.integers(low, high + 1))))
    least = low if low > 0.0 else 1e-9 * max(abs(high), 1.0)
    inside = log_uniform(rng, least, high) * (pick(rng, 1.0, -1.0) if low < 0.0 else 1.0)
    return repr(float(pick(rng, inside, inside, inside, low, high)))


def damaged_text(rng: np.random.Generator, folder: Path) -> list[str]:
    """A shipped case with bytes changed, or bytes of no meaning."""
    content = shipped_text(pick(rng, *shipped_cases())).encode()
    content = damaged(rng, content) if chance(rng, 0.9) else rng.bytes(int(rng.integers(0, 400)))
    (folder / "case.toml").write_bytes(content)
    return ["check", str(folder / "case.toml")]


def damaged_mesh(rng: np.random.Generator, folder: Path) -> list[str]:
    """A mesh file with bytes changed, of a block or a shell of two boxes."""
    suffix, shell = pick(rng, ".msh", ".vtu", ".vtk", ".inp"), chance(rng, 0.5)
    geometry = ContainerGeometry(
        width=1.1, height=1.0, depth=1.1, boxes=2, section=Section.SHELL if shell else Section.SOLID,
        wall=0.02 if shell else None,
    )  # fmt: skip
    mesh = build_container_mesh(geometry, MassFill(mass=2500.0, centroid_height=0.5), element_size=0.5)
    write_container_mesh(folder / f"mesh{suffix}", mesh)
    content = (folder / f"mesh{suffix}").read_bytes()
    (folder / f"mesh{suffix}").write_bytes(damaged(rng, content) if chance(rng, 0.95) else content)
    wall = "wall_m = 0.02" if shell else 'section = "solid"'
    (folder / "case.toml").write_text(
        f"[container]\nwidth_m = 1.1\nheight_m = 1.0\nboxes = 2\nweight_N = 24525.0\n{wall}\n"
        f'mesh_file = "mesh{suffix}"\n[contact]\nmu_static = 0.4\n[motion]\nkind = "none"\n'
    )
    return ["check", str(folder / "case.toml")]


def damaged_table(rng: np.random.Generator, folder: Path) -> list[str]:
    """A motion table with bytes changed, or columns of nasty numbers."""
    if chance(rng, 0.6):
        content = damaged(rng, TABLE.encode())
    else:
        times = np.sort(rng.normal(size=20) * log_uniform(rng, 1e-6, 1e6)).tolist()
        values = (rng.normal(size=20) * log_uniform(rng, 1e-6, 1e6)).tolist()
        for row in range(int(rng.integers(0, 3))):
            times[row] = pick(rng, float("nan"), times[row + 1], -1e300, 1e300, 0.0)
            values[row] = pick(rng, float("inf"), -1e300, 1e-320, 0.0)
        content = "".join(f"{t!r},{v!r}\n" for t, v in zip(times, values, strict=True)).encode()
    (folder / "floor.csv").write_bytes(content)
    quantity, unit = pick(rng, ("acceleration", "m/s2"), ("acceleration", "g"), ("displacement", "m"))
    baseline = pick(rng, "none", "mean", "linear") if quantity == "acceleration" else "none"
    (folder / "case.toml").write_text(
        "[container]\nwidth_m = 1.1\nheight_m = 4.0\ndensity_kg_m3 = 2000.0\n[contact]\nmu_static = 0.4\n"
        f'[motion]\nkind = "table"\nfile = "floor.csv"\nquantity = "{quantity}"\nunit = "{unit}"\n'
        f'baseline = "{baseline}"\n[solver]\nmodel = "rigid"\nduration_s = 0.5\nelement_size_m = 2.0\n'
        "[output]\nfields_s = 0.0\n"
    )
    return ["run", str(folder / "case.toml"), "--out", str(folder / "out"), "-q", "--no-band"]


def damaged(rng: np.random.Generator, content: bytes) -> bytes:
    """One to six bytes or pieces changed, dropped, doubled or moved."""
    data = bytearray(content)
    for _ in range(int(rng.integers(1, 7))):
        at, length = int(rng.integers(len(data) + 1)), int(log_uniform(rng, 1.0, 40.0))
        match int(rng.integers(5)):
            case 0:
                data[at : at + 1] = rng.bytes(1)
            case 1:
                del data[at : at + length]
            case 2:
                data[at:at] = data[at : at + length]
            case 3:
                data[at : at + 1] = pick(
                    rng, b"9", b"-", b"e", b".", b"0", b"nan", b"1e999", b"\n", b'"', b"[", b","
                )
            case _:
                other = int(rng.integers(len(data) + 1))
                data[at:at] = data[other : other + length]
    return bytes(data)


KINDS: dict[str, tuple[Callable[[np.random.Generator, Path], list[str]], float]] = {
    "case": (damaged_case, 0.4),
    "text": (damaged_text, 0.3),
    "mesh": (damaged_mesh, 0.15),
    "table": (damaged_table, 0.15),
}


def end_of(kind: str, number: int) -> tuple[str, str]:
    """How the program answers an input: the exit code or BROKEN, and what it said."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz"))
    said = io.StringIO()
    clock = threading.Timer(LONG, os.kill, (os.getpid(), signal.SIGINT))
    try:
        make, _ = KINDS[kind]
        arguments = make(np.random.default_rng([number, *kind.encode()]), folder)
        faulthandler.dump_traceback_later(HANGING, exit=True)
        clock.start()
        began = time.monotonic()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            code = main(arguments)
    except BaseException:
        return "BROKEN", traceback.format_exc()
    finally:
        clock.cancel()
        faulthandler.cancel_dump_traceback_later()
        shutil.rmtree(folder, ignore_errors=True)
    words = said.getvalue()
    if code not in ALLOWED or "Traceback" in words or (code == 2 and not words.strip()):
        return "BROKEN", f"exit {code}: {words}"
    took = time.monotonic() - began
    return str(code), f"({took:.0f} s) {words}" if took > LONG else words


def warm_up() -> None:
    """Import and compile before the clocks run: an import that is interrupted leaves half a module behind."""
    for model in ("rigid", "reduced", "full"):
        built = build_model(load_case("seed_box", [f"solver.model={model}", "solver.duration_s=0.02"]))
        simulate(built, Recorder(built))


def fuzz(kind: str, numbers: range, tell: Callable[[str], None] = print) -> collections.Counter[str]:
    """Answers to a range of inputs of one kind, counted; tells what is broken, long or failed."""
    ends: collections.Counter[str] = collections.Counter()
    for number in numbers:
        end, words = end_of(kind, number)
        ends[end] += 1
        if end in ("BROKEN", "4") or words.startswith("("):
            tell(f"{kind} {number} {end} {words}")
    return ends


if __name__ == "__main__":
    warm_up()
    if sys.argv[1] in KINDS:
        print(*end_of(sys.argv[1], int(sys.argv[2])))
    else:
        for each, (_, share) in KINDS.items():
            print(each, dict(fuzz(each, range(int(share * int(sys.argv[1]))))), flush=True)
