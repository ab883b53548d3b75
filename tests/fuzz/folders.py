"""Folders of results that something has happened to, and the commands that read them or go on with them.

A run that is finished and one that was interrupted are made once; each input is one of them with one to three of its
files torn, emptied, changed in a bit, replaced or gone, or with a value of `run.json` or a cell of a table replaced.
"""

import json
import os
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

from hypothesis import strategies as st
from inputs import NASTY, Input

import fem.run.solve
from fem.__main__ import main

Draw = Any
CASE = """schema = 1
[container]
width_m = 1.1
height_m = 2.0
weight_N = 24525.0
[contact]
mu_static = 0.4
[motion]
kind = "harmonic"
amplitude_m = 0.05
angular_frequency_rad_s = 7.0
[solver]
model = "rigid"
duration_s = 0.3
[output]
fields_s = 0.1
"""
VALUES = (None, True, -1, 0, 1e300, "text", "", [], [1, 2], {}, {"a": 1}, "../../x", "\u0000", 10**30)
COMMANDS = (
    ("run", "case.toml", "--out", "out", "-q", "--no-band"),
    ("run", "case.toml", "--out", "out", "-q", "--no-band", "--resume"),
    ("run", "case.toml", "--out", "out", "-q", "--band", "--check-rigid"),
    ("report", "out", "-q"),
    ("picture", "out"),
    ("picture", "out", "--time", "0.1", "--to", "p.png"),
)


@cache
def finished() -> dict[str, bytes]:
    """Files of a finished run, by name."""
    return _files_of(0)


@cache
def interrupted() -> dict[str, bytes]:
    """Files of a run that was stopped after its first slice."""
    simulate = fem.run.solve.simulate
    answers = iter([False])

    def first_slice(*arguments: Any, **options: Any) -> Any:
        return simulate(*arguments, **options | {"stop": lambda: next(answers, True)})

    fem.run.solve.simulate = first_slice
    try:
        return _files_of(4)
    finally:
        fem.run.solve.simulate = simulate


def _files_of(expected: int) -> dict[str, bytes]:
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as place:
        os.chdir(place)
        try:
            Path("case.toml").write_text(CASE)
            code = main(("run", "case.toml", "--out", "out", "-q", "--no-band"))
            assert code == expected, code
            return {str(path): path.read_bytes() for path in Path().rglob("*") if path.is_file()}
        finally:
            os.chdir(before)


@st.composite
def damaged_folders(draw: Draw) -> Input:
    """A folder of results with damages, and a command."""
    files = dict(draw(st.sampled_from((finished, interrupted)))())
    results = sorted(name for name in files if name.startswith("out") and "figures" not in name)
    for _ in range(draw(st.integers(1, 3))):
        name = draw(st.sampled_from(results))
        if name in files:
            damaged = draw(damages(name, files.pop(name)))
            if damaged is not None:
                files[name] = damaged
    return Input(arguments=draw(st.sampled_from(COMMANDS)), files=files)


@st.composite
def damages(draw: Draw, name: str, content: bytes) -> bytes | None:
    """A file after something has happened to it; None: it is gone."""
    kinds = ["torn", "bit", "gone", "empty", "noise"]
    if name.endswith((".json", ".csv")):
        kinds += ["value"] * 10
    kind = draw(st.sampled_from(kinds))
    at = draw(st.integers(0, max(len(content) - 1, 0)))
    if kind == "gone":
        return None
    if kind == "torn":
        return content[:at]
    if kind == "bit" and content:
        return content[:at] + bytes([content[at] ^ (1 << draw(st.integers(0, 7)))]) + content[at + 1 :]
    if kind == "noise":
        return draw(st.binary(max_size=200))
    if kind == "value" and name.endswith(".json"):
        try:
            page = json.loads(content)
        except ValueError:
            return content[:at]
        return json.dumps(draw(replaced(page))).encode()
    if kind == "value":
        cells = content.split(b",")
        cells[draw(st.integers(0, len(cells) - 1))] = draw(st.sampled_from(NASTY)).encode()
        return b",".join(cells)
    return b""


@st.composite
def replaced(draw: Draw, page: Any) -> Any:
    """A page with one of its values, at any depth, replaced or left out."""
    if isinstance(page, dict) and page and draw(st.integers(0, 5)) > 0:
        key = draw(st.sampled_from(sorted(page)))
        if draw(st.integers(0, 9)) == 0:
            return {name: value for name, value in page.items() if name != key}
        return page | {key: draw(replaced(page[key]))}
    if isinstance(page, list) and page and draw(st.integers(0, 5)) > 0:
        at = draw(st.integers(0, len(page) - 1))
        return [*page[:at], draw(replaced(page[at])), *page[at + 1 :]]
    return draw(st.sampled_from(VALUES))
