"""Check claims into a folder, and keep what is finished.

`study.json` is replaced whole after every claim, its figures are in `figures/`. A claim that the same version of the
program has decided, with the same libraries, is taken from there.
"""

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from evidence.suite import attempted
from paper.claims import Claim, Conclusion
from paper.experiments import Experiments, InterruptedStudyError
from paper.index import TOPICS, UNTRIED, all_claims
from paper.page import paper_report

from fem.results.errors import FolderError
from fem.results.folder import REMEDY, ResultFolder, open_result_folder, program_of_results
from fem.results.kinds import PAPER

STUDY, PAGE, FIGURES = "seed", "study.html", "figures"
#: size of page, document and figures of all claims, twice while the page is written [bytes]
ROOM = 1e7

Entries = dict[str, dict[str, Any]]  #: of `study.json`, by the name of the claim


def check_claims(
    folder: Path,
    experiments: Experiments,
    *,
    claims: Sequence[Claim] | None = None,
    force: bool = False,
    report: Callable[[str], None] = lambda text: None,
) -> dict[str, Any]:
    """Check claims into a folder; returns the content of `study.json`.

    Args:
        folder: made if it is missing; must hold claims checked earlier, or nothing.
        experiments: computes the runs.
        claims: all by default.
        force: check those again that are decided, and overwrite what the folder holds.
        report: called with a line before each claim is checked.

    Raises:
        FolderError: the folder holds something else, cannot be made, or has no room.
        OutputError: the disk is full or read-only, or the folder was removed; what was written can be read.
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
        results.write_text(PAGE, paper_report(folder))
        return document


def _checked(claim: Claim, experiments: Experiments, results: ResultFolder) -> dict[str, Any]:
    """Check a claim: its entry of `study.json`. A claim that cannot be computed gives the reason."""
    entry: dict[str, Any] = {name: getattr(claim, name) for name in ("name", "section", "quote", "tried")}
    entry["program"] = program_of_results()["program"]
    experiments.failed.clear()
    done = attempted(lambda: claim.check(experiments))
    if done.result is None:
        entry |= {"verdict": Conclusion.UNDECIDED.value, "error": done.reason}
    else:
        for figure in done.result.figures:
            results.write_text(f"{FIGURES}/{figure.name}.svg", figure.svg)
        entry |= done.result.to_dict() | {"failed_runs": len(experiments.failed)}
    return entry | {"seconds": done.seconds}


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
        **program_of_results(),
        "wall_s": time.perf_counter() - began,
    }


def _decided(results: ResultFolder) -> Entries:
    """Claims in the folder that this version of the program decided, and whose figures are there."""
    study, program = results.earlier or {}, program_of_results()
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
