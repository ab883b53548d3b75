"""Compilation of kernels: pieces, structs, layouts, arrays on the stack, and where the machine code is kept."""

import os
import subprocess
import sys
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest
from numba.core import types
from numba.core.errors import TypingError

from contact import jit
from contact.arrays import FloatArray, IntArray
from contact.jit import CacheFolderError, cache_folder, compiled, inlined
from contact.layout import exchanging, parts_of, room_of, row_of, shapes_of, zeros_of
from contact.local_arrays import local_counts, local_row, local_rows, part_row, part_rows
from contact.structs import struct


@compiled(inline=True)
def doubled(x):
    return 2.0 * x


@compiled
def halved(x):
    return 0.5 * x


@inlined
def raised(x):
    return x + 1.0


@compiled
def outermost(x, further):
    if further is not None:
        return untypable(x)
    return raised(doubled(x)) + halved(x)


def untypable(x):
    return x.no_such_attribute


@compiled
def scaled(x, factor):
    return factor * x


@compiled
def of_constants(x):
    return scaled(x, 2) + scaled(x, 3)


def test_a_function_that_kernels_call_is_compiled_as_a_piece_of_these_alone():
    outermost.compile((types.float64, types.none))  # the cache has that of Python alone
    assert len(doubled.overloads) == len(halved.overloads) == 1
    assert not doubled.entry.overloads and not halved.entry.overloads  # no machine code of their own
    assert outermost(2.0, None) == 6.0
    with pytest.raises(TypingError):  # what is not for None is compiled for nothing else
        outermost(4.0, True)
    of_constants.compile((types.float64,))
    assert len(scaled.overloads) == 1  # constants do not multiply the compilations
    assert of_constants(1.0) == 5.0


@struct
class Weights(NamedTuple):
    values: Any


class Others(Weights):
    """The same fields, but another class."""


@struct
class Holder(NamedTuple):
    body: Any


@compiled
def sum_of_held(holder, factor):
    return factor * holder.body.values.sum()


def test_a_call_by_class_tells_bodies_that_hold_others():
    assert sum_of_held.call_by_class(Holder(Weights(np.ones(4))), 2.0) == 8.0
    assert sum_of_held.call_by_class(Holder(Others(np.ones((2, 2), np.int64))), 2.0) == 8.0
    assert sum_of_held.call_by_class(Holder(Weights(np.ones(3))), 2.0) == 6.0
    assert len(sum_of_held.entry.overloads) == 2


@pytest.mark.parametrize(("level", "mode"), [(0, 0o777), (1, 0o777), (2, 0o777), (0, 0o1777)])
def test_kernels_are_not_loaded_from_where_others_may_put_them(tmp_path, monkeypatch, level, mode):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    cache_folder.cache_clear()
    folder = cache_folder()
    (folder, folder.parent, tmp_path)[level].chmod(mode)
    cache_folder.cache_clear()
    with pytest.raises(CacheFolderError):
        cache_folder()
    tmp_path.chmod(0o1777)  # as /tmp
    folder.chmod(0o755)
    folder.parent.chmod(0o755)
    assert cache_folder() == folder
    cache_folder.cache_clear()


