"""Structs of kernels: named tuples that arrive as pointers."""

from typing import Any, NamedTuple

import numpy as np
import pytest
from numba.core import types
from numba.core.errors import TypingError

from contact.jit import compiled
from contact.structs import struct


@struct
class Inner(NamedTuple):
    small: bool
    matrix: Any
    count: int


@struct
class Outer(NamedTuple):
    first: Inner
    factor: float
    second: Inner
    records: Any


class Wider(Outer):
    """The same fields, but another type."""


def outer(kind=Outer):
    records = np.zeros(2, [("flag", "i8"), ("value", "f8")]).view(np.recarray)
    first, second = (Inner(k == 0, np.arange(6.0).reshape(2, 3) + k, 7 + k) for k in range(2))
    return kind(first, 2.5, second, records)


@compiled
def sum_of(data):
    return data.factor * data.first.matrix[1, 2] + data.second.matrix[0, 0] + data.second.count


@compiled
def change(data):
    data.first.matrix[1, 2] = 10.0
    data.records[1].value = data.factor
    return 1 if data.first.small and not data.second.small else 0


@compiled
def sum_exchanged(data):
    exchanged = Outer(data.second, 2.0 * data.factor, data.first, data.records)
    return sum_of(exchanged)


@compiled
def sum_while_changing(data, steps):
    total = 0.0
    for k in range(steps):
        total += data.first.matrix[1, 2]
        data.first.matrix[1, 2] = k
    return total


@compiled
def unknown(data):
    return data.third


def test_fields_of_a_struct_and_of_one_within_it_are_read():
    assert sum_of(outer()) == 2.5 * 5.0 + 1.0 + 8.0


def test_arrays_and_records_change_in_place():
    data = outer()
    assert change(data) == 1
    assert data.first.matrix[1, 2] == 10.0 and data.records[1].value == 2.5
    assert sum_of(data) == 2.5 * 10.0 + 1.0 + 8.0
    assert sum_while_changing(data, 4) == 10.0 + 0.0 + 1.0 + 2.0


def test_a_kernel_makes_a_struct():
    assert sum_exchanged(outer()) == 5.0 * 6.0 + 0.0 + 7.0


def test_a_class_with_the_same_fields_is_another_type():
    assert sum_of(outer(Wider)) == sum_of(outer())
    named = {argument.instance_class for (argument,) in sum_of.entry.overloads}
    assert named == {Outer, Wider}


def test_shapes_of_one_rank_share_a_kernel_and_other_types_of_a_field_do_not():
    before = len(sum_of.entry.overloads)
    data = outer()
    sum_of(data._replace(first=data.first._replace(matrix=np.ones((4, 5)))))
    assert len(sum_of.entry.overloads) == before
    sum_of(data._replace(factor=2))
    assert len(sum_of.entry.overloads) == before + 1


def test_a_field_that_does_not_exist_or_is_assigned_to_is_refused():
    with pytest.raises(TypingError):
        unknown(outer())

    @compiled
    def assign(data):
        data.factor = 1.0

    with pytest.raises(NotImplementedError):
        assign(outer())


def test_a_value_of_another_kind_is_refused():
    with pytest.raises(TypingError):
        sum_of.entry.compile((types.float64,))
