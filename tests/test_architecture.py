"""The house stays as it was drawn: imports go one way, and each third-party package has its doors."""

import ast
import tomllib
from collections import Counter
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("mesh", "contact", "fem")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))

#: from the foundation up: a package imports its own modules and those of lower layers, none beside or above it
LAYERS = (
    ("mesh", "contact.arrays", "contact.folders", "contact.pieces"),
    ("contact.compiler",),
    ("contact.structs", "contact.local_arrays"),
    ("contact.jit", "contact.reference"),
    ("contact.layout",),
    ("contact.motion",),
    ("contact.interface",),
    ("contact.stepping",),
    ("fem.runtime",),
    ("fem.records",),
    ("fem.seismic",),
    ("fem.case.tables",),
    ("fem.case",),
    ("fem.results",),
    ("fem.solid",),
    ("fem.model",),
    ("fem.html",),
    ("fem.figures",),
    ("fem.render", "fem.run"),
    ("fem.study",),
    ("fem.response",),
    ("fem.report",),
    ("fem.site",),
    ("fem.cli",),
)
NESTED = {
    package for layer in LAYERS for package in layer if package.count(".") == 2
}  #: a package in a package
KERNELS = {"contact.arrays", "contact.jit", "contact.structs"}  #: what any kernel needs
#: package -> the only packages of a lower layer that it may import, where these are not all
NARROW = {
    "contact.reference": {"contact.arrays"},
    "contact.motion": KERNELS,
    "contact.interface": KERNELS | {"contact.layout", "contact.motion"},
    "contact.stepping": KERNELS
    | {"contact.layout", "contact.local_arrays", "contact.motion", "contact.interface"},
    "fem.records": {"contact.arrays", "contact.jit", "contact.motion", "fem.runtime"},
    # what the package offers by name
    "fem": {"fem.runtime", "fem.seismic", "fem.case", "fem.results", "fem.run", "fem.study", "fem.cli"},
    "fem.__main__": {"fem.runtime", "fem.cli"},
}
MOST_FILES = 25  #: in one folder

#: third-party package -> where it may be imported
DOORS = {
    "skfem": {"fem/solid/assembly.py"},
    "pyvista": {"fem/render", "fem/results/fields.py", "fem/results/reader.py"},
    "numba": {
        "contact",
        "fem/solid/elasticity.py",
        "fem/solid/nodal_kernels.py",
        "fem/runtime/compilation.py",
    },
    "pydantic": {"fem"},
    # optional, and slow to import: loaded where a cluster is asked for
    "dask": {"fem/study/cluster.py"},
    "distributed": {"fem/study/cluster.py"},
    "jinja2": {"fem/html/page.py"},
}

#: modules that load others by name, when they are needed: commands, the package's own names, pyvista, meshio,
#: matplotlib, with the rigid check scipy.integrate, and with draws scipy.stats
LOADING_LATE = {
    "fem/__main__.py",
    "fem/__init__.py",
    "fem/case/uncertainty.py",
    "fem/figures/cache.py",
    "fem/run/opened.py",
    "fem/run/run.py",
    "fem/results/fields.py",
    "fem/results/history.py",
    "fem/run/compute.py",
    "fem/site/motions.py",
    "fem/site/run.py",
    "fem/site/size.py",
    "mesh/files.py",
}

#: the modules that may open files for writing, replace and remove them, and the calls that do
WRITERS = {"fem/runtime/own_files.py", "fem/runtime/user_files.py", "contact/jit.py"}
WRITING = {
    "write_text",
    "write_bytes",
    "unlink",
    "rmtree",
    "touch",
    "mkdir",
    "rename",
    "symlink_to",
    "hardlink_to",
}
WRITING |= {"copyfile", "copytree", "copy2", "mkdtemp", "makedirs", "savetxt", "FileIO"}
WRITING_OF_OS = {"replace", "remove", "rename", "truncate", "copy", "move", "link", "symlink", "rmdir"}

#: what `verify`, `validate` and `study` compute, from the ground up: a folder of the tests imports those above it here
EVIDENCE = (("rigs",), ("evidence",), ("verification",), ("validation", "paper"))

#: folders of the tests that pin the physics, and their files of which no fault of `faults.toml` is asked
OF_PHYSICS = ("paper", "validation", "verification", "unit/contact", "unit/mesh", "unit/model")
OF_PHYSICS += ("unit/solid", "unit/seismic", "unit/response")
NO_FAULT = {
    "unit/contact/test_compilation.py",  # the contract of the compiler
    "verification/invariance/test_run_determinism.py",  # the same bits again, of whatever physics
}

