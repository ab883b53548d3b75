"""The verdict on a fault is that of the fault: nothing computed for another one, or by chance, takes part in it."""

import break_the_physics
import pytest
from break_the_physics import SOURCES, judge, soundness
from mutation import Mutation

#: a law, and what computes with it once and then keeps the result by the place of its file, as numba keeps a kernel
PROJECT = {
    "contact/__init__.py": "",
    "contact/law.py": "FACTOR = 2.0\n",
    "contact/kernel.py": """import os
from pathlib import Path

from contact.law import FACTOR

kept = Path(os.environ["XDG_CACHE_HOME"]) / "kernel"
if not kept.exists():
    kept.write_text(str(FACTOR))


def force():
    return float(kept.read_text())
""",
    "tests/test_law.py": """import os

from contact.kernel import force


def test_force():
    assert force() == 2.0


def test_examples_are_the_same_every_time():
    assert os.environ["CI"]
""",
    "fem/__init__.py": "",
    "mesh/__init__.py": "",
    "pyproject.toml": "",
    "README.md": "",
}


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A project of two modules; the folder for its copies."""
    monkeypatch.setattr(break_the_physics, "ROOT", tmp_path / "project")
    for name, text in PROJECT.items():
        path = tmp_path / "project" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        monkeypatch.setitem(SOURCES, name, text)
    copies = tmp_path / "copies"
    copies.mkdir()
    return copies


def fault(new: str) -> Mutation:
    return Mutation(name=new, old="FACTOR = 2.0", new=new, tests=("test_law.py",))


def test_no_fault_is_judged_by_what_was_computed_before_it(project):
    faults = [fault("FACTOR = 3.0"), fault("FACTOR = 1.0"), fault("FACTOR = 2.00")]
    assert soundness(project, faults) == ""
    assert [judge(one, project).verdict for one in faults] == ["noticed", "noticed", "SURVIVES"]
    assert not list(project.iterdir())


def test_a_fault_that_has_no_place_is_not_judged(project):
    assert (
        judge(Mutation(name="lost", old="FACTOR = 7", new="", tests=("test_law.py",)), project).verdict
        == "no verdict"
    )
