"""Layouts of the kernels' data: each is declared once, as a named tuple whose arrays have their shapes beside them.

    class Workspace(NamedTuple):
        free: Annotated[FloatArray, "n", 2]  #: positions without contact force [m]

What else lists the fields follows from the declaration: the arrays, and functions that make a tuple from another one.
"""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact import local_arrays
from contact.arrays import IntArray
from contact.jit import inlined


@cache  # asked for each run of a map
def shapes_of(layout: type, **sizes: int) -> dict[str, tuple[Any, ...]]:
    """Shapes of the arrays of a layout, field by field, for sizes by name; one that is not given stays a name."""
    return {
        name: tuple(sizes.get(size, size) for size in kind.__metadata__)
        for name, kind in layout.__annotations__.items()
        if hasattr(kind, "__metadata__")
    }


def zeros_of(layout: type, **sizes: int) -> dict[str, NDArray[Any]]:
    """Arrays of zeros for the fields of a layout."""
    kinds = layout.__annotations__
    return {
        name: np.zeros(shape, dtype=np.int64 if kinds[name].__origin__ == IntArray else np.float64)
        for name, shape in shapes_of(layout, **sizes).items()
    }


def exchanging(layout: Any, *names: str) -> Any:
    """A function, also for kernels: a tuple of this class from another one and, by name, the fields that are others."""
    return _making(layout, ("whole", *names), {name: name for name in names})


def row_of(layout: Any, *names: str) -> Any:
    """As `exchanging`, but of a tuple whose fields have one more axis: it takes that tuple and a row."""
    rows = {name: f"whole.{name}[row]" for name in layout._fields}
    return _making(layout, ("whole", "row", *names), rows | {name: name for name in names})


def room_of(layout: type, **sizes: int) -> tuple[int, int]:
    """How many numbers, and how many counts, the arrays of a layout hold."""
    arrays = zeros_of(layout, **sizes).values()
    numbers = sum(array.size for array in arrays if array.dtype == np.float64)
    return numbers, sum(array.size for array in arrays) - numbers


def parts_of(layout: Any, declared: type, **sizes: int) -> Any:
    """A function for kernels that makes a tuple whose arrays are parts of its `numbers`, or `counts`, in turn."""
    fields, begin = {"numbers": "numbers"}, {"numbers": 0, "counts": 0}
    for name, array in zeros_of(declared, **sizes).items():
        if array.size > 0:
            source = "numbers" if array.dtype == np.float64 else "counts"
            part = "part_row" if array.ndim == 1 else "part_rows"
            fields[name] = f"{part}({source}, {begin[source]}, {', '.join(map(str, array.shape))})"
            begin[source] += array.size
    return _making(layout, ("whole", "numbers", "counts"), fields)


def _making(layout: Any, given: tuple[str, ...], fields: dict[str, str]) -> Any:
    """A function of `given` that makes the tuple from these expressions, and else from the fields of `whole`."""
    made = ", ".join(fields.get(name, f"whole.{name}") for name in layout._fields)
    return inlined(eval(f"lambda {', '.join(given)}: made({made})", vars(local_arrays) | {"made": layout}))
