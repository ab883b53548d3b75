"""Pages of the keys of every file that a user writes, one a table, and of what every file of results holds.

All of it stands in one place, at the key: its description, unit, range and default, or the comment beside it.
"""

import re
import shutil
from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

from myst_parser.mdit_to_docutils.base import default_slugify
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined
from sphinx.pycode import ModuleAnalyzer

from fem.case import columns
from fem.case.case import Case
from fem.case.toml import toml_value
from fem.case.validation import choices_of, known_keys, quantity_of
from fem.cli.file_models import FILE_MODELS
from fem.response.lasting import ResponseResult
from fem.results.figures import FIGURES, RunFigures
from fem.results.run_result import ActionResult, RunResult, Verdict
from fem.site.result import SiteResult
from fem.study.fragility import EnsembleResult
from fem.study.hall_file import OWN
from fem.study.hall_result import RESULT_COLUMNS, HallResult
from fem.study.sweep_table import BAND, FOUND, SweepResult

EXPLAINED = Path(__file__).parents[1] / "fem/case/keys.md"
#: a file that is written by the user -> its tables
FILES: dict[str, type[BaseModel]] = {"case": Case, **FILE_MODELS}
#: a file of results -> what it is, the page that tells of it, and the columns of its table
RESULTS: dict[str, tuple[type, str, Iterable[str]]] = {
    "run.json": (RunResult, "results", ()),
    "sweep.json": (SweepResult, "study", [*FOUND, *BAND]),
    "ensemble.json": (EnsembleResult, "study", ()),
    "hall.json": (HallResult, "study", [*OWN, *RESULT_COLUMNS]),
    "response.json": (ResponseResult, "response", ()),
    "assess.json": (SiteResult, "site", ()),
}
BOUNDS = {"ge": "at least", "gt": "more than", "le": "at most", "lt": "less than"}
SHARED = 3  #: rows that a table has from another, from which on they are not told twice
INDEX = """A page for each table of the files that you write, then one for each file of results.
`python -m fem init` writes such a file with every key.
"""
HEAD = "key, unit, range, default, meaning"
WHERE = "In `run.json` (`verdict`), and as columns in the tables of sweeps, lists and sites. SI units."
FIGURES_TOO = "Beside them the keys that were varied, and the [figures of a run](figures.md)."


def parts(hint: Any) -> Iterator[Any]:
    """A type and all that it is made of."""
    yield hint
    for part in get_args(hint):
        yield from parts(part)


def tables_in(hint: Any) -> list[type[BaseModel]]:
    """The tables that a key holds."""
    return [part for part in parts(hint) if isinstance(part, type) and issubclass(part, BaseModel)]


def first_of(text: str | None) -> str:
    """The first paragraph of a docstring."""
    return " ".join((text or "").strip().partition("\n\n")[0].split())


@cache
def comments_of(kind: type) -> dict[str, str]:
    """What stands beside the attributes of a class, those of its bases too."""
    found: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        if base.__module__.startswith("fem."):
            docs = ModuleAnalyzer.for_module(base.__module__).find_attr_docs()
            found |= {
                name: " ".join(text).strip() for (of, name), text in docs.items() if of == base.__name__
            }
    return found


def rows(head: str, cells: Iterable[Iterable[str]]) -> str:
    """A table in Markdown, without a row where there is none."""
    names = head.split(", ")
    lines = [
        " | ".join(cell.replace("|", r"\|") for cell in row) for row in (names, ["---"] * len(names), *cells)
    ]
    return "\n".join(f"| {line} |" for line in lines)


def range_of(field: FieldInfo) -> tuple[str, str]:
    """The unit of a key, and the values that it may have where its description does not name them."""
    quantity = quantity_of(field.annotation, field.metadata)
    if quantity:
        return quantity.unit, quantity.range_in_words
    choices = [choice for choice in choices_of(field.annotation) if choice not in (field.description or "")]
    bounds = [
        f"{word} {getattr(one, name)}"
        for one in field.metadata
        for name, word in BOUNDS.items()
        if hasattr(one, name)
    ]
    return "", ", ".join([*choices, *bounds])


