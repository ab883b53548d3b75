"""`ensemble`: probability of overturning with uncertain parameters."""

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from fem.batch.answers import falling_in_words, table_lines
from fem.batch.axes import MOTION_FILE
from fem.cli.console import STUDY, StudyFlags, print_result
from fem.results.kinds import ENSEMBLE

if TYPE_CHECKING:
    from fem.ensemble.result import EnsembleResult


def ensemble(ensemble: str, /, *, flags: StudyFlags = STUDY) -> int:
    """Sample the uncertain parameters and count how often the container overturns, with confidence intervals.

    Parameters
    ----------
    ensemble:
        An ensemble file or the name of a shipped one: fragility, boundary.
    """
    plan = importlib.import_module("fem.ensemble.file").load_ensemble(ensemble)
    folder = flags.folder(plan.name)
    study = importlib.import_module("fem.ensemble.run")
    with flags.options() as options:
        result = study.run_ensemble(plan, folder=folder, **options)
    return print_result(result, ENSEMBLE, folder, page_of(result, folder), as_json=flags.as_json)


def page_of(result: "EnsembleResult", folder: Path) -> Iterator[str]:
    """The lines of an ensemble, for people."""
    words = importlib.import_module("fem.ensemble.answers")
    yield f"{result.ensemble}: {result.title}" if result.title else result.ensemble
    each = "to rest" if isinstance(result.duration_s, str) else f"{result.duration_s:g} s"
    yield (
        f"  {len(result.points)} points x {result.draws} draws ({result.sampling}, seed {result.seed}), "
        f"model {result.model}, {each} each, {result.status}"
    )
    if result.motion_covered:
        yield f"  under {result.motion_covered}"
    count = len(result.random.get(MOTION_FILE, ()))
    motions = "the floor's motion is not random"
    if count:
        motions = f"the intervals are those of a sample of {count} motions"
    yield f"  random: {', '.join(result.random)}; {motions}"
    if result.drawn_over_uncertainty:
        yield f"  drawn as unknown inputs: {', '.join(result.drawn_over_uncertainty)}"
    if result.held:
        yield f"  held: {result.held}"
    limit = f"{result.probability:g}"
    regions = {
        "below": f"probability of {falling_in_words(result.limit_slip_m)} at most {limit}",
        "undecided": f"the {100.0 * result.confidence:g} % interval holds {limit}",
        "above": f"more than {limit}",
    }
    for name, count in result.regions.items():
        yield f"  {name:10} {count:>6} points  {regions[name]}"
    if result.failed:
        yield f"  failed     {result.failed:>6} draws; the intervals allow for either outcome of these"
    for name, line in words.fragility_lines(result):
        yield f"  {name:10} {line}"
    yield f"  files      {folder}"
    if answer := words.ensemble_answer(result):
        yield from table_lines(answer.lines())