#: room -> its folders, most lines of Python, most public names; what needs more in a room takes as much out of it
BUDGET = {
    "mesh": ("mesh", 1_572, 42),
    "contact": ("contact", 8_736, 300),
    "runtime": ("fem/runtime", 1_066, 62),
    "records": ("fem/records", 2_397, 46),
    "case": ("fem/case", 5_175, 124),
    "results": ("fem/results", 3_072, 109),
    "seismic": ("fem/seismic", 2_140, 60),
    "solid": ("fem/solid", 1_669, 60),
    "model": ("fem/model", 3_819, 116),
    "run": ("fem/run", 4_510, 140),
    "pages": ("fem/html fem/figures fem/render fem/report", 4_870, 127),
    "study": ("fem/study fem/response", 7_130, 197),
    "site": ("fem/site", 4_305, 109),
    "cli": ("fem/cli fem/__init__.py fem/__main__.py", 1_803, 42),
    "product": ("mesh contact fem", 52_264, 1_534),
    "tests": ("tests", 36_425, 2_144),
}


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def module_of(path: Path) -> str:
    return name_of(path).removesuffix(".py").replace("/", ".").removesuffix(".__init__")


MODULES = {module_of(path): path for path in SOURCES}


@cache
def tree_of(path: Path) -> ast.Module:
    """A file as it parses: two seconds for all sources, for the worker that asks."""
    return ast.parse(path.read_text(encoding="utf-8"))


def nodes(*kinds: type[ast.AST]) -> Iterator[tuple[str, ast.AST]]:
    """What of these kinds stands in the sources, with the name of its file."""
    return (
        (name_of(path), node)
        for path in SOURCES
        for node in ast.walk(tree_of(path))
        if isinstance(node, kinds)
    )


def package_of(module: str) -> str:
    """The part of the house that a module belongs to, as `LAYERS` names it."""
    words = module.split(".")
    longest = 1 if words[0] == "mesh" else 3 if ".".join(words[:3]) in NESTED else 2
    return ".".join(words[:longest])


@cache
def imported(path: Path) -> frozenset[str]:
    """Full names of what a file imports, at any depth of it, by statement or by string."""
    found = set()
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name_of(path)}:{node.lineno}: relative import"
            assert node.module is not None
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            name = node.value.partition(":")[0]
            if "." in name and name in MODULES:
                found.add(name)
    return frozenset(found)


@cache
def of_this_project(path: Path) -> frozenset[str]:
    """Modules of this project that a file imports, apart from the packages that hold the module named."""
    names = {name for name in imported(path) if name in MODULES} - {module_of(path)}
    return frozenset(name for name in names if not any(other.startswith(f"{name}.") for other in names))


def lower(package: str) -> set[str]:
    """Packages that a package may import."""
    if package in NARROW:
        return NARROW[package]
    floor = next(k for k, layer in enumerate(LAYERS) if package in layer)
    return {below for layer in LAYERS[:floor] for below in layer}


def test_there_is_something_to_look_at():
    assert {name_of(path).split("/")[0] for path in SOURCES} == set(PACKAGES)
    assert "skfem" in imported(ROOT / "fem/solid/assembly.py")


def test_imports_go_down_the_layers():
    wrong = [
        f"{name_of(path)} imports {name}"
        for path in SOURCES
        for package in [package_of(module_of(path))]
        for name in of_this_project(path)
        if package_of(name) not in {package} | lower(package)
    ]
    assert not wrong


def test_no_module_imports_itself_by_way_of_others():
    graph = {module_of(path): of_this_project(path) for path in SOURCES}
    TopologicalSorter(graph).prepare()  # raises CycleError with the circle


def test_no_folder_imports_itself_by_way_of_others():
    """Folders inside a package, too: what one imports of its package does not import it."""
    for folder in {path.parent for path in SOURCES} - {ROOT / package for package in PACKAGES}:
        inside = {module for module, path in MODULES.items() if path.is_relative_to(folder)}
        graph = {name_of(folder): set().union(*(of_this_project(MODULES[name]) for name in inside)) - inside}
        for module in MODULES.keys() - inside:
            names = of_this_project(MODULES[module])
            graph[module] = {name_of(folder) if name in inside else name for name in names}
        TopologicalSorter(graph).prepare()  # raises CycleError with the circle


def folders_of_tests(path: Path) -> set[str]:
    """Folders of the tests that a file imports; modules of the rigs go by their bare names."""
    rooms = {rig.stem: "rigs" for rig in (ROOT / "tests/rigs").glob("*.py")}
    rooms |= {folder: folder for floor in EVIDENCE for folder in floor}
    names = {
        (node.module or "") if isinstance(node, ast.ImportFrom) else alias.name
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in node.names
    }
    return {rooms[name.partition(".")[0]] for name in names if name.partition(".")[0] in rooms}


def test_evidence_goes_one_way_and_the_program_imports_nothing_of_it():
    wrong = [(name_of(path), above) for path in SOURCES if (above := folders_of_tests(path))]
    below: set[str] = set()
    for floor in EVIDENCE:
        for folder in floor:
            files = [f for f in in_folder(f"tests/{folder}") if not f.name.startswith("test_")]
            assert files
            wrong += [(name_of(f), above) for f in files if (above := folders_of_tests(f) - below - {folder})]
        below |= set(floor)
    assert not wrong


