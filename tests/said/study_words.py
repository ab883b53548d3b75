"""What is said of studies for what a line of a transcript makes: `line(PEAK, "sso", slip=0.064)`, `hall("")`.

An answer in a sentence; or why a list, a file, an axis, an expression or a request is refused.
"""

from pathlib import Path

import numpy as np

from fem.case.case import load_case
from fem.case.validation import CaseError
from fem.html.page import _environment
from fem.response.lasting import PointRecord, PointRow, ResponseResult, result_of
from fem.response.request import ResponseRequest
from fem.results.outcome import Ending
from fem.study.answers import (
    Trial,
    answer_of,
    ensemble_answer,
    fallen_cells_in_words,
    is_rising,
    sentence_of,
)
from fem.study.axes import Axis, AxisError, in_words, read_axis  # noqa: F401 - lines of the text use them
from fem.study.derived import ExpressionError, parse_expression  # noqa: F401
from fem.study.file import load_ensemble, load_sweep
from fem.study.fragility import EnsembleResult
from fem.study.hall_file import read_hall
from fem.study.sweep_table import SweepResult, SweepTable

G = 9.80665
PEAK = Axis(key="motion.peak_acceleration_m_s2", values=(0.2 * G, 0.4 * G, 0.6 * G), unit="m/s2")
WIDTH = Axis(key="container.width_m", values=(0.8, 1.0, 1.2), unit="m")
MU = Axis(key="contact.mu_static", values=(0.2, 0.3, 0.4))
JOINTS = Axis(key="container.joints", values=("bolted", "loose"))
ENSEMBLE = Path(__file__).parent / "files" / "ensemble.toml"
SWEEP = 'case = "seed_stack_plateau"\n[set]\n"solver.model" = "rigid"\n'
#: a sweep over three frequencies
RATE = '[axes]\n"motion.angular_frequency_rad_s" = { from = 2.0, to = 4.0, count = 3 }\n'
KINDS = {"s": Ending.STANDING, "o": Ending.OVERTURNED, "f": Ending.FAILED}
REFUSALS = (CaseError, AxisError, ExpressionError)


def line(axis, kinds, slip=None, unsure="", limit=None):
    """A line of trials, a letter and perhaps a slip each; `unsure` has an x where one is."""
    slips = slip if isinstance(slip, tuple) else (slip,) * len(kinds)
    values = axis.values if len(axis.values) == len(kinds) else [0.1 * G * (k + 1) for k in range(len(kinds))]
    trials = [
        Trial(value, 0, KINDS[kind], slid, None if mark == "" else mark == "x")
        for value, kind, slid, mark in zip(values, kinds, slips, unsure or [""] * len(kinds), strict=True)
    ]
    rising = is_rising(axis, trials)
    return sentence_of(answer_of(trials, rising=rising, limit_slip=limit), axis, rising=rising)


def cells(axes, kinds, slip=0.0, limit=None):
    """The cells of a sweep without an axis of an answer, the last axis the fastest."""
    words = {"s": "rest", "o": "overturned", "i": "invalid", "f": ""}
    outcome = [words[kind] for kind in kinds.replace(" ", "")]
    status = ["completed" if word else "failed" for word in outcome]
    columns = {"status": np.array(status), "outcome": np.array(outcome)}
    columns["max_slip_m"] = np.where(columns["outcome"] == "rest", slip, 0.0)
    info = SweepResult(sweep_hash="", axes=axes, limit_slip_m=limit)
    return str(fallen_cells_in_words(SweepTable(info=info, columns=columns)))


def over(axis, *shares, slips=(), mu=None):
    """Points of an ensemble, whose intervals reach 0.1 to both sides."""
    for k, (value, share) in enumerate(zip(axis.values, shares, strict=True)):
        middle, region = 0.5 if share is None else share, "below" if share == 0.0 else "above"
        ends = {"low": max(middle - 0.1, 0.0), "high": min(middle + 0.1, 1.0)}
        point = ({} if mu is None else {MU.key: mu}) | {axis.key: value, "probability": share}
        yield point | {"region": region, **ends} | ({"max_slip_m": slips[k]} if slips else {})


def ensemble_of(*points, **more):
    """The answer of an ensemble, whose last axis is the fastest."""
    axes = [
        {"key": one.key, "values": sorted({point[one.key] for point in points}), "unit": one.unit}
        for one in (MU, PEAK, WIDTH)
        if one.key in points[0]
    ]
    found = {"status": "completed", "asked": "", "draws": 128, "random": {}, "confidence": 0.95}
    found |= {"probability": 0.05, "axes": axes, "points": list(points)}
    return ensemble_answer(EnsembleResult.from_json(found | more))


def draws(*points, **more):
    return ensemble_of(*points, **more).sentence


def point(frequency, direction, ratio, **changes):
    """A point of a response curve: rocking of period 1, or overturned."""
    fell = ratio is None
    given = {"number": round(10 * frequency), "frequency_Hz": frequency, "amplitude_m": 0.1}
    given |= {"peak_acceleration_m_s2": 1.0, "periods": 1, "period_n": 1, "direction": direction}
    given |= {"began": "random" if direction == "start" else "carried"}
    given |= {"rotation_ratio": ratio, "median_rotation_ratio": ratio, "slip_stroke_m": None if fell else 0.0}
    given |= {"motion": None if fell else "rock", "long_time": None if fell else "periodic"}
    return PointRow(**given | {"status": "overturned" if fell else "completed"} | changes)


STANDS = (point(0.5, "up", 0.1), point(1.0, "up", 0.62), point(1.0, "down", 0.3), point(0.5, "down", 0.1))
STARTS = tuple(
    point(frequency, "start", ratio)
    for frequency, ratio in ((1.0, 0.9), (1.0, 0.62), (1.0, None), (0.5, None))
)
CRUSHED = {"motion": "invalid", "long_time": None}


def record(row):
    none = {"sections": np.zeros((1, 4)), "extremes": np.zeros((1, 7)), "portrait": np.zeros((1, 2))}
    return PointRecord(row=row, **none)


def curve(*points, missing=None):
    """The sentence, and what lasts at each frequency."""
    result = result_of(ResponseResult(asked="", request={}), [record(row) for row in points], missing)
    lasts = "{% from 'response_words.txt.j2' import lasts %}{{ lasts(at) }}"
    words = (_environment(autoescape=False).from_string(lasts).render(at=at) for at in result.frequencies)
    return "\n".join([str(result.answer), *words])


def written(name, text):
    path = Path(name)
    path.write_text(text, encoding="utf-8")
    return path


def hall(text):
    return read_hall(written("list.csv", text)).rows


def ensemble(*changes):
    """The ensemble file with texts replaced, one after the other."""
    text = ENSEMBLE.read_text(encoding="utf-8")
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert old in text, old
        text = text.replace(old, new)
    return load_ensemble(written("e.toml", text))


def sweep(body, head=SWEEP):
    return load_sweep(written("try.toml", head + body))


def request(*changes, **values):
    given = {"first_Hz": 1.0, "last_Hz": 1.4, "count": 5} | values
    return ResponseRequest(case=load_case("seed_stack_plateau", ["solver.model=rigid", *changes]), **given)


def worded(asked):
    try:
        found = eval(asked)  # a line of this folder
        return found if isinstance(found, str) else "nothing is said against it"
    except REFUSALS as error:
        return str(error)
