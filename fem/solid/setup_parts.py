"""Long set-ups in parts: whoever computes one hands over each large array as it is made, to whoever may keep it.

A part is computed the same whether the others were kept or not, so that a set-up gone on with comes to the same bits.
"""

from collections.abc import Callable, Iterator
from typing import Protocol

from fem.runtime.arrays import FloatArray


class Parts(Protocol):
    """Somebody who may keep the parts of a set-up."""

    def fill(self, name: str, target: FloatArray, make: Callable[[], FloatArray]) -> None:
        """Put a part into `target`: as it was kept, else as `make` returns it. The target is not changed afterwards.

        Args:
            name: of the part; a set-up asks for the same names in the same order every time.
            target: array, or part of one, for it.
            make: computes it, of the target's shape.
        """


class NoParts:
    """Keeps nothing."""

    def fill(self, name: str, target: FloatArray, make: Callable[[], FloatArray]) -> None:
        """As it is made."""
        target[...] = make()


def blocks(count: int, largest: int) -> Iterator[slice]:
    """The first `count` numbers in blocks of at most `largest`; by sizes alone, never by how fast the machine is."""
    for first in range(0, count, largest):
        yield slice(first, min(first + largest, count))
