"""The compiler of the kernels: that of `contact.pieces`, or numba's own.

`contact.pieces` builds on parts of numba that it does not promise to keep. Where one is missing, or takes other
parameters, numba's own passes compile; so they do where the environment has UNANCHORED_COMPILER=plain. Results are the
same to the bit, after a longer wait.
"""

import os
from typing import Any

from numba.core.compiler import Compiler

PLAIN = os.environ.get("UNANCHORED_COMPILER") == "plain"  #: whether numba's own passes compile
KernelCompiler: Any = Compiler  #: of a kernel that Python calls
PieceCompiler: Any = Compiler  #: of what only kernels call

try:
    from contact import pieces
except (ImportError, AttributeError):
    PLAIN = True
if not PLAIN:
    KernelCompiler, PieceCompiler = pieces.KernelCompiler, pieces.PieceCompiler