def test_every_test_file_of_the_physics_notices_a_fault():
    faults = tomllib.loads((ROOT / "tests/mutations/faults.toml").read_text(encoding="utf-8"))["fault"]
    noticing = {name for fault in faults for name in fault["tests"]}
    files = [name_of(file) for folder in OF_PHYSICS for file in in_folder(f"tests/{folder}")]
    tests = {file.removeprefix("tests/") for file in files if "/test_" in file}
    assert tests - noticing == NO_FAULT


@pytest.mark.parametrize("room", BUDGET)
def test_a_room_keeps_to_its_budget(room):
    """A public name is a function or class at the top of a module that has no leading underscore."""
    folders, most_lines, most_names = BUDGET[room]
    files = [path for folder in folders.split() for path in in_folder(folder)]
    assert files
    lines = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in files)
    names = sum(
        isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)
        and not node.name.startswith("_")
        for path in files
        for node in tree_of(path).body
    )
    assert lines <= most_lines, f"{lines} lines"
    assert names <= most_names, f"{names} names"


def in_folder(name: str) -> list[Path]:
    """The Python files of a folder, or one file."""
    return [ROOT / name] if name.endswith(".py") else sorted((ROOT / name).rglob("*.py"))


def test_every_file_has_one_room():
    rooms = [folders for room, (folders, *_) in BUDGET.items() if room not in ("product", "tests")]
    found = Counter(path for folders in rooms for folder in folders.split() for path in in_folder(folder))
    assert found == Counter(SOURCES)


def test_no_folder_is_crowded():
    folders = Counter(path.parent for path in SOURCES)
    assert not {name_of(folder): count for folder, count in folders.items() if count > MOST_FILES}


def test_fem_holds_packages_only():
    assert {path.name for path in (ROOT / "fem").glob("*.py")} == {"__init__.py", "__main__.py"}


def test_a_public_class_has_a_name_of_its_own():
    classes = [
        (node.name, name_of(path))
        for path in SOURCES
        for node in tree_of(path).body
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    ]
    counts = Counter(name for name, _ in classes)
    assert not [(name, path) for name, path in classes if counts[name] > 1]


def test_third_party_packages_come_in_by_their_doors():
    wrong = [
        f"{name_of(path)} imports {package}"
        for path in SOURCES
        for package in {full.split(".")[0] for full in imported(path)} & set(DOORS)
        if not {name_of(path), *(parent.as_posix() for parent in Path(name_of(path)).parents)}
        & DOORS[package]
    ]
    assert not wrong


def test_imports_stand_at_the_top_of_the_module():
    """The command line loads its commands by import string; nobody imports inside a function."""
    wrong = [
        f"{name}:{inside.lineno}: import inside {type(node).__name__}"
        for name, node in nodes(ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)
        for inside in ast.walk(node)
        if isinstance(inside, ast.Import | ast.ImportFrom)
    ]
    assert not wrong


def test_only_the_command_line_and_the_opening_import_by_string():
    calls = {
        name
        for name, call in nodes(ast.Call)
        if ast.unparse(call.func).split(".")[-1] in ("import_module", "__import__")
    }
    assert not {name for name in calls - LOADING_LATE if not name.startswith("fem/cli/")}


def opens_for_writing(call: ast.Call, name: str) -> bool:
    """Whether a call opens, changes or removes a file, as far as its name and mode tell."""
    owner = ast.unparse(call.func.value) if isinstance(call.func, ast.Attribute) else ""
    if name in WRITING or (owner in ("os", "shutil") and name in WRITING_OF_OS):
        return True
    if name == "savefig":  # into memory
        return "stream" not in ast.unparse(call.args[0]) and "drawn" not in ast.unparse(call.args[0])
    if name != "open" or owner == "os":
        return name == "open" and "O_RDONLY" not in ast.unparse(call) and "devnull" not in ast.unparse(call)
    given = [keyword.value for keyword in call.keywords if keyword.arg == "mode"]
    modes = given or call.args[0 if owner else 1 :][:1]
    return any(not isinstance(mode, ast.Constant) or set(str(mode.value)) & set("wax+") for mode in modes)


def test_one_module_writes_and_removes_files():
    """`fem.runtime.own_files` follows no link in a folder; kernels lie in a folder of their own, see `contact.jit`."""
    wrong = [
        f"{name}:{call.lineno}: {ast.unparse(call)[:60]}"
        for name, call in nodes(ast.Call)
        if name not in WRITERS
        and opens_for_writing(call, ast.unparse(call.func).split(".")[-1].split("(")[0])
    ]
    assert not wrong


def test_only_what_nothing_acts_in_reaches_the_terminal():
    """Everything is printed by `fem.runtime.terminal.say`."""
    wrong = [
        f"{name}:{call.lineno}"
        for name, call in nodes(ast.Call)
        if name != "fem/runtime/terminal.py"
        and ast.unparse(call.func) in ("print", "sys.stdout.write", "sys.stderr.write")
    ]
    assert not wrong


def test_every_module_says_what_it_is():
    assert not [name_of(path) for path in SOURCES if not ast.get_docstring(tree_of(path))]


def test_no_room_is_a_lumber_room():
    assert not [name_of(path) for path in SOURCES if path.stem in ("utils", "helpers", "common", "misc")]