def test_an_empty_cache_takes_the_machine_code_of_the_wheel_where_that_fits(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(jit, "SHIPPED", tmp_path / "machine_code")
    cache_folder.cache_clear()
    folder = cache_folder()

    def found(version: str) -> list[str]:
        shipped = tmp_path / "machine_code" / version / folder.name
        shipped.mkdir(parents=True)
        (shipped / f"{version}.nbc").write_bytes(b"code")
        cache_folder.cache_clear()
        assert cache_folder() == folder
        return [path.name for path in folder.iterdir()]

    assert found("python0.0-numba0.0") == []
    assert found(jit.FITTING) == [f"{jit.FITTING}.nbc"]
    (folder / f"{jit.FITTING}.nbc").rename(folder / "compiled.nbc")
    cache_folder.cache_clear()
    assert cache_folder() == folder and [path.name for path in folder.iterdir()] == ["compiled.nbc"]
    (tmp_path / "machine_code").chmod(0o777)
    (folder / "compiled.nbc").unlink()
    cache_folder.cache_clear()
    with pytest.raises(CacheFolderError):
        cache_folder()
    cache_folder.cache_clear()


@struct
class Points(NamedTuple):
    place: Annotated[FloatArray, "n", 2]
    speed: Annotated[FloatArray, "n"]
    side: Annotated[IntArray, "n"]
    weight: float


class Numbered(NamedTuple):
    place: Annotated[FloatArray, "n", 2]
    box: Annotated[FloatArray, "N"]
    side: Annotated[IntArray, "n"]
    speed: Annotated[FloatArray, "n"]
    numbers: FloatArray


with_place = exchanging(Points, "place", "weight")
of_row = row_of(Points, "weight")
numbered_of_two = parts_of(Numbered, Numbered, n=2, N=0)


@compiled
def sum_of_layouts(given, place, rows, row):
    made, one = with_place(given, weight=2.0, place=place), of_row(rows, row, weight=given.weight)
    whole = made.weight * (made.place[0, 1] + made.speed[2] + made.side[2])
    return whole + one.weight * (one.place[1] + one.speed[0] + one.side[0])


@compiled
def write_parts(given, numbers, counts):
    made = numbered_of_two(given, numbers, counts)
    made.place[1, 0], made.speed[0], made.side[1] = 7.0, 8.0, 9
    return made.box.size + made.numbers.size


@pytest.mark.parametrize("kernel", [sum_of_layouts, sum_of_layouts.py_func], ids=["compiled", "Python"])
def test_tuples_are_made_from_others_as_their_layout_declares(kernel):
    assert shapes_of(Points, n=3) == {"place": (3, 2), "speed": (3,), "side": (3,)}
    zeros = zeros_of(Points, n=3)
    zeros["speed"][:], zeros["side"][:] = [1.0, 2.0, 3.0], [4, 5, 6]
    rows = Points(np.array([[1.0, 2.0], [3.0, 4.0]]), np.ones((2, 1)), np.full((2, 1), 5), 0.5)
    found = kernel(Points(**zeros, weight=0.5), np.array([[0.0, 10.0]]), rows, 1)
    assert found == 2.0 * (10.0 + 3.0 + 6.0) + 0.5 * (4.0 + 1.0 + 5.0)


def test_parts_of_numbers_and_counts_follow_in_the_order_of_the_fields():
    assert room_of(Numbered, n=2, N=0) == (6, 2)
    numbers, counts = np.zeros(6), np.zeros(2, np.int64)
    whole = Numbered(np.zeros((2, 2)), np.zeros(0), counts, np.zeros(2), np.zeros(0))
    assert write_parts(whole, numbers, counts) == 6
    assert numbers.tolist() == [0.0, 0.0, 7.0, 0.0, 8.0, 0.0] and counts.tolist() == [0, 9]


@compiled
def work_on_parts(given, rows, counts):
    numbers, table, whole = local_row(6), local_rows(2, 3), local_counts(2)
    for i in range(6):
        numbers[i] += given[i]
    part_row(numbers, 1, 2)[1] = -1.0
    last = part_rows(numbers, 2, 2, 2)
    for i in range(2):
        whole[i] += last.shape[i]
        for k in range(2):
            table[i, k] += last[i, k]
    for i in range(2):
        counts[i] = whole[i]
        for k in range(3):
            rows[i, k] = table[i, k]


def test_parts_share_the_memory_of_their_array_and_all_begin_at_zero():
    for _ in range(2):  # nothing is left of the call before
        rows, counts = np.full((2, 3), np.nan), np.zeros(2, dtype=np.int64)
        work_on_parts(np.arange(6.0), rows, counts)
        assert rows.tolist() == [[-1.0, 3.0, 0.0], [4.0, 5.0, 0.0]]
        assert counts.tolist() == [2, 2]


#: prints which compiler is taken and what a kernel of two pieces gives, given what is taken from numba before
PROGRAM = """
from numba.core import codegen
{change}
from contact import compiler
from contact.jit import compiled

@compiled(inline=True)
def doubled(x):
    return 2.0 * x

@compiled
def outermost(x):
    return doubled(x) + doubled(1.0)

print(compiler.PLAIN, outermost(0.1).hex(), bool(doubled.overloads))
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "environment", "plain"),
    [
        ("", {}, "False"),
        ("del codegen.JITCodeLibrary", {}, "True"),
        ("", {"UNANCHORED_COMPILER": "plain"}, "True"),
    ],
    ids=["pieces", "a missing name", "by request"],
)
def test_numbas_own_passes_compile_where_numba_has_changed_or_by_request(
    tmp_path, change, environment, plain
):
    program = tmp_path / "program.py"  # a cached kernel needs a file
    program.write_text(PROGRAM.format(change=change))
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)} | environment
    command = [sys.executable, str(program)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=300)
    assert done.stdout.split() == [plain, (2.0 * 0.1 + 2.0).hex(), "True"]
