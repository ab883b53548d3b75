"""A fault to put into the physics."""

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
    for package in ("fem", "mesh", "contact", "tests/rigs")
    for path in sorted((ROOT / package).rglob("*.py"))
}


@dataclass(frozen=True, kw_only=True)
class Mutation:
    """One fault: a piece of text that stands once in the sources, and what it becomes."""

    name: str  #: what is wrong then
    old: str
    new: str
    tests: tuple[str, ...]  #: files from the folder of the tests, and options of pytest

    @property
    def file(self) -> str:
        """The file with its text, from the root of the project; empty where the text does not stand just once."""
        found = {file: text.count(self.old) for file, text in SOURCES.items() if self.old in text}
        return next(iter(found)) if list(found.values()) == [1] else ""
