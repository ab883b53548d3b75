"""One known result of a run, changed as a line of a transcript says, and what is said of it.

A line holds keys of `run.json` with values as in TOML; "null" takes one away. Beside them: `case`, changes of the case
as `--set` takes them; `own` and `others`, figures of the run and of the members of its band, each with its change.
"""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

from fem.case.case import load_case
from fem.case.uncertainty import InputChange
from fem.model.geometry import build_container
from fem.model.model import static_checks_of
from fem.results.run_result import ChangedRun, RunResult, Verdict
from fem.run.card import card_of, warnings_for
from fem.run.described import governing, links_in_words
from fem.run.summary import brief_summary, plain_summary
from fem.run.sureness import judged

# The stack of four under 4.0 m/s2: 40 kN against 39.24 kN, 80 kNm against 53.955 kNm (the paper, g = 9.81).
CASE = load_case("seed_stack_plateau")
RESULT = replace(
    RunResult.from_json(json.loads((Path(__file__).parent / "result.json").read_text(encoding="utf-8"))),
    static=replace(static_checks_of(CASE, build_container(CASE), 4.0).to_result(), method_applicable=True),
)


def merged(block, changes):
    """JSON with changes at any depth."""
    if not isinstance(changes, dict):
        return None if changes == "null" else changes
    block = block if isinstance(block, dict) else {}
    return {**block, **{key: merged(block.get(key), value) for key, value in changes.items()}}


def changed(asked):
    """The result and its case with the changes of a line."""
    given = tomllib.loads(f"x = {{{asked}}}")["x"]
    case = load_case("seed_stack_plateau", given.pop("case", ()))
    own, others = given.pop("own", {}), given.pop("others", None)
    result = RunResult.from_json(merged(RESULT.to_json(), given))
    if others is not None:
        result = replace(result, verdict=judged_of(own, others))
    return result, case


def judged_of(own, others):
    """The verdict of a run among others: `kind`, `values`, `share` and `place` of a change, and figures found."""
    figures = {"outcome": "slide-rock", "rotation_ratio": 0.2, "max_slip_m": 0.2, "residual_slip_m": -0.2}
    figures |= own
    changes, members = [], [ChangedRun.from_json({"status": "completed"} | figures)]
    for found in others:
        parts = {key: found.pop(key) for key in ("values", "kind", "share", "place") if key in found}
        parts["place"] = tuple(parts.get("place", ()))
        changes.append(change := InputChange(**({"kind": "one", "share": 1.0} | parts)))
        block = {"status": "completed", "change": change.label, "kind": change.kind, "values": change.values}
        members.append(ChangedRun.from_json(block | figures | merged({}, found)))
    return judged(Verdict.from_json(figures), members, changes, (), width=1.1)


def told(asked):
    """First line, summary, terminal, warnings and all else that is said of a result."""
    result, case = changed(asked)
    folder = Path("outputs/stack")
    parts = {
        "card": "\n".join(card_of(result)),
        "rule or run": "\n".join(governing(result)) if result.verdict else "",
        "links": links_in_words(result) if result.verdict else "",
        "warnings": "\n".join(warnings_for(result, case)),
        "terminal": brief_summary(result, folder=folder),
        "summary": plain_summary(result, folder=folder),
    }
    assert not any(word in parts["summary"].lower() for word in ("safe", "verified", "stable"))
    assert max(map(len, parts["summary"].splitlines())) <= 80 and len(parts["terminal"].splitlines()) <= 40
    return "\n".join(f"# {part}\n{words}" for part, words in parts.items() if words)
