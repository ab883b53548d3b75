"""Which phrases of tests stand in a stored text: those need no test that looks for them.

python tests/said/phrases.py FILE.py ...       phrases of the files that no text holds
git diff | python tests/said/phrases.py        phrases on deleted lines that no text holds
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).parent
LEAST = 3  #: words of a phrase


def plain(text: str) -> str:
    """Words alone, whatever the lines, signs of a difference and escapes between them."""
    return " ".join(re.sub(r"(?m)^ *[-+$#] ?|[│|]", " ", text.replace("\\", "")).split())


def phrases(source: str) -> Iterator[str]:
    """Strings of so many words in the functions of a module, but for docstrings."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            node.value.value = None
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def deleted(difference: str) -> Iterator[str]:
    """Strings on deleted lines of a difference, and what stands between the bars of a table there."""
    lines = "\n".join(line[1:] for line in difference.splitlines() if re.match(r"-(?!--)", line))
    for text in re.findall(r'r?f?"((?:[^"\\\n]|\\.)*)"|^ *(?:\w+ +)?\|([^"\n]*)$', lines, re.MULTILINE):
        yield from re.split(r"\\n| \| ", "".join(text))


def main() -> int:
    """Print what no text holds; 1 if there is any."""
    held = plain("\n".join(file.read_text(encoding="utf-8") for file in HERE.glob("*.txt")))
    if len(sys.argv) > 1:
        found = {
            (name, one) for name in sys.argv[1:] for one in phrases(Path(name).read_text(encoding="utf-8"))
        }
    else:
        found = {("", one) for one in deleted(sys.stdin.read())}
    wanted = [(name, one) for name, one in sorted(found) if len(one.split()) >= LEAST]
    missing = [
        (name, one)
        for name, one in wanted
        if any(part not in held for part in re.split(r"\.\*|\{[^}]*\}", plain(one)))
    ]
    for name, one in missing:
        print(f"{name}: {one!r}")
    print(f"{len(wanted)} phrases, {len(missing)} of them in no text")
    return int(bool(missing))


if __name__ == "__main__":
    sys.exit(main())
