"""What follows from the declaration of a layout: arrays, and functions that make a tuple from another one."""

from typing import Annotated, NamedTuple

import numpy as np
import pytest

from contact.arrays import FloatArray, IntArray
from contact.jit import compiled
from contact.layout import exchanging, parts_of, room_of, row_of, shapes_of, zeros_of
from contact.structs import struct


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


def points() -> Points:
    zeros = zeros_of(Points, n=3)
    zeros["speed"][:], zeros["side"][:] = [1.0, 2.0, 3.0], [4, 5, 6]
    return Points(**zeros, weight=0.5)


@compiled
def sum_exchanged(given, place):
    made = with_place(given, weight=2.0, place=place)
    return made.weight * (made.place[0, 1] + made.speed[2] + made.side[2])


@compiled
def sum_of_row(given, row):
    made = of_row(given, row, weight=given.weight)
    return made.weight * (made.place[1] + made.speed[0] + made.side[0])


@compiled
def write_parts(given, numbers, counts):
    made = numbered_of_two(given, numbers, counts)
    made.place[1, 0], made.speed[0], made.side[1] = 7.0, 8.0, 9
    return made.box.size + made.numbers.size


def test_shapes_are_those_declared():
    assert shapes_of(Points, n=3) == {"place": (3, 2), "speed": (3,), "side": (3,)}
    assert shapes_of(Points)["place"] == ("n", 2)
    zeros = zeros_of(Points, n=3)
    assert zeros["place"].shape == (3, 2) and zeros["place"].dtype == np.float64
    assert zeros["side"].dtype == np.int64


@pytest.mark.parametrize("kernel", [sum_exchanged, sum_exchanged.py_func], ids=["compiled", "Python"])
def test_fields_are_exchanged_by_name(kernel):
    assert kernel(points(), np.array([[0.0, 10.0]])) == 2.0 * (10.0 + 3.0 + 6.0)


def test_a_row_is_taken_of_every_field_but_those_given():
    rows = Points(np.array([[1.0, 2.0], [3.0, 4.0]]), np.ones((2, 1)), np.full((2, 1), 5), 0.5)
    assert sum_of_row(rows, 1) == sum_of_row.py_func(rows, 1) == 0.5 * (4.0 + 1.0 + 5.0)


def test_parts_of_numbers_and_counts_follow_in_the_order_of_the_fields():
    assert room_of(Numbered, n=2, N=0) == (6, 2)
    numbers, counts = np.zeros(6), np.zeros(2, np.int64)
    whole = Numbered(np.zeros((2, 2)), np.zeros(0), counts, np.zeros(2), np.zeros(0))
    assert write_parts(whole, numbers, counts) == 6
    assert numbers.tolist() == [0.0, 0.0, 7.0, 0.0, 8.0, 0.0] and counts.tolist() == [0, 9]
