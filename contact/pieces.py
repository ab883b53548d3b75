"""numba's compiler for kernels, and for those that only other kernels call, as pieces of these.

numba optimises each function with all that it calls and makes machine code of it, and does so again for each function
that calls it in turn. For a function that only kernels call, both are for nothing: here its code is passed on as numba
writes it, and is optimised where it is used. It has no entry from Python.

This builds on parts of numba that may change: `contact.compiler` does without this module where it cannot be imported.
"""

import gc
from collections.abc import Callable
from inspect import signature
from typing import Any

from llvmlite.binding import parse_assembly
from numba import _dynfunc  # type: ignore[attr-defined]
from numba.core.base import BaseContext
from numba.core.codegen import CPUCodegen, JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.typed_passes import AnnotateTypes, NativeLowering

SIMPLIFIED = 1  #: level of LLVM's optimisation
NEW_OBJECTS = 50_000  #: between two searches of Python for cycles, which else take a tenth of a compilation


def _require(function: Callable[..., Any], *parameters: str) -> None:
    """Refuse a numba whose function takes other parameters than this module was written for."""
    if tuple(signature(function).parameters) != parameters:
        raise ImportError(f"numba: {function.__qualname__} takes other parameters")


_require(JITCodeLibrary._optimize_functions, "self", "ll_module")
_require(JITCodeLibrary._optimize_final_module, "self")
_require(JITCodeLibrary._finalize_final_module, "self")
_require(CPUCodegen._function_pass_manager, "self", "kwargs")
_require(BaseContext.insert_user_function, "self", "func", "fndesc", "libs")
_require(DefaultPassBuilder.define_nopython_pipeline, "state", "name")


class KernelLibrary(JITCodeLibrary):
    """Code of a kernel."""

    def _optimize_functions(self, ll_module: Any) -> None:
        """Simplify only: to unroll a loop around calls would multiply what these contain."""
        ll_module.data_layout = self._codegen._data_layout
        for function in ll_module.functions:
            passes, builder = self._codegen._function_pass_manager(opt=SIMPLIFIED)
            passes.run(function, builder)

    def _finalize_final_module(self) -> None:
        """Keep names in place of what others could link, which nobody does: it takes longer to load than all else."""
        super()._finalize_final_module()
        names = [function.name for function in self._final_module.functions if not function.is_declaration]
        self._shared_module = parse_assembly(
            "".join(f'define void @"{name}"() {{ ret void }}\n' for name in names)
        )


class PieceLibrary(KernelLibrary):
    """Code for the libraries that link it."""

    def _optimize_final_module(self) -> None: ...

    def _finalize_final_module(self) -> None:
        self._finalized = True


@register_pass(mutates_CFG=False, analysis_only=False)
class BeginKernel(LoweringPass):
    """Lower the function into a `KernelLibrary`."""

    _name = "begin_kernel"

    def __init__(self) -> None: ...

    def run_pass(self, state: Any) -> bool:
        state.library = KernelLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return True


@register_pass(mutates_CFG=False, analysis_only=False)
class BeginPiece(LoweringPass):
    """Lower the function into a `PieceLibrary`."""

    _name = "begin_piece"

    def __init__(self) -> None: ...

    def run_pass(self, state: Any) -> bool:
        state.library = PieceLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        return True


@register_pass(mutates_CFG=False, analysis_only=False)
class EndPiece(LoweringPass):
    """Make the lowered function known to its callers, by an object that no machine code belongs to."""

    _name = "end_piece"

    def __init__(self) -> None: ...

    def run_pass(self, state: Any) -> bool:
        lowered = state["cr"]
        name, nothing = lowered.fndesc.qualname, 0
        key = _dynfunc.make_function(
            lowered.fndesc.lookup_module(), name, "", nothing, lowered.env, (state.library,)
        )
        state.targetctx.insert_user_function(key, lowered.fndesc, [state.library])
        state["cr"] = lowered._replace(cfunc=key)
        return True


class KernelCompiler(CompilerBase):
    """numba's compiler, but for kernels."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function, and first what it calls; most of the objects made on the way stay till the end."""
        youngest, *older = gc.get_threshold()
        gc.set_threshold(max(youngest, NEW_OBJECTS), *older)
        try:
            return super().compile_extra(func)
        finally:
            gc.set_threshold(youngest, *older)

    def define_pipelines(self) -> list[Any]:
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(BeginKernel, AnnotateTypes)
        passes.finalize()
        return [passes]


class PieceCompiler(CompilerBase):
    """numba's compiler, but for pieces."""

    def define_pipelines(self) -> list[Any]:
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(BeginPiece, AnnotateTypes)
        passes.add_pass_after(EndPiece, NativeLowering)
        passes.finalize()
        return [passes]
