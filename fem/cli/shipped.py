"""`list`, `init`, `schema`, `docs`, `doctor`: what is installed, files to start from, documents, what is missing."""

import importlib
import json
import platform
import shutil
import tomllib
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from textwrap import fill
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from fem.case.files import CASES, COLLECTIONS, COMMANDS, DEFAULT_CASE
from fem.case.validation import CaseError
from fem.cli.console import WIDTH, AsJson
from fem.results.errors import FolderError
from fem.runtime.own_files import created
from fem.runtime.terminal import say
from fem.runtime.threads import cores
from fem.runtime.user_files import read_text

START = "start"  #: the README of the project, which is part of its metadata wherever it is installed
#: the packages whose folders hold a README for each room, and further pages
PACKAGES = ("fem", "mesh", "contact")
DISTRIBUTIONS = (
    *("unanchored", "numpy", "scipy", "numba", "scikit-fem", "meshio", "pyvista", "matplotlib"),
    *("pydantic", "cyclopts", "rich", "jinja2", "imageio", "filelock"),
)
INSTALL_PACKAGES = "python -m pip install --upgrade unanchored"
LEAST_FREE_GB = 1.0


def list_cases(*, as_json: AsJson = False) -> None:
    """List the shipped cases, sweeps, ensembles and sites, each with its description."""
    if as_json:
        document = {
            f"{collection.kind}s": [
                {"name": name, "description": collection.description(name)} for name in collection.names
            ]
            for collection in COLLECTIONS
        }
        say(json.dumps({"default": DEFAULT_CASE} | document, indent=2))
        return
    width = max(len(name) for collection in COLLECTIONS for name in collection.names)
    for collection in COLLECTIONS:
        say(f"{collection.kind.capitalize()}s: python -m fem {COMMANDS[collection.kind]} NAME")
        for name in collection.names:
            mark = " (default)" if name == DEFAULT_CASE else ""
            text = f"{name:{width}}  {collection.description(name)}{mark}"
            say(fill(text, WIDTH, subsequent_indent=" " * (width + 2)))
        say()
    say("python -m fem init NAME writes any of them to a file.")


def init(name: str | None = None, /, *, to: Path | None = None) -> None:
    """Write a commented case, sweep, ensemble or site file to start from; an existing file is never overwritten.

    Args:
        name: A shipped case, sweep, ensemble or site (see `python -m fem list`); default: a case file with every key.
        to: The file; default: NAME.toml, or case.toml.
    """
    of = next((each for each in COLLECTIONS if name in each.names), CASES)
    if name is None:  # a case loads numpy
        cases, template = (importlib.import_module(f"fem.case.{module}") for module in ("case", "template"))
        text = template.case_template(cases.load_case())
    else:
        text = _for_another_box(of.text(name)) if of is CASES else of.text(name)
    path = to if to is not None else Path(f"{name or 'case'}.toml")
    try:
        with created(path) as stream:
            stream.write(text.encode())
    except FileExistsError:
        raise CaseError(f"{path} exists and is not overwritten; give another name with --to") from None
    except OSError as error:
        raise CaseError(
            f"{path}: cannot be written ({error.strerror or error}); choose another place with --to"
        ) from None
    say(f"{path} written; next:")
    if of is CASES:
        say(f"  python -m fem check {path}    static checks and settings, nothing is computed")
    say(f"  python -m fem {COMMANDS[of.kind]} {path}")


def _for_another_box(text: str) -> str:
    """Without [static] and what the box of the file alone has below it: a freight container keeps its corners."""
    left = {"static", "floor.corner_patch_m"}
    if "corner_post_N" not in tomllib.loads(text)["container"]:  # posts and castings by ISO 1496-1
        left |= {"support", "container.post_m"}
    table, kept = "", []
    for line in text.splitlines(keepends=True):
        if line.startswith("["):
            table = line[1:].partition("]")[0]
        if left.isdisjoint((table, f"{table}.{line.partition('=')[0].strip()}")):
            kept.append(line)
    return "".join(kept)


def schema(kind: Literal["case", "sweep", "ensemble", "site"] = "case", /) -> None:
    """Print the JSON schema of a kind of file: keys, types, units, ranges, defaults.

    Args:
        kind: Kind of file.
    """
    # The models take long to load, those of the other kinds longest.
    if kind == "case":
        model = importlib.import_module("fem.case.case").Case
    else:
        model = importlib.import_module("fem.cli.file_models").FILE_MODELS[kind]
    say(json.dumps(model.model_json_schema(by_alias=True), indent=2))


def docs(room: Annotated[str, Parameter(show_default=True)] = "", /) -> None:
    """Print where the documents are, for each room of the program, or the text of one.

    Args:
        room: Of which to print the text, such as start, case, keys or contact.
    """
    places = {}  #: of documents, by the names of their rooms; of further pages by their own
    for package in PACKAGES:
        spec = find_spec(package)
        for folder in (spec and spec.submodule_search_locations) or ():
            for path in sorted(Path(folder).rglob("*.md")):
                places[path.parent.name if path.stem == "README" else path.stem] = path
    if room == START:
        say(str(metadata.metadata("unanchored").json["description"]))
    elif not room:
        say(f"{START:<12}what the program answers, and the first five minutes")
        for name, path in places.items():
            title = read_text(path).partition("\n")[0].lstrip("# ")
            say(f"{name:<12}{title}\n{'':12}{path}")
        say("\npython -m fem docs NAME prints one of them.")
    elif room not in places:
        raise FolderError(f"docs {room}: no such document; there are {', '.join([START, *places])}")
    else:
        say(read_text(places[room]))


def doctor(*, as_json: AsJson = False) -> None:
    """Report versions, rendering, cores and free disk, and how to install what is missing."""
    versions = {name: _version(name) for name in DISTRIBUTIONS}
    opengl = importlib.import_module("fem.render.opengl")
    rendering = opengl.probe_rendering()
    free = shutil.disk_usage(Path.cwd()).free / 1e9
    remedies = []
    if missing := [name for name, version in versions.items() if version is None]:
        remedies.append(f"missing: {', '.join(missing)}; {INSTALL_PACKAGES}")
    if rendering is not None:
        remedies.append(f"pictures and movies do not work (runs do): {rendering}; {opengl.MEND}")
    if free < LEAST_FREE_GB:
        remedies.append(f"only {free:.2f} GB free in {Path.cwd()}: write elsewhere with --out")
    report: dict[str, Any] = {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "versions": versions,
        "rendering": rendering is None,
        "threads": cores(),
        "disk_free_GB": round(free, 2),
        "remedies": remedies,
    }
    if as_json:
        say(json.dumps(report, indent=2))
        return
    rows = {name: version or "missing" for name, version in versions.items()}
    rows["rendering"] = "works" if rendering is None else "does not work"
    rows |= {"threads": report["threads"], "disk": f"{report['disk_free_GB']:g} GB free here"}
    say(f"python {report['python']} on {report['platform']}")
    say("\n".join(f"  {name:<12} {value}" for name, value in rows.items()))
    say("\n" + "\n".join(remedies or ["nothing is missing"]))


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None
