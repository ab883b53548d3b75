"""What is printed for people and may hold texts of others: titles, names of files, lines of a file that is refused."""

import re
import sys
from typing import TextIO

#: control characters but for the ends of lines and tabs, and what turns the direction of text or hides in it
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]")


def shown(text: object) -> str:
    """A text with its control characters as escapes, which are those of JSON as well."""
    return CONTROL.sub(lambda match: f"\\u{ord(match[0]):04x}", str(text))


def one_line(text: str) -> str:
    """A text of others in one line: a further one would speak for the program."""
    return " ".join(text.splitlines())


def say(text: object = "", *, end: str = "\n", file: TextIO | None = None, flush: bool = False) -> None:
    """Print a text of which nothing acts on the terminal."""
    print(shown(text), end=end, file=file or sys.stdout, flush=flush)
