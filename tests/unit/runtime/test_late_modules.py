"""What libraries import and a run does not use is loaded at its first use."""

import subprocess
import sys

SCRIPT = """
import sys
from fem.runtime.late_modules import LATE, load_late
load_late()
import scipy.linalg
from numpy import f2py
assert "numpy.f2py.crackfortran" not in sys.modules
assert "numpy.testing._private" not in sys.modules
assert f2py.run_main and scipy.linalg.inv([[2.0]]) == 0.5
assert "numpy.f2py.crackfortran" in sys.modules
from numpy.testing import assert_allclose
assert_allclose(1.0, 1.0)
"""


def test_they_are_loaded_when_they_are_used_and_not_before():
    subprocess.run([sys.executable, "-c", SCRIPT], check=True, timeout=60)
