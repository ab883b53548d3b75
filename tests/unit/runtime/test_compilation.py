"""What compiling costs is counted, apart from what is loaded or run; and a long compilation is told beforehand."""

import re
import time

import numba
import pytest

from fem.runtime.compilation import compilation_announced, compilation_time


def kernel(name, calls=None):
    """A function that numba has not seen, which may call another."""

    def function(x):
        return x + 1.0

    def caller(x):
        return calls(x) + 1.0

    made = function if calls is None else caller
    made.__name__ = name
    return numba.njit(made)


def test_a_kernel_is_counted_when_it_is_compiled_and_never_again():
    made = kernel("small")
    before, began = compilation_time(), time.perf_counter()
    made(1.0)
    took, counted = time.perf_counter() - began, compilation_time() - before
    assert 0.0 < counted <= took
    made(2.0)
    assert compilation_time() - before == counted


def test_a_compilation_within_another_is_counted_once():
    outer = kernel("outer", calls=kernel("inner"))
    before, began = compilation_time(), time.perf_counter()
    outer(1.0)
    assert 0.0 < compilation_time() - before <= time.perf_counter() - began


def test_a_compilation_that_fails_is_counted_and_ended():
    broken = numba.njit(lambda x: x.no_such_attribute)
    before = compilation_time()
    with pytest.raises(numba.TypingError):
        broken(1.0)
    failed = compilation_time() - before
    assert failed > 0.0
    kernel("small")(1.0)
    assert compilation_time() - before > failed


def test_inside_another_announcement_only_that_one_is_made():
    outer, inner = [], []
    with compilation_announced(outer.append), compilation_announced(inner.append):
        kernel("advance")(1.0)
    assert (len(outer), inner) == (1, [])


def test_each_stepping_is_told_before_it_is_compiled_and_what_is_left_of_it_but_small_kernels_are_not():
    said = []
    with compilation_announced(said.append):
        kernel("hermite")(1.0)
        kernel("advance_in_slices", calls=kernel("advance_on_points", calls=kernel("advance")))(1.0)
        kernel("advance")(1.0)
    told = "compiling the stepping of this model, step 1 of 2, once after installation: half a minute or more"
    left = r"compiling the stepping, step 2 of 2: 2 functions translated, \d+ s left"
    assert re.fullmatch(left, said.pop(1))
    assert said == [told, told]
