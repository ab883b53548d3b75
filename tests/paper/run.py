"""Check claims into a folder, and keep what is finished.

`study.json` is replaced whole after every claim, its figures are in `figures/`. A claim that the same version of the
program has decided, with the same libraries, is taken from there.
"""

import hashlib
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, Literal

from evidence.findings import attempted
from evidence.pages import page_of
from jinja2 import UndefinedError
from paper import counting, example, overturning, quasi_static, rocking, shape, sliding, stacking
from paper.claims import Claim, Conclusion
from paper.experiments import Experiments, InterruptedStudyError

from fem.case.validation import CaseError, did_you_mean
from fem.html.page import Signature
from fem.results.errors import FolderError
from fem.results.folder import REMEDY, ResultFolder, open_result_folder, program_of_results
from fem.results.json_block import JsonBlock
from fem.results.kinds import PAPER, read_result, typed_result
from fem.run.expected import say_expected
from fem.runtime.compilation import compilation_announced
from fem.runtime.progress import ScreenReporter
from fem.runtime.signals import interruptible
from fem.runtime.threads import cores

#: every claim of the paper that is checked, by topic, each in the order of its file
TOPICS = {
    title: tuple(claim for claim in vars(module).values() if isinstance(claim, Claim))
    for title, module in {
        "The central claim, counted": counting,
        "The example of section 7": example,
        "Limit conditions": quasi_static,
        "Sliding and friction": sliding,
        "Rocking and response": rocking,
        "Overturning": overturning,
        "The body": shape,
        "Boxes without bolts": stacking,
    }.items()
}

#: sentences of the paper that no run can confirm or refute: section, quote, reason
UNTRIED = (
    (
        "3",
        "For simplicity ... the seismic action is assumed to be a horizontal harmonic ground motion",
        'An assumption, not a claim; recorded motions are another study (motion.kind = "table").',
    ),
    (
        "3",
        "the asperity of both contact surfaces being represented by constant coefficients",
        "An assumption; the effect of the coefficients is checked under sliding.",
    ),
    (
        "4.1",
        "there is no simple engineering solution published, which includes friction with “belt-reversals”",
        "A statement on the literature. Westermo and Udwadia (1983) give the sliding oscillator on a reversing floor "
        "in closed form; rocking and sliding together have criteria of initiation (Shenton 1996), not more.",
    ),
    (
        "4.3",
        "values are given for steel on concrete ... big differences result from higher displacement rates",
        "A matter of tests on materials.",
    ),
    (
        "6",
        "the tuning of the driving frequency can be difficult",
        "A remark on method; `python -m fem response` follows a frequency up and down.",
    ),
)


def all_claims() -> list[Claim]:
    """All checked claims, in the order of the page."""
    return [claim for claims in TOPICS.values() for claim in claims]


STUDY, PAGE, FIGURES = "seed", "study.html", "figures"
#: size of page, document and figures of all claims, twice while the page is written [bytes]
ROOM = 1e7
OF_A_CLAIM_S = 3.3  #: processor time, on average [s]

#: folders of the tests that decide, besides the program
SOURCES = ("evidence", "paper", "rigs", "verification")
Entries = dict[str, dict[str, Any]]  #: of `study.json`, by the name of the claim


@dataclass(frozen=True, kw_only=True)
class _Band(JsonBlock):
    quantity: str
    unit: str
    criterion: str
    summary: str
    low: float
    high: float
    members: tuple[Mapping[str, Any], ...]
    columns_of: ClassVar[Mapping[str, Mapping[str, Any]]] = {"members": {"what": str}}
    needed: ClassVar[frozenset[str]] = frozenset({"what"})


@dataclass(frozen=True, kw_only=True)
class _Entry(JsonBlock):
    """A claim in `study.json`; without what its check showed where it could not be computed."""

    name: str
    section: str
    quote: str
    tried: str
    verdict: str
    error: str = ""
    reading: str = ""
    bounds: str = ""
    rule: str = ""
    comparisons: tuple[Mapping[str, Any], ...] = ()
    setups: tuple[Mapping[str, Any], ...] = ()
    tables: tuple[Mapping[str, Any], ...] = ()
    drawings: tuple[Mapping[str, Any], ...] = ()
    band: _Band | None = None
    failed_runs: int = 0
    columns_of: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "comparisons": {"what": str, "unit": str, "relation": Literal["=", "<=", ">="], "holds": bool},
        "setups": {"what": str, "command": str},
        "tables": {"caption": str, "columns": tuple[str, ...], "rows": tuple[tuple[Any, ...], ...]},
        "drawings": {"name": str, "caption": str},
    }
    needed: ClassVar[frozenset[str]] = frozenset(
        {"what", "relation", "unit", "command", "caption", "columns", "rows", "name"}
    )


@dataclass(frozen=True, kw_only=True)
class _Topic(JsonBlock):
    title: str
    statements: tuple[_Entry, ...]


@dataclass(frozen=True, kw_only=True)
class _Document(JsonBlock):
    """What the page reads of `study.json`."""

    status: str
    counts: dict[str, int]
    statements: int
    groups: tuple[_Topic, ...]
    untried: tuple[Mapping[str, Any], ...]
    program: str
    versions: dict[str, str]
    wall_s: float
    columns_of: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "untried": dict.fromkeys(("section", "quote", "reason"), str)
    }
    needed: ClassVar[frozenset[str]] = frozenset({"section", "quote", "reason"})


def check_claims(
    folder: Path,
    experiments: Experiments,
    *,
    claims: Sequence[Claim] | None = None,
    force: bool = False,
    report: Callable[[str], None] = lambda text: None,
) -> dict[str, Any]:
    """Check claims, or all, into a folder; returns the content of `study.json`.

    The folder is made if it is missing, and must hold claims checked earlier, or nothing. With `force` decided ones are
    checked again, and what the folder holds is overwritten. `report` is told each claim before it is checked.
    """
    began = time.perf_counter()
    way_on = "the same command continues"
    with open_result_folder(folder, PAPER, STUDY, force=force, resume=True, way_on=way_on) as results:
        entries = _decided(results)
        results.require_room(ROOM, "the study", "make room")
        results.begin(_document("running", entries, began), keep=bool(entries))
        chosen = list(all_claims() if claims is None else claims)
        todo = [claim for claim in chosen if claim.name not in entries]
        status = "completed"
        for number, claim in enumerate(todo, start=1):
            report(f"[{number}/{len(todo)}] {claim.name}")
            try:
                entries[claim.name] = _checked(claim, experiments, results)
            except (InterruptedStudyError, KeyboardInterrupt):
                status = "interrupted"
                break
            results.check()
            results.write_result(_document("running", entries, began))
        undecided = any(entry["verdict"] == Conclusion.UNDECIDED.value for entry in entries.values())
        if status == "completed" and undecided:
            status = "failed"
        document = _document(status, entries, began)
        results.check()
        results.write_result(document)
        results.write(PAGE, paper_report(folder))
        return document


def check_paper(
    folder: Path, *, only: Sequence[str], jobs: int | None, force: bool, quiet: bool
) -> dict[str, Any]:
    """Check claims by name, or all, into a folder, and report each with its runs."""
    every = {claim.name: claim for claim in all_claims()}
    for name in only:
        if name not in every:
            hint = did_you_mean(name, every)
            raise CaseError(f"--only: no such claim {name!r}{hint} (known: {', '.join(every)})")
    claims = [claim for name, claim in every.items() if not only or name in only]
    reporter = ScreenReporter(quiet=quiet)
    workers = jobs or cores()
    say_expected(reporter, f"{len(claims)} claims", OF_A_CLAIM_S * len(claims) / workers, workers)
    in_place = not quiet and sys.stderr.isatty()

    def progress(done: int, total: int) -> None:
        if in_place:
            end = "\r" if done < total else "\r" + " " * 40 + "\r"
            print(f"    {done} of {total} runs", end=end, file=sys.stderr, flush=True)

    with interruptible(reporter) as stop, compilation_announced(reporter.message):
        experiments = Experiments(jobs=jobs, progress=progress, stop=stop)
        return check_claims(folder, experiments, claims=claims, force=force, report=reporter.message)


def paper_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page of a folder of checked claims."""
    path = folder / PAPER.mark
    document = read_result(path, PAPER)
    typed_result(_Document, document, path)
    try:
        figures = {svg.stem: svg.read_text(encoding="utf-8") for svg in (folder / FIGURES).glob("*.svg")}
        return page_of("study", document, figures, signature or Signature())
    except (OSError, ValueError, KeyError, TypeError, AttributeError, UndefinedError) as error:
        raise FolderError(
            f"{path}: damaged, or not the result of a study ({error}); compute it again with "
            "python -m fem study seed --force"
        ) from None


@cache
def _decided_by() -> dict[str, Any]:
    """Program, libraries and checks: a claim that the same have decided is not checked again."""
    program = program_of_results()
    digest = hashlib.sha256(program["program"].encode())
    for folder in SOURCES:
        for source in sorted((Path(__file__).parents[1] / folder).rglob("*.py")):
            digest.update(source.read_bytes())
    return program | {"program": digest.hexdigest()[:16]}


def _checked(claim: Claim, experiments: Experiments, results: ResultFolder) -> dict[str, Any]:
    """Check a claim: its entry of `study.json`. A claim that cannot be computed gives the reason."""
    entry: dict[str, Any] = {name: getattr(claim, name) for name in ("name", "section", "quote", "tried")}
    entry["program"] = _decided_by()["program"]
    experiments.failed.clear()
    result, reason, seconds = attempted(lambda: claim.check(experiments))
    if result is None:
        entry |= {"verdict": Conclusion.UNDECIDED.value, "error": reason}
    else:
        for figure in result.figures:
            results.write(f"{FIGURES}/{figure.name}.svg", figure.svg)
        entry |= result.to_dict() | {"failed_runs": len(experiments.failed)}
    return entry | {"seconds": seconds}


def _document(status: str, entries: Entries, began: float) -> dict[str, Any]:
    groups = [
        {"title": title, "statements": [entries[claim.name] for claim in claims if claim.name in entries]}
        for title, claims in TOPICS.items()
    ]
    verdicts = [entry["verdict"] for entry in entries.values()]
    return {
        "study": STUDY,
        "status": status,
        "counts": {conclusion.value: verdicts.count(conclusion.value) for conclusion in Conclusion},
        "statements": len(verdicts),
        "groups": [group for group in groups if group["statements"]],
        "untried": [dict(zip(("section", "quote", "reason"), sentence, strict=True)) for sentence in UNTRIED],
        **_decided_by(),
        "wall_s": time.perf_counter() - began,
    }


def _decided(results: ResultFolder) -> Entries:
    """Claims in the folder that this version of the program decided, and whose figures are there."""
    study, program = results.earlier or {}, _decided_by()
    try:
        entries = [entry for group in study.get("groups", ()) for entry in group["statements"]]
        return {
            entry["name"]: entry
            for entry in entries
            if study["versions"] == program["versions"]
            and entry["program"] == program["program"]
            and entry["verdict"] != Conclusion.UNDECIDED.value
            and all(
                (results.path / FIGURES / f"{drawing['name']}.svg").is_file() for drawing in entry["drawings"]
            )
        }
    except (KeyError, TypeError, AttributeError):
        mark = results.path / results.kind.mark
        raise FolderError(f"{mark}: damaged, or not the result of a study; {REMEDY}") from None