def key_row(table: type[BaseModel], key: str, field: FieldInfo) -> tuple[str, ...]:
    """A key: its name, unit, range, default, meaning."""
    default = "must be given" if field.is_required() else ""
    if field.default not in (None, PydanticUndefined, {}):
        default = f"`{toml_value(field.default)}`"
    name = next(name for name, one in table.model_fields.items() if one is field)
    meaning = field.description or comments_of(table).get(name, "").rstrip(".")
    for other, options in ((field.json_schema_extra or {}).get("x-only-for") or {}).items():
        meaning += f"; with {other} = {', '.join(map(toml_value, options))}"
    return (f"`{key}`", *range_of(field), default, meaning)


def explained(name: str, keys: Iterable[str]) -> str:
    """Links to what a comment of a key has no room for."""
    links = []
    for heading in re.findall(r"^## (.*)$", EXPLAINED.read_text(encoding="utf-8"), re.MULTILINE):
        told = {word.split(" ")[0].removeprefix(f"{name}.") for word in re.findall(r"`(.*?)`", heading)}
        if told & {*keys, f"[{name}]", f"[[{name}]]"}:
            links.append(f"- [{heading}](../../../fem/case/keys.md#{default_slugify(heading)})")
    return "\n".join(["", "What these keys do to a result:", "", *links]) if links else ""


class KeyPages:
    """The pages of the keys, by name; a table, and a row that several tables share, stands on one."""

    def __init__(self) -> None:
        self.pages: dict[str, str] = {}
        self.place: dict[type, str] = {}  #: of a table, its page
        self.told: dict[tuple[str, ...], str] = {}  #: of a row, its page

    def add_file(self, kind: str, model: type[BaseModel]) -> None:
        """The keys before the first table, and a page for each table."""
        tables = {key: of for key, of in known_keys(model).items() if tables_in(of.annotation)}
        before, listed = set(self.pages), []
        for key, field in tables.items():
            for table in tables_in(field.annotation):
                title = f"[[{key}]]" if "tuple" in str(field.annotation) else f"[{key}]"
                self.add_table(f"{kind}/{key}", title, table)
                about = field.description or first_of(table.__doc__)
                listed += [f"- [`{title}`](../{self.place[table]}.md): {about}"]
        inside = [name.removeprefix(f"{kind}/") for name in self.pages if name not in before]
        self.add_table(f"{kind}/file", f"{kind.capitalize()} file", model)
        self.pages[f"{kind}/file"] += "\n".join(
            ["\nIts tables:\n", *listed, "", *toctree(inside, ":hidden:")]
        )

    def add_table(self, name: str, title: str, table: type[BaseModel]) -> None:
        """The page of a table, and those of the tables in it."""
        if table in self.place:
            return
        self.place[table] = name
        keys = {key: of for key, of in known_keys(table).items() if not tables_in(of.annotation)}
        own = {key: key_row(table, key, of) for key, of in keys.items()}
        shared: dict[str, list[str]] = {}
        for key, row in own.items():
            shared.setdefault(self.told.get(row, name), []).append(key)
        extra: Any = table.model_config.get("json_schema_extra") or {}
        lines = [f"# {title if name.endswith('/file') else f'`{title}`'}\n"]
        lines += [f"{extra.get('description') or first_of(table.__doc__)}\n"]
        for page, same in shared.items():
            if page != name and len(same) >= SHARED:
                lines += [f"As in [{page}](../{page}.md): {', '.join(f'`{key}`' for key in same)}.\n"]
                own = {key: row for key, row in own.items() if key not in same}
        self.told = dict.fromkeys(own.values(), name) | self.told
        lines += [rows(HEAD, own.values()), explained(name.partition("/")[2], keys)]
        self.pages[name] = "\n".join([*lines, ""])
        for key, field in known_keys(table).items() if not name.endswith("/file") else ():
            for inner in tables_in(field.annotation):
                self.add_table(f"{name}.{key}", f"[[{name.partition('/')[2]}.{key}]]", inner)


