"""The identity of the program: a change of any source is another program."""

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[3]


def test_a_changed_source_is_another_program(tmp_path):
    for package in ("fem", "mesh", "contact"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    found = set()
    for changed in ("mesh/cells.py", "contact/jit.py"):
        with open(tmp_path / changed, "a") as file:
            file.write("# changed\n")
        script = "from fem.runtime.identity import program_identity; print(program_identity()['sources'])"
        found.add(subprocess.check_output([sys.executable, "-c", script], cwd=tmp_path, env={}))
    assert len(found) == 2
