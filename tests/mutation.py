"""A fault to put into the physics."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Mutation:
    """One fault: a piece of text that stands once in a file, and what it becomes."""

    name: str  #: what is wrong then
    file: str  #: from the root of the project
    old: str
    new: str
    tests: tuple[str, ...]  #: files from the folder of the tests, and options of pytest