def toctree(names: Iterable[str], *options: str) -> list[str]:
    """The names of pages as a tree of contents."""
    return ["```{toctree}", *options, "", *names, "```"]


def blocks_of(kind: type, seen: set[type]) -> Iterator[type]:
    """A class of results and those of the blocks in it, each once."""
    if kind not in seen:
        seen.add(kind)
        yield kind
        for hint in get_type_hints(kind, include_extras=True).values():
            for block in blocks_in(hint):
                yield from blocks_of(block, seen)


def blocks_in(hint: Any) -> list[type]:
    """The blocks of a result that a type holds."""
    kinds = [get_origin(part) or part for part in parts(hint)]
    return [kind for kind in kinds if isinstance(kind, type) and is_dataclass(kind)]


def pages_of_results() -> Iterator[tuple[str, str]]:
    """What files of results hold: a page a file, a section a block; the figures of a run and its history apart."""
    seen: set[type] = set()
    blocks = {file: list(blocks_of(kind, seen)) for file, (kind, *_) in RESULTS.items()}
    place = {block: f"{file.partition('.')[0]}.md" for file, inside in blocks.items() for block in inside}
    known = comments_of(RunResult) | comments_of(ActionResult) | comments_of(Verdict)
    for file, (kind, room, of_rows) in RESULTS.items():
        lines = [f"# `{file}`\n", f"[What it tells](../../../fem/{room}/README.md), and its keys.\n"]
        for block in blocks[file]:
            hints, beside, said = get_type_hints(block, include_extras=True), comments_of(block), {}
            for name in (field.name for field in fields(block) if field.name not in FIGURES):
                inside = [
                    f"[{one.__name__}]({place[one]}#{one.__name__.lower()})" for one in blocks_in(hints[name])
                ]
                said[name] = "; ".join(filter(None, [beside.get(name, "").rstrip("."), *inside]))
            lines += ["" if block is kind else f"## {block.__name__}\n", f"{first_of(block.__doc__)}\n"]
            lines += [rows("key, meaning", ((f"`{name}`", text) for name, text in said.items())), ""]
        if of_rows:
            own = ((f"`{name}`", known.get(name, "").rstrip(".")) for name in of_rows if name not in FIGURES)
            lines += [f"## Columns of the table\n\n{FIGURES_TOO}\n", rows("column, meaning", own), ""]
        yield f"results/{file.partition('.')[0]}", "\n".join(lines)
    beside = comments_of(RunFigures)
    told = ((f"`{key}`", one.words, beside.get(key, "").rstrip(".")) for key, one in FIGURES.items())
    yield "results/figures", f"# Figures of a run\n\n{WHERE}\n\n{rows('key, in words, meaning', told)}\n"
    cells = [(f"`{one.name}`", one.unit, one.against) for group in columns.GROUPS for one in group.columns]
    about = first_of(columns.__doc__)
    yield "results/history", f"# `history.csv`\n\n{about}\n\n{rows('column, unit, relative to', cells)}\n"


def write_pages(place: Path) -> None:
    """Write all pages into a folder, and leave none of those that were there."""
    shutil.rmtree(place, ignore_errors=True)
    keys = KeyPages()
    for kind, model in FILES.items():
        keys.add_file(kind, model)
    pages = keys.pages | dict(pages_of_results())
    files = toctree((name for name in pages if name.endswith("/file")), ":maxdepth: 2")
    results = toctree((name for name in pages if name.startswith("results/")), ":maxdepth: 1")
    pages["index"] = "\n".join(["# Keys and columns\n", INDEX, *files, "", *results, ""])
    for name, text in pages.items():
        path = place / f"{name}.md"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
