"""The house stays as it was drawn: imports go one way, and each third-party package has its doors."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("mesh", "contact", "fem")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))

#: package -> the packages of this project it may import
ALLOWED = {"mesh": {"mesh"}, "contact": {"contact"}, "fem": {"mesh", "contact", "fem"}}

#: third-party package -> where it may be imported
DOORS = {
    "skfem": {"fem/assembly.py"},
    "pyvista": {"fem/scenery.py", "fem/pictures.py", "fem/movie.py", "fem/opening.py", "fem/figures_kept.py"},
    "numba": {"contact", "fem/elasticity.py", "fem/nodal_body.py", "fem/compilation.py"},
    "pydantic": {"fem"},
    # optional, and slow to import: loaded where a cluster is asked for
    "dask": {"fem/sweep/cluster.py"},
    "distributed": {"fem/sweep/cluster.py"},
    "jinja2": {"fem/pages.py"},
}

#: modules that load others by name, when they are needed: commands, the package's own names, pyvista, matplotlib
LOADING_LATE = {"fem/__main__.py", "fem/__init__.py", "fem/opening.py", "fem/figures_kept.py"}


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def imported(path: Path) -> Iterator[str]:
    """Full names of the modules that a file imports, at any depth of it."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name_of(path)}:{node.lineno}: relative import"
            assert node.module is not None
            yield node.module


def test_there_is_something_to_look_at():
    assert {name_of(path).split("/")[0] for path in SOURCES} == set(PACKAGES)
    assert "skfem" in set(imported(ROOT / "fem/assembly.py"))


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_imports_go_one_way(path):
    package = name_of(path).split("/")[0]
    ours = {name.split(".")[0] for name in imported(path)} & {*PACKAGES, "tests"}
    assert ours <= ALLOWED[package]


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_third_party_packages_come_in_by_their_doors(path):
    name = name_of(path)
    for package in {full.split(".")[0] for full in imported(path)} & set(DOORS):
        assert {name, name.split("/")[0]} & DOORS[package], f"{name} imports {package}"


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_imports_stand_at_the_top_of_the_module(path):
    """The command line loads its commands by import string; nobody imports inside a function."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda | ast.ClassDef):
            inside = [n for n in ast.walk(node) if isinstance(n, ast.Import | ast.ImportFrom)]
            assert not inside, f"{name_of(path)}:{inside[0].lineno}: import inside {type(node).__name__}"


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_only_the_command_line_and_the_opening_import_by_string(path):
    calls = [
        node
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call)
        and ast.unparse(node.func).split(".")[-1] in ("import_module", "__import__")
    ]
    name = name_of(path)
    assert not calls or name.startswith("fem/commands/") or name in LOADING_LATE


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_every_module_says_what_it_is(path):
    assert ast.get_docstring(ast.parse(path.read_text())), f"{name_of(path)} has no docstring"


def test_no_room_is_a_lumber_room():
    assert not [name_of(path) for path in SOURCES if path.stem in ("utils", "helpers", "common", "misc")]
