"""Named tuples that kernels receive as a pointer to their fields.

numba passes a tuple by value, as the scalars of all its arrays: 750 at each call for the data of a run, two thirds of
the code that it generated. The fields of a nested struct are stored inline. Fields cannot be assigned; arrays change in
place.
"""

import hashlib
from typing import Any, TypeVar

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import impl_ret_borrowed
from numba.core.registry import cpu_target
from numba.core.typing.templates import AttributeTemplate
from numba.core.typing.typeof import typeof_impl
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
    type_callable,
    unbox,
)

from contact.compiler import PLAIN

Struct = TypeVar("Struct", bound=type)


class StructType(types.Type):
    """Type of a struct, for the types of its fields."""

    def __init__(self, instance_class: Any, fields: tuple[types.Type, ...]) -> None:
        self.instance_class = instance_class
        self.fields = dict(zip(instance_class._fields, fields, strict=True))
        digest = hashlib.sha256(",".join(map(str, fields)).encode()).hexdigest()[:12]
        super().__init__(f"{instance_class.__module__}.{instance_class.__name__}_{digest}")


@register_model(StructType)
class StructModel(models.OpaqueModel):
    """A pointer."""

    def from_argument(self, builder: Any, value: Any) -> Any:
        """Let the optimiser read fields ahead of the branches and loops that use them."""
        context = cpu_target.target_context
        value.attributes.dereferenceable = context.get_abi_sizeof(_layout(context, self._fe_type))
        return value


def struct(kind: Struct) -> Struct:
    """Decorator of a NamedTuple class: pass its instances to kernels as pointers; kernels can make them, too.

    What a kernel has made is gone when it returns. numba's own passes take twice as long with pointers.
    """
    if PLAIN:
        return kind

    @typeof_impl.register(kind)
    def type_of(value: Any, context: Any) -> StructType:
        return StructType(type(value), tuple(typeof_impl(field, context) for field in value))

    @type_callable(kind)
    def type_made(context: Any) -> Any:
        return lambda *fields: StructType(kind, fields)

    @lower_builtin(kind, types.VarArg(types.Any))
    def make(context: Any, builder: Any, signature: Any, fields: Any) -> Any:
        return _store(context, builder, signature.return_type, fields)

    return kind


def _layout(context: Any, kind: StructType) -> ir.LiteralStructType:
    """Fields in memory."""
    return ir.LiteralStructType(
        [
            _layout(context, field) if isinstance(field, StructType) else context.get_value_type(field)
            for field in kind.fields.values()
        ]
    )


def _store(context: Any, builder: Any, kind: StructType, fields: Any) -> Any:
    """Write the fields to the stack of the function; returns the pointer."""
    place = cgutils.alloca_once(builder, _layout(context, kind))
    for i, (field, value) in enumerate(zip(kind.fields.values(), fields, strict=True)):
        target = cgutils.gep_inbounds(builder, place, 0, i)
        if isinstance(field, StructType):
            size = context.get_abi_sizeof(_layout(context, field))
            cgutils.raw_memcpy(builder, target, value, ir.Constant(ir.IntType(64), size), 1)
        else:
            builder.store(value, target)
    pointer = builder.bitcast(place, cgutils.voidptr_t)
    # Loads are marked as those of constant memory: the compiler must not see that it was written here.
    opaque = ir.FunctionType(cgutils.voidptr_t, [cgutils.voidptr_t])
    return builder.asm(opaque, "", "=r,0,~{memory}", [pointer], side_effect=True)


@unbox(StructType)
def _unbox(kind: StructType, value: Any, c: Any) -> NativeValue:
    """Write the fields of a named tuple from Python to the stack of the entry."""
    fields, failed = [], cgutils.false_bit
    for i, field in enumerate(kind.fields.values()):
        native = c.unbox(field, c.pyapi.tuple_getitem(value, i))
        if native.cleanup is not None:
            raise NotImplementedError(f"{kind}: a field of type {field} needs cleanup")
        fields.append(native.value)
        failed = c.builder.or_(failed, native.is_error)
    return NativeValue(_store(c.context, c.builder, kind, fields), is_error=failed)


@infer_getattr
class _Fields(AttributeTemplate):
    key = StructType

    def generic_resolve(self, kind: StructType, name: str) -> types.Type | None:  # type: ignore[override]
        return kind.fields.get(name)


@lower_getattr_generic(StructType)
def _load(context: Any, builder: Any, kind: StructType, value: Any, name: str) -> Any:
    """A field, by loads of constant memory: no store to an array can change it."""
    place = builder.bitcast(value, _layout(context, kind).as_pointer())
    field = cgutils.gep_inbounds(builder, place, 0, list(kind.fields).index(name))
    if isinstance(kind.fields[name], StructType):
        return builder.bitcast(field, cgutils.voidptr_t)
    return impl_ret_borrowed(context, builder, kind.fields[name], _load_parts(builder, field))


def _load_parts(builder: Any, place: Any) -> Any:
    """What is there; an array member by member, since LLVM forgets that memory is constant where it splits a load."""
    parts = place.type.pointee
    if not isinstance(parts, (ir.LiteralStructType, ir.ArrayType)):
        loaded = builder.load(place)
        loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
        return loaded
    whole = ir.Constant(parts, ir.Undefined)
    for i in range(len(parts)):
        part = _load_parts(builder, cgutils.gep_inbounds(builder, place, 0, i))
        whole = builder.insert_value(whole, part, i)
    return whole
