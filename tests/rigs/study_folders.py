"""Folders of a sweep, an ensemble and a response curve as the commands leave them, of few points, without a run."""

import json
from collections.abc import Sequence
from pathlib import Path

from cases import HARMONIC

from fem.case.case import load_case, to_toml
from fem.study.sweep_table import BAND, FOUND, WIDTH

HERE = Path(__file__).parent
FIGURE = '<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><g><path d="M 0 0 L 9 9"/></g></svg>'


def ensemble_folder(folder: Path, **more: object) -> Path:
    """A fragility curve of three points: half of the draws overturn at 0.45 g."""
    texts = {"ensemble.toml": 'case = "<b>.toml"\n', "base.toml": to_toml(load_case())}
    return _write(folder, "ensemble", "fragility", texts, more)


def response_folder(folder: Path, **more: object) -> Path:
    """Two frequencies up and down; the upper one has two motions, the lower one overturns on the way down."""
    case = {"case.toml": to_toml(load_case())}
    if more.pop("unjudged", False):
        points = json.loads((HERE / "response_result.json").read_text(encoding="utf-8"))["points"]
        more["points"] = [point | {"stable": None} for point in points]
    return _write(folder, "response", "response_curve", case, more)


SPEED, MU = "motion.peak_acceleration_m_s2", "contact.mu_static"
BASE = HARMONIC.replace("amplitude_m = 0.05", "peak_acceleration_m_s2 = 4.0") + '[solver]\nmodel = "rigid"\n'
NEWER = ("held", "sure", "decided_by", "left_out", "copies")  #: than the first sweeps
OUTCOMES = ("rest", "rest", "slide", "rest", "overturned", "")


def sweep_folder(folder: Path, outcomes: Sequence[str] = OUTCOMES, *, old: bool = False) -> Path:
    """A finished sweep of 3 x 2 cells, one of them unsure; "" is a failure.

    With `old` the table has no columns `sure` and `decided_by`, and `sweep.json` no counts of them.
    """
    folder.mkdir(exist_ok=True)
    axes = [
        {"key": SPEED, "values": [1.0, 4.5, 20.0], "scale": "list", "unit": "m/s2"},
        {"key": MU, "values": [0.2, 0.4], "scale": "list", "unit": ""},
    ]
    info = {"status": "completed", "sweep": "boxes", "title": "</script><b>", "case": "seed_stack"}
    info |= {"model": "rigid", "axes": axes, "derived": {"contact.mu_kinetic": f"0.5 * {MU}"}}
    info |= {"cells": 6, "rows": 6, "held": "with mu_k = mu_s/2 falling at once", "unsure": 2}
    info |= {"sure": {"sure": 3, "regime unsure": 1, "unsure": 2}}
    info |= {"decided_by": {"contact.mu_kinetic": 1, "motion.start": 1}, "left_out": "pairs"}
    info |= {"perturbed": 2, "copies": 7, "maps": ["../outside.svg"]}
    info |= {"sweep_hash": "ab" * 32, "versions": {"unanchored": "0.1.0"}}
    if old:
        info = {name: info[name] for name in info if name not in NEWER}
    (folder / "sweep.json").write_text(json.dumps(info))
    (folder / "base.toml").write_text(BASE, encoding="utf-8")
    columns = ["cell", SPEED, MU, "contact.mu_kinetic", *FOUND, *BAND, WIDTH + SPEED, WIDTH + MU]
    columns = [name for name in columns if not (old and name in NEWER)]
    lines = [",".join(columns)]
    for cell, outcome in enumerate(outcomes):
        row = dict.fromkeys(columns, "")
        row |= {
            "cell": cell,
            SPEED: axes[0]["values"][cell // 2],
            MU: axes[1]["values"][cell % 2],
            "contact.mu_kinetic": 0.5 * axes[1]["values"][cell % 2],
            "status": "completed" if outcome else "failed",
            "outcome": outcome,
            "reason": "" if outcome else "no <b>balance",
            "rotation_ratio": 0.01 * cell if outcome else "",
            "max_slip_m": 0.001 * cell if outcome else "",
            "unsure": "true" if cell in (2, 5) else "false",
            "sure": ("sure", "regime unsure", "unsure", "sure", "sure", "unsure")[cell],
            "decided_by": "contact.mu_kinetic motion.start" if cell == 2 else "",
        }
        lines.append(",".join(str(row[name]) for name in columns))
    (folder / "table.csv").write_text("\n".join(lines) + "\n")
    return folder


def _write(folder: Path, kind: str, figure: str, texts: dict[str, str], more: dict[str, object]) -> Path:
    result = json.loads((HERE / f"{kind}_result.json").read_text(encoding="utf-8")) | more
    texts = texts | {f"{kind}.json": json.dumps(result), f"figures/{figure}.svg": FIGURE}
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder
