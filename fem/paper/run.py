"""Trying all statements, keeping what is finished, and beginning no statement twice.

`study.json` is replaced whole after every statement, its figures lie in `figures/`. A statement that was computed
by the same program (the hash of its sources and the versions of what it computes with) is taken from there.
"""

import hashlib
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fem.paper.claims import Statement, Verdict
from fem.paper.experiments import InterruptedStudyError, Laboratory
from fem.paper.index import GROUPS, UNTRIED, all_statements
from fem.paper.page import study_page
from fem.results.disk import require_room
from fem.results.lock import LOCK_NAME, FolderLock
from fem.results.lock import locked_folder as held
from fem.results.run_folder import FolderError, to_json, write_atomically
from fem.runtime.identity import PACKAGES, versions

#: keeps the first guess of the pace from jumping [s]
STEADY = 20.0
RESULT, PAGE, FIGURES = "study.json", "study.html", "figures"
#: room that page, document and figures of a whole study take, twice while the page is written [bytes]
ROOM = 1e7


def fingerprint() -> str:
    """Hash of this program's sources and shipped cases, and of the versions of what it computes with."""
    digest = hashlib.sha256(json.dumps(versions(), sort_keys=True).encode())
    for root in (Path(__file__).parents[2] / package for package in PACKAGES):
        for path in sorted([*root.rglob("*.py"), *root.rglob("*.toml")]):
            digest.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()


def conduct(
    folder: Path,
    laboratory: Laboratory,
    *,
    statements: Sequence[tuple[str, Statement]] | None = None,
    force: bool = False,
    tell: Callable[[str], None] = lambda text: None,
) -> dict[str, Any]:
    """Try the statements into a folder; returns what `study.json` holds.

    Args:
        folder: made if it is not there; must hold a study, or nothing.
        laboratory: where the runs are made.
        statements: group and statement; all by default.
        force: compute what is there as well.
        tell: told of each statement before it is tried.

    Raises:
        FolderError: the folder holds something else, cannot be made, or has no room for a study.
        FolderLockedError: another process writes there.
        FolderUnwritableError: a read-only place, or a full one.
        OSError: the disk is full, the folder was removed; what was written can be read.
    """
    chosen = list(statements if statements is not None else all_statements())
    program = fingerprint()
    _require_a_study(folder)
    with held(folder) as lock:
        kept = {} if force else _finished(folder, program)
        require_room(folder, ROOM, "the study", "make room", (RESULT, PAGE, f"{FIGURES}/*.svg"))
        (folder / FIGURES).mkdir(exist_ok=True)
        return _conduct(folder, lock, laboratory, chosen, kept, program, tell)


def _conduct(
    folder: Path,
    lock: FolderLock,
    laboratory: Laboratory,
    chosen: Sequence[tuple[str, Statement]],
    kept: dict[str, dict[str, Any]],
    program: str,
    tell: Callable[[str], None],
) -> dict[str, Any]:
    """Try what is not kept; the document that lies in the folder then."""
    began = time.perf_counter()
    entries: dict[str, dict[str, Any]] = dict(kept)
    todo = [statement for _, statement in chosen if statement.name not in kept]
    status, spent, computed = "completed", STEADY, STEADY
    for number, statement in enumerate(todo, start=1):
        left = sum(one.seconds for one in todo[number - 1 :])
        minutes = max(left * spent / computed, 1.0) / 60.0
        tell(f"[{number}/{len(todo)}] {statement.name}, about {minutes:.1f} min left")
        start = time.perf_counter()
        try:
            entries[statement.name] = _tried(statement, laboratory, folder, program)
        except (InterruptedStudyError, KeyboardInterrupt):
            status = "interrupted"
            break
        spent += time.perf_counter() - start
        computed += statement.seconds
        lock.check()
        _write(folder, _document("running", program, entries, began))
    if status == "completed" and any(
        entry["verdict"] == Verdict.UNDECIDED.value for entry in entries.values()
    ):
        status = "failed"
    document = _document(status, program, entries, began)
    lock.check()
    _write(folder, document)
    svgs = {path.stem: path.read_text(encoding="utf-8") for path in (folder / FIGURES).glob("*.svg")}
    write_atomically(folder / PAGE, study_page(json.loads(to_json(document)), svgs))
    return document


def _tried(statement: Statement, laboratory: Laboratory, folder: Path, program: str) -> dict[str, Any]:
    """What trying a statement gave, as plain data; what cannot be computed says why and decides nothing."""
    began = time.perf_counter()
    entry: dict[str, Any] = {
        "name": statement.name,
        "section": statement.section,
        "quote": statement.quote,
        "tried": statement.tried,
        "program": program,
    }
    laboratory.failed.clear()
    try:
        finding = statement.examine(laboratory)
    except (ArithmeticError, ValueError, RuntimeError, LookupError, TypeError) as error:
        entry |= {"verdict": Verdict.UNDECIDED.value, "error": f"{type(error).__name__}: {error}"}
    else:
        for one in finding.drawings:
            write_atomically(folder / FIGURES / f"{one.name}.svg", one.svg)
        entry |= finding.to_dict() | {"failed_runs": len(laboratory.failed)}
    return entry | {"seconds": time.perf_counter() - began}


def _document(status: str, program: str, entries: dict[str, dict[str, Any]], began: float) -> dict[str, Any]:
    groups = [
        {
            "title": title,
            "statements": [entries[one.name] for one in statements if one.name in entries],
        }
        for title, statements in GROUPS.items()
    ]
    counts = {
        verdict.value: sum(entry["verdict"] == verdict.value for entry in entries.values())
        for verdict in Verdict
    }
    return {
        "study": "seed",
        "status": status,
        "counts": counts,
        "statements": sum(counts.values()),
        "groups": [group for group in groups if group["statements"]],
        "untried": [asdict(one) for one in UNTRIED],
        "program": program,
        "versions": versions(),
        "wall_s": time.perf_counter() - began,
    }


def _finished(folder: Path, program: str) -> dict[str, dict[str, Any]]:
    """Statements in the folder that this very program decided, and whose figures are there."""
    path = folder / RESULT
    if not path.is_file():
        return {}
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        found = [entry for group in document["groups"] for entry in group["statements"]]
    except (OSError, ValueError, KeyError, TypeError):
        raise FolderError(
            f"{path}: damaged, or not the result of a study; choose another folder with --out DIR, or "
            "overwrite it with --force"
        ) from None
    return {
        entry["name"]: entry
        for entry in found
        if entry.get("program") == program
        and entry["verdict"] != Verdict.UNDECIDED.value
        and all((folder / FIGURES / f"{one['name']}.svg").is_file() for one in entry["drawings"])
    }


def _require_a_study(folder: Path) -> None:
    """Refuse a folder that holds something else."""
    try:
        if folder.is_dir() and not (folder / RESULT).is_file():
            others = [entry.name for entry in folder.iterdir() if entry.name not in (LOCK_NAME, FIGURES)]
            if any(not name.endswith(".part") for name in others):
                raise FolderError(f"{folder} is not empty and holds no study; choose another with --out DIR")
    except OSError as error:
        raise FolderError(
            f"{folder}: cannot be used ({error.strerror}); choose another folder with --out DIR"
        ) from None


def _write(folder: Path, document: dict[str, Any]) -> None:
    write_atomically(folder / RESULT, to_json(document))
