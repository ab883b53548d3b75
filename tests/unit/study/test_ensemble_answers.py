"""Where half of the draws overturn: the shares and their intervals joined by straight lines, told in a sentence."""

import pytest

from fem.study.answers import ensemble_answer
from fem.study.fragility import EnsembleResult

G = 9.80665
PEAK, WIDTH, MU = "motion.peak_acceleration_m_s2", "container.width_m", "contact.mu_static"
UNITS = {PEAK: "m/s2", WIDTH: "m", MU: ""}


def result_of(*rows, **more):
    """A result: rows of the axes' values, share, low, high, region; the last axis is the fastest."""
    keys = [key for key in rows[0] if key in UNITS]
    axes = [{"key": key, "values": sorted({row[key] for row in rows}), "unit": UNITS[key]} for key in keys]
    found = {
        "status": "completed",
        "asked": "",
        "draws": 128,
        "random": {},
        "confidence": 0.95,
        "probability": 0.05,
        "axes": axes,
        "points": list(rows),
    }
    return EnsembleResult.from_json(found | more)


def row(share, region="above", spread=0.1, **values):
    middle = 0.5 if share is None else share
    ends = {"low": max(middle - spread, 0.0), "high": min(middle + spread, 1.0)}
    return values | {"probability": share, "region": region} | ends


def over(key, *shares, **others):
    values = {PEAK: (0.2 * G, 0.4 * G, 0.6 * G), WIDTH: (0.8, 1.0, 1.2)}[key]
    return [
        row(share, "below" if share == 0.0 else "above", **others, **{key: value})
        for value, share in zip(values, shares, strict=True)
    ]


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        (
            over(PEAK, 0.0, 0.4, 0.8),
            "peak acceleration: half of 128 draws overturned at 0.45 g (95 % interval 0.4 g to 0.5 g); "
            "at most 5 % up to 0.2 g, by the upper end of the interval",
        ),
        (
            over(PEAK, 0.1, 0.2, 0.3),
            "peak acceleration: fewer than half of 128 draws overturned at every value tried, at most 30 % at 0.6 g",
        ),
        (
            over(PEAK, 0.9, 1.0, 1.0),
            "peak acceleration: half of 128 draws overturned or more at the least tried, 0.2 g",
        ),
        (
            over(PEAK, 0.45, 0.48, 0.55),
            "peak acceleration: half of 128 draws overturned at 0.457 g (95 % interval below 0.2 g to beyond 0.6 g)",
        ),
        (
            over(WIDTH, 0.8, 0.4, 0.0),
            "width: half of 128 draws overturned at 0.95 m (95 % interval 0.9 m to 1 m); "
            "at most 5 % from 1.2 m on, by the upper end of the interval",
        ),
    ],
)
def test_a_curve_has_one_sentence(rows, sentence):
    assert ensemble_answer(result_of(*rows)).sentence == sentence


@pytest.mark.parametrize(
    ("draws", "words"),
    [(2, "half of 2 motions overturned"), (10, "half of 10 draws of 2 motions overturned")],
)
def test_motions_of_a_set_are_counted_as_such(draws, words):
    result = result_of(
        *over(PEAK, 0.0, 0.5, 1.0), draws=draws, random={"motion.file": ["a.at2", ["b_h", "b_v"]]}
    )
    assert ensemble_answer(result).sentence.startswith(f"peak acceleration: {words} at 0.4 g")


def test_an_island_does_not_move_the_first_crossing():
    found = ensemble_answer(result_of(*over(PEAK, 0.0, 0.8, 0.3))).rows[0].found
    assert found.value == pytest.approx((0.2 + 0.2 * 0.5 / 0.8) * G)


def test_a_point_without_outcome_is_left_out():
    rows = over(PEAK, 0.0, None, 1.0)
    assert ensemble_answer(result_of(*rows)).rows[0].found.value == pytest.approx(0.4 * G)


def test_a_boundary_has_a_row_for_each_value_of_the_other_axis():
    rows = [*over(PEAK, 0.0, 0.25, 0.75, **{MU: 0.3}), *over(PEAK, 0.0, 0.5, 1.0, **{MU: 0.6})]
    answer = ensemble_answer(result_of(*rows))
    assert answer.sentence == (
        "peak acceleration: half of 128 draws overturned at 0.4 g (95 % interval 0.36 g to 0.44 g), first with "
        "mu static 0.6; at most 5 % up to 0.2 g, by the upper end of the interval"
    )
    assert [row.found.value for row in answer.rows] == pytest.approx([0.5 * G, 0.4 * G])
    none = [*over(PEAK, 0.0, 0.0, 0.0, **{MU: 0.3}), *over(PEAK, 0.0, 0.0, 0.4, **{MU: 0.6})]
    assert ensemble_answer(result_of(*none)).sentence == (
        "peak acceleration: fewer than half of 128 draws overturned at every point; at most 5 % up to 0.4 g, by the "
        "upper end of the interval"
    )


def test_an_unfinished_ensemble_has_no_answer():
    assert ensemble_answer(result_of(*over(PEAK, 0.0, 0.4, 0.8), status="interrupted")) is None


def test_the_slip_is_named_and_what_slides_beyond_the_limit_does_not_stand():
    rows = [
        one | {"max_slip_m": slip}
        for one, slip in zip(over(PEAK, 0.0, 0.4, 0.8), (0.0, 0.064, 0.3), strict=True)
    ]
    half = "0.45 g (95 % interval 0.4 g to 0.5 g); at most 5 % up to 0.2 g, by the upper end of the interval"
    slid = "those that stood there slid up to 64 mm"
    assert (
        ensemble_answer(result_of(*rows)).sentence
        == f"peak acceleration: half of 128 draws overturned at {half}; {slid}"
    )
    limited = ensemble_answer(result_of(*rows, limit_slip_m=0.1)).sentence
    assert (
        limited == f"peak acceleration: half of 128 draws overturned or slid beyond 100 mm at {half}; {slid}"
    )
