"""Folders of an ensemble and of a response curve as the commands leave them, of few points, without running them."""

import json
from pathlib import Path

from fem.case.case import load_case, to_toml

PEAK = "motion.peak_acceleration_m_s2"
G = 9.80665
FIGURE = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100" height="50"><g><path d="M 0 0 L 9 9"/></g></svg>'
)
VERSIONS = {"unanchored": "0.1.0"}


def ensemble_folder(folder: Path, **more: object) -> Path:
    """A fragility curve of three points: half of the draws overturn at 0.45 g."""
    counted = [(0.2, 100, 0, "below"), (0.4, 60, 40, "above"), (0.6, 20, 80, "above")]
    points = [
        {PEAK: peak * G, "draws": 100, "stood": stood, "overturned": fell, "failed": 0, "region": region}
        | {
            "probability": fell / 100,
            "low": max(fell - 10, 0) / 100,
            "high": (fell + 10 if fell else 4) / 100,
        }
        for peak, stood, fell, region in counted
    ]
    info = {
        "status": "completed",
        "asked": "ab" * 32,
        "ensemble": "my ensemble",
        "title": "</script><b>",
        "model": "rigid",
        "draws": 100,
        "seed": 3,
        "sampling": "independent",
        "confidence": 0.95,
        "probability": 0.05,
        "axes": [{"key": PEAK, "values": [point[PEAK] for point in points], "unit": "m/s2"}],
        "random": {
            "contact.mu_static": {
                "distribution": "normal",
                "mean": 1.0,
                "deviation": 0.05,
                "cut": 3.0,
                "relative": True,
            },
            "free.ratio": {"distribution": "uniform", "from": 0.5, "to": 1.0},
        },
        "derived": {"contact.mu_kinetic": "free.ratio * contact.mu_static"},
        "drawn_over_uncertainty": ["motion.start"],
        "held": "with no ramp",
        "points": points,
        "regions": {"below": 1, "undecided": 0, "above": 2},
        "failed": 0,
        "fragility": {"axis": PEAK, "falls": [], "lognormal": None, "no_lognormal": "fewer than 4 levels"},
        "versions": VERSIONS,
    }
    texts = {"ensemble.json": json.dumps(info | more), "ensemble.toml": 'case = "<b>.toml"\n'}
    return _write(folder, texts | {"base.toml": to_toml(load_case()), "figures/fragility.svg": FIGURE})


def response_folder(folder: Path, **more: object) -> Path:
    """Two frequencies up and down; the upper one has two motions, the lower one overturns on the way down."""
    rows = [("up", 0, 0.5, 0.1), ("up", 1, 1.0, 0.62), ("down", 1, 1.0, 0.2), ("down", 0, 0.5, None)]
    points = [
        {"direction": direction, "number": number, "frequency_Hz": frequency, "amplitude_m": 0.05}
        | {
            "peak_acceleration_m_s2": 4.0,
            "began": "carried",
            "motion": "overturned" if ratio is None else "rock",
        }
        | {
            "status": "overturned" if ratio is None else "completed",
            "periods": 108,
            "bounded": ratio is not None,
        }
        | {"long_time": None if ratio is None else "periodic", "period_n": None if ratio is None else 1}
        | {
            "rotation_ratio": ratio,
            "slip_stroke_m": ratio and 0.012,
            "stable": ratio is not None,
            "reason": None,
        }
        for direction, number, frequency, ratio in rows
    ]
    motions = [
        {"motion": "rock of period 1", "period_n": 1, "rotation_ratio": ratio, "ways": [way], "starts": 0}
        for ratio, way in ((0.1, "up"), (0.62, "up"), (0.2, "down"))
    ]
    request = {"first_Hz": 0.5, "last_Hz": 1.0, "count": 2, "scale": "linear", "held": "acceleration"}
    request |= {"held_value": 4.0, "order": "up-down", "settle": 60, "observe": 48, "tolerance": 5e-3}
    info = {
        "status": "completed",
        "asked": "cd" * 32,
        "case": "my stack",
        "title": "Stack <b>",
        "request": request | {"largest_period": 16, "starts": 0},
        "points": points,
        "frequencies": [
            {
                "frequency_Hz": 0.5,
                "eta": 1.65,
                "starts": 0,
                "fell": 0,
                "destroyed": 0,
                "motions": motions[:1],
            },
            {"frequency_Hz": 1.0, "eta": 3.3, "starts": 0, "fell": 0, "destroyed": 0, "motions": motions[1:]},
        ],
        "coexisting": [
            {
                "from_Hz": 1.0,
                "to_Hz": 1.0,
                "frequencies": 1,
                "motions": ["rock of period 1"],
                "largest_difference": 0.42,
            }
        ],
        "drop_outs": [{"direction": "down", "from_Hz": 0.5, "to_Hz": 0.5, "frequencies": 1, "carried": True}],
        "versions": VERSIONS,
    }
    texts = {"response.json": json.dumps(info | more), "case.toml": to_toml(load_case())}
    return _write(folder, texts | {"figures/response_curve.svg": FIGURE})


def _write(folder: Path, texts: dict[str, str]) -> Path:
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder
