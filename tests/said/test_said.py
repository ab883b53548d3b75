"""What the program says, beside what it said when that was last read.

A file of texts is a transcript: a line that begins with `$` is what is asked, the indented lines under it are what is
said. `python -m pytest --say tests/said` writes what is said now; the difference is read like one of a program. A new
text needs a line with `$` alone.
"""

import difflib
import json
import re
import shlex
import shutil
import tempfile
import tomllib
from html import unescape
from pathlib import Path
from textwrap import fill

import pytest
from case_words import cased
from cases import TEXTS, named_case
from record_words import recorded
from site_answers import answered, brief_page, sited
from site_example import write_example
from study_folders import ensemble_folder, response_folder, sweep_folder
from study_words import worded
from typed_results import told

from fem.__main__ import main
from fem.case.case import CaseError, load_case
from fem.case.overrides import parse_override
from fem.html.page import _environment
from fem.model.container import modes_of_a_body
from fem.report.study_page import ensemble_report, response_report, sweep_report
from fem.run import described
from fem.site.page import site_report

HERE = Path(__file__).parent
BODY = {"modes_of_a_body": modes_of_a_body}  #: for the rows of a case
BAD_INPUT = 2  #: exit code; then nothing is printed but the reason, and nothing is written
WHOLE = ("written", "changed", "boxes", "motion")  #: kinds of texts of which no two are alike
#: what differs between two runs of the same bits: times, dates, versions, hashes, free room
FLEETING = (
    (r"(computing time +|computed \| |computed in \| ).*(\n {20,}.*)?", r"\1TIME"),
    (r"(versions|hash|program) \| .*", r"\1 |"),
    (r"\n?(t = [\d.]+ of [\d.]+ s, .* left, |compiling the stepping).*", ""),
    (r"unanchored \d[\w.+]*( on [\d-]+)?", "unanchored"),
    (r"\b[0-9a-f]{64}\b", "HASH"),
    (r"room for [\d.]+ .B", "room for SOME"),
    (r"roughly\s+[\d.]+\s+(s|min|h)(\s+on\s+\d+\s+cores)?", "roughly SOME"),
    (r"\b[\d.]+ × 10⁻¹\d", "ROUNDING"),
)


def refused(asked):
    """A named case with changes as `--set` takes them, separated by ` & `, or a text: the reasons against it."""
    try:
        if asked.startswith('"'):
            Path("case.toml").write_text(json.loads(asked), encoding="utf-8")
            load_case("case.toml")
        else:
            name, _, changes = asked.partition(" | ")
            named_case(name.strip(), dict(map(parse_override, filter(None, changes.split(" & ")))))
    except CaseError as error:
        return str(error)
    return "nothing is said against it"


def commanded(asked, capsys):
    """A command in the folder of this transcript: what it prints, its exit code, the text of a page it writes."""
    before = sorted(Path().rglob("*"))
    code = main(shlex.split(asked))
    printed = capsys.readouterr()
    if code == BAD_INPUT:
        assert (printed.out, sorted(Path().rglob("*"))) == ("", before)
        if asked.startswith("check ") and not re.search("python -m fem|a site file", printed.err):
            again = main(["run", *shlex.split(asked)[1:]])  # what a run refuses, in the same words
            assert (again, capsys.readouterr().err) == (BAD_INPUT, printed.err)
    said = printed.out + printed.err + (f"[{code}]" if code else "")
    lines = printed.out.splitlines()
    pages = [Path(line) for line in lines if line.endswith(".html") and Path(line).is_file()]
    if asked.startswith("init ") and code == 0:
        made = [path for path in Path().glob("*.toml") if path not in before]
        said += "".join(path.read_text(encoding="utf-8") for path in made)
    return said + "\n".join(text_of_page(page.read_text(encoding="utf-8")) for page in pages)


def paged(asked):
    """The page of a known result of a study, with changes as in TOML; `brief`: two sheets, with arguments; `case`."""
    kind, _, changes = asked.partition(" ")
    if kind == "brief":
        return text_of_page(brief_page(changes))
    if kind == "case":
        name, *overrides = shlex.split(changes)
        module = _environment().get_template("case.html.j2").make_module({"described": described, **BODY})
        return text_of_page(str(module.case_table(named_case(name, dict(map(parse_override, overrides))))))
    folder = Path(tempfile.mkdtemp(dir="."))
    make, report = {
        "sweep": (sweep_folder, sweep_report),
        "ensemble": (ensemble_folder, ensemble_report),
        "response": (response_folder, response_report),
        "site": (write_example, site_report),
    }[kind]
    make(folder, **tomllib.loads(f"x = {{{changes}}}")["x"])
    return text_of_page(report(folder)).replace(str(folder), "FOLDER")


def text_of_page(page):
    """What is read of a page: no style, script, drawing or copy of a file; a line for each block."""
    for hidden in ("style", "script", "svg", "head", 'pre class="case"'):
        page = re.sub(rf"<{hidden}\b.*?</{hidden.split()[0]}>", "", page, flags=re.DOTALL)
    parts = re.split(r"(<pre\b.*?</pre>)", page, flags=re.DOTALL)  # elsewhere a line of a template is no line
    page = "".join(part if part.startswith("<pre") else " ".join(part.split()) for part in parts)
    ends = r"</(p|h\d|li|tr|pre|dt|dd|figcaption|caption|summary|div|option|label)>"
    page = re.sub(rf"{ends}|<(p|h\d|header|section|table)\b[^>]*>", "\n", page)
    page = re.sub(r"</t[dh]>", " | ", page)
    lines = (" ".join(line.split()) for line in unescape(re.sub(r"<[^>]*>", "", page)).splitlines())
    return "\n".join(line for line in lines if line)


def steady(said, folder):
    """Without what differs between two runs of the same bits."""
    for pattern, word in ((re.escape(str(folder)), "FOLDER"), *FLEETING):
        said = re.sub(pattern, word, said)
    return said


def transcript(pairs, *, differing):
    """The text of a file; where texts differ little, of all but the first of a kind only the lines that differ."""
    firsts, parts = {}, []
    for asked, said in pairs:
        if asked.startswith("#"):
            parts.append(asked)
            continue
        shown = lines = wrapped(said).splitlines()
        kind = asked.split()[1] if differing in ("pages", "cases") else differing
        first = firsts.setdefault(kind, lines) if kind not in ("", *WHOLE) else lines
        if first is not lines:
            found = difflib.unified_diff(*([*map(narrow, one)] for one in (first, lines)), n=0, lineterm="")
            shown = dict.fromkeys(line for line in found if line[:2] not in ("--", "++", "@@"))
        parts += [asked, *(f"    {line}".rstrip() for line in shown)]
    return "\n".join(parts) + "\n"


def narrow(line):
    """A line of a table whatever the width of its columns."""
    return re.sub(r"─+", "─", re.sub(r"(?<=\S)  +", "  ", line))


def wrapped(said):
    return "\n".join(
        fill(line, 110, subsequent_indent="  ", drop_whitespace=False) if len(line) > 110 else line.rstrip()
        for line in said.splitlines()
    )


@pytest.mark.parametrize("name", sorted(file.stem for file in HERE.glob("*.txt")))
def test_the_program_says_what_it_said_when_that_was_last_read(name, request, tmp_path, monkeypatch, capsys):
    file = HERE / f"{name}.txt"
    shutil.copytree(HERE / "files", tmp_path, dirs_exist_ok=True)
    for case, text in TEXTS.items():
        (tmp_path / f"{case}.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    told_by = {"refusals": refused, "results": told, "answers": answered, "sites": sited, "pages": paged}
    say = (told_by | {"sentences": worded, "records": recorded, "cases": cased}).get(
        name, lambda asked: commanded(asked, capsys)
    )
    # each line that asks, and each remark
    questions = [one for one in file.read_text(encoding="utf-8").splitlines() if one.startswith(("$ ", "#"))]
    pairs = [(one, "" if one.startswith("#") else steady(say(one[2:]), tmp_path)) for one in questions]
    text = transcript(pairs, differing=name if name in ("results", "pages", "cases") else "")
    if request.config.getoption("--say"):
        file.write_text(text, encoding="utf-8")
    before = file.read_text(encoding="utf-8")
    assert not list(
        difflib.unified_diff(before.splitlines(), text.splitlines(), "read", "said", lineterm="", n=0)
    )
