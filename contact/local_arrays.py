"""Small arrays of constant shape on the stack of a kernel, which the compiler keeps in registers.

They are gone when the function returns in which they are made. Where all indices are constants once loops are unrolled,
and no array is passed to a function that is not inlined, no memory is left of them.
"""

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

ITEM = 8  #: bytes


def _array(context: Any, builder: Any, kind: types.Array, data: Any, shape: tuple[int, ...]) -> Any:
    """An array of this type and shape on the memory at `data`."""
    array = context.make_array(kind)(context, builder)
    strides = [ITEM * shape[1], ITEM] if len(shape) == 2 else [ITEM]
    context.populate_array(
        array,
        data=data,
        shape=[context.get_constant(types.intp, size) for size in shape],
        strides=[context.get_constant(types.intp, stride) for stride in strides],
        itemsize=context.get_constant(types.intp, ITEM),
        meminfo=None,
    )
    return array._getvalue()


def _made(item: types.Type, *sizes: types.IntegerLiteral) -> Any:
    """What an intrinsic returns that makes an array of zeros."""
    shape = tuple(size.literal_value for size in sizes)
    kind = types.Array(item, len(shape), "C")

    def make(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        count = shape[0] * shape[-1] if len(shape) == 2 else shape[0]
        place = ir.ArrayType(context.get_value_type(item), count)
        data = cgutils.gep_inbounds(builder, cgutils.alloca_once(builder, place, zfill=True), 0, 0)
        return _array(context, builder, kind, data, shape)

    return kind(*sizes), make


def _cut(numbers: types.Array, begin: types.IntegerLiteral, *sizes: types.IntegerLiteral) -> Any:
    """What an intrinsic returns that makes an array of a part of another one."""
    shape = tuple(size.literal_value for size in sizes)
    kind = types.Array(numbers.dtype, len(shape), "C")

    def cut(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        whole = context.make_array(numbers)(context, builder, arguments[0])
        data = builder.gep(whole.data, [ir.Constant(ir.IntType(64), begin.literal_value)], inbounds=True)
        return _array(context, builder, kind, data, shape)

    return kind(numbers, begin, *sizes), cut


_of_constants: Any = intrinsic(prefer_literal=True)
#: an array (size,) of zeros; (rows, columns); (size,) of whole numbers
local_row: Any = _of_constants(lambda typing, size: _made(types.float64, size))
local_rows: Any = _of_constants(lambda typing, rows, columns: _made(types.float64, rows, columns))
local_counts: Any = _of_constants(lambda typing, size: _made(types.int64, size))
#: the part (size,) of an array (n,) from `begin` on; the same as rows (rows, columns)
part_row: Any = _of_constants(lambda typing, numbers, begin, size: _cut(numbers, begin, size))
part_rows: Any = _of_constants(
    lambda typing, numbers, begin, rows, columns: _cut(numbers, begin, rows, columns)
)
