"""Compilation of kernels: what only kernels call is a piece of these."""

from typing import Any, NamedTuple

import numpy as np
import pytest
from numba.core import types
from numba.core.errors import TypingError

from contact.jit import CacheFolderError, cache_folder, compiled, inlined
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


def test_a_function_that_kernels_call_is_compiled_as_a_piece_of_these_alone():
    outermost.compile((types.float64, types.none))  # the cache has that of Python alone
    assert len(doubled.overloads) == len(halved.overloads) == 1
    assert not doubled.entry.overloads and not halved.entry.overloads  # no machine code of their own
    assert outermost(2.0, None) == 6.0
    assert doubled(2.0) == 4.0 and halved(2.0) == 1.0
    assert len(doubled.entry.overloads) == len(halved.entry.overloads) == 1


def test_what_is_not_for_none_is_not_compiled():
    """So a body that moves as one is stepped without the kernels of loose stacks."""
    assert outermost(4.0, None) == 11.0
    with pytest.raises(TypingError):
        outermost(4.0, True)


@compiled
def scaled(x, factor):
    return factor * x


@compiled
def of_constants(x):
    return scaled(x, 2) + scaled(x, 3)


def test_constants_do_not_multiply_the_compilations_of_a_piece():
    of_constants.compile((types.float64,))
    assert len(scaled.overloads) == 1
    assert of_constants(1.0) == 5.0


@struct
class Weights(NamedTuple):
    values: Any


class Others(Weights):
    """The same fields, but another class."""


@compiled
def sum_of(weights, factor):
    return factor * weights.values.sum()


@struct
class Holder(NamedTuple):
    body: Any


@compiled
def sum_of_held(holder, factor):
    return factor * holder.body.values.sum()


def test_a_call_by_class_tells_bodies_that_hold_others():
    assert sum_of_held.call_by_class(Holder(Weights(np.ones(4))), 2.0) == 8.0
    assert sum_of_held.call_by_class(Holder(Others(np.ones((2, 2), np.int64))), 2.0) == 8.0


def test_a_call_by_class_takes_the_types_of_the_first_of_its_classes():
    assert sum_of.call_by_class(Weights(np.ones(2)), 2.0) == 4.0
    assert sum_of.call_by_class(Weights(np.ones(3)), 2.0) == 6.0
    assert sum_of.call_by_class(Others(np.ones((2, 2), np.int64)), 2.0) == 8.0
    assert sum_of.call_by_class(Weights(np.ones(4)), 2.0) == 8.0
    assert len(sum_of.entry.overloads) == 2


@pytest.mark.parametrize(("level", "mode"), [(0, 0o777), (1, 0o777), (2, 0o777), (0, 0o1777)])
def test_kernels_are_not_loaded_from_where_others_may_put_them(tmp_path, monkeypatch, level, mode):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    cache_folder.cache_clear()
    folder = cache_folder()
    (folder, folder.parent, tmp_path)[level].chmod(mode)
    cache_folder.cache_clear()
    with pytest.raises(
        CacheFolderError, match=r"others may write .*: name a folder of your own as NUMBA_CACHE_DIR"
    ):
        cache_folder()
    tmp_path.chmod(0o1777)  # as /tmp
    folder.chmod(0o755)
    folder.parent.chmod(0o755)
    assert cache_folder() == folder
    cache_folder.cache_clear()
