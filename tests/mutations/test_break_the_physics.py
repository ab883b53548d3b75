"""The faults keep up with the code; the verdict on one is its own: nothing computed before or by chance takes part."""

import ast

import break_the_physics
import pytest
from break_the_physics import FAULTS, ROOT, Mutation, judge, soundness

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


def test_there_are_enough_faults_and_no_two_alike():
    assert len(FAULTS) >= 150
    assert len({(m.file, m.old) for m in FAULTS}) == len({m.name for m in FAULTS}) == len(FAULTS)
    assert {m.file.split("/")[0] for m in FAULTS} == {"fem", "mesh", "contact", "tests"}


@pytest.mark.parametrize("mutation", FAULTS, ids=lambda mutation: mutation.name)
def test_a_fault_stands_once_in_its_file_leaves_code_and_has_tests(mutation):
    text = (ROOT / mutation.file).read_text(encoding="utf-8")
    broken = ast.dump(ast.parse(mutation.broken(ROOT)))
    assert broken not in (ast.dump(ast.parse(text)), ast.dump(ast.parse("")))
    files = [test for test in mutation.tests if test.endswith(".py")]
    assert files and all((ROOT / "tests" / name).is_file() for name in files)


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A project of two modules; the folder for its copies."""
    monkeypatch.setattr(break_the_physics, "ROOT", tmp_path / "project")
    for name, text in PROJECT.items():
        path = tmp_path / "project" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    copies = tmp_path / "copies"
    copies.mkdir()
    return copies


def fault(new: str, old: str = "FACTOR = 2.0") -> Mutation:
    return Mutation(name=new, file="contact/law.py", old=old, new=new, tests=("test_law.py",))


@pytest.mark.slow
def test_no_fault_is_judged_by_what_was_computed_before_it(project):
    faults = [fault("FACTOR = 3.0"), fault("FACTOR = 1.0"), fault("FACTOR = 2.00")]
    assert soundness(project, faults) == ""
    assert [judge(one, project).verdict for one in faults] == ["noticed", "noticed", "SURVIVES"]
    assert not list(project.iterdir())


def test_a_fault_that_has_no_place_is_not_judged(project):
    assert judge(fault("", old="FACTOR = 7"), project).verdict == "no verdict"
