"""Where numba has changed, or by request, its own passes compile the kernels: the same results, later."""

import os
import subprocess
import sys

import pytest

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
RESULT = (2.0 * 0.1 + 2.0).hex()


def printed(folder, change="", **environment):
    program = folder / "program.py"  # a cached kernel needs a file
    program.write_text(PROGRAM.format(change=change))
    done = subprocess.run(
        [sys.executable, str(program)],
        env=os.environ | {"NUMBA_CACHE_DIR": str(folder)} | environment,
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
    )
    return done.stdout.split()


def test_kernels_are_compiled_in_pieces(tmp_path):
    assert printed(tmp_path) == ["False", RESULT, "True"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        "del codegen.JITCodeLibrary",
        "own = codegen.CPUCodegen._function_pass_manager\n"
        "codegen.CPUCodegen._function_pass_manager = lambda self, module=None, **others: own(self, **others)",
    ],
    ids=["a missing name", "other parameters"],
)
def test_numbas_own_passes_compile_where_what_the_pieces_use_has_changed(tmp_path, change):
    assert printed(tmp_path, change) == ["True", RESULT, "True"]


@pytest.mark.slow
def test_the_environment_asks_for_numbas_own_passes(tmp_path):
    assert printed(tmp_path, UNANCHORED_COMPILER="plain") == ["True", RESULT, "True"]
