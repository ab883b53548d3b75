"""Processor time of the bands of 20-s runs, without the runs themselves, set-up and compilation."""

import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from measuring import Figure, at_most, report

from fem.case.case import load_case
from fem.model.model import build_model
from fem.results.run_result import Verdict
from fem.run.band import with_band
from fem.run.run import RunOptions, run_case

#: changes of the default case, and CPU seconds that its band may take
CASES: dict[str, tuple[list[str], float | None]] = {
    "rigid": (["solver.model=rigid"], 1.5),
    "shell on corners": ([], 6.0),
    "solid on corners": (["container.section=solid"], 6.0),
    "shell on feet": (["support.kind=feet"], None),
    "shell on a flat base": (["support.kind=flat"], None),
}
QUICK = ["floor.kind=rigid", "output.figures=false", "output.fields_s=0"]


def band(changes: list[str], folder: Path) -> tuple[Verdict, float]:
    """The verdict with its band, and what the band took [CPU s]."""
    case = load_case("seed_stack_plateau", [*changes, *QUICK])
    run = run_case(case, case_text=case.text, folder=folder, options=RunOptions(band=False)).typed_result
    model = build_model(case)
    began = time.process_time()
    judged = with_band(model, run, stop=lambda: False)
    spent = time.process_time() - began
    assert judged is not None
    return judged, spent


def figures() -> list[Figure]:
    found = []
    with TemporaryDirectory() as folder:
        for k, (what, (changes, limit)) in enumerate(CASES.items()):
            band([*changes, "solver.duration_s=0.2"], Path(folder) / f"compiled_{k}")
            verdict, spent = band(changes, Path(folder) / f"run_{k}")
            assert verdict.band is not None
            one = verdict.band
            details = f" s, {len(one.members)} runs, {one.draws} draws, {len(one.left_out)} changes left out"
            details += f"; {verdict.sure}: {', '.join(verdict.decided_by)}"
            if limit is None:
                found.append(Figure(what, f"{spent:.2f}{details}"))
            else:
                found.append(at_most(what, spent, limit, details=details))
    return found


if __name__ == "__main__":
    sys.exit(report("Bands of 20-s runs, CPU time", figures()))
