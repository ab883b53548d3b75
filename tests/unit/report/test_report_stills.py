"""Stills of a report: the instants that this motion has, and no others."""

from dataclasses import replace

import numpy as np
import pytest

from fem.report.animation import Animation, AnimationFrame
from fem.report.stills import stills
from fem.results.history import History
from fem.results.run_result import Verdict

COUNT, ANGLE = 21, 0.268
TIMES = 0.1 * np.arange(COUNT)
ROTATION = 0.1 * np.sin(np.pi * TIMES)  # right at 0.5 s, left at 1.5 s
STIFF = np.zeros(COUNT)
SLIP = 0.02 * TIMES * (1.8 - TIMES)  # largest at 0.9 s, 16 mm
CORNERS = np.array([[-0.55, -2.0], [0.55, -2.0], [0.55, 2.0], [-0.55, 2.0]])


def animation(elastic=STIFF):
    return Animation(
        centroid=np.array([[0.0, 2.0]]),
        body=np.zeros(4, dtype=int),
        points=CORNERS,
        corners=np.array([[0, 1, 3, 2]]),
        rests=np.array([[-0.55, 0.0, 0.55, 4.0]]),
        quads=np.array([[0, 1, 2, 3]]),
        edges=np.array([[0, 1], [1, 2], [2, 3], [3, 0]]),
        contact=np.array([0, 1]),
        frames=[
            AnimationFrame(
                time=float(time),
                centre=np.array([[0.0, 2.0]]),
                rotation=np.array([rotation]),
                floor=(0.0, 0.0),
                elastic=np.full((4, 2), size),
                von_mises=None,
                normal_force=np.ones(2),
            )
            for time, rotation, size in zip(TIMES, ROTATION, elastic, strict=True)
        ],
    )


def history():
    empty = History.empty()
    values = np.zeros((COUNT, len(empty.numbers)))
    values[:, 0], values[:, empty.numbers.index("slip_m")] = TIMES, SLIP
    return replace(empty, values=values, modes=("rest",) * COUNT)


@pytest.mark.parametrize(
    ("verdict", "named"),
    [
        ({"outcome": "rest", "modes": ["rest"]}, ["start", "last frame"]),
        ({"outcome": "slide", "modes": ["rest", "slide"]}, ["start", "largest slip", "last frame"]),
        (
            {"outcome": "rock", "modes": ["rest", "rock"], "first_uplift_s": 0.15},
            [
                "start",
                "after the first uplift",
                "farthest to the right",
                "farthest to the left",
                "last frame",
            ],
        ),
        (
            {"outcome": "overturned", "modes": ["rock", "slide", "overturned"]},
            ["start", "farthest to the right", "largest slip", "farthest to the left", "last frame"],
        ),
    ],
)
def test_a_still_is_named_after_what_happened_and_only_that(verdict, named):
    shown = stills(animation(), history(), Verdict.from_json(verdict), angle=ANGLE, width=1.1, height=4.0)
    assert [still.caption.split(", ")[1].split(";")[0] for still in shown] == named


def test_a_still_tells_its_instant():
    shown = stills(animation(), history(), Verdict(outcome="rock"), angle=ANGLE, width=1.1, height=4.0)
    assert shown[1].caption == f"t = 0.500 s, farthest to the right; rotation ratio {0.1 / ANGLE:.3f}"
    assert shown[2].caption == f"t = 1.500 s, farthest to the left; rotation ratio −{0.1 / ANGLE:.3f}"


def test_a_still_of_an_impact_enlarges_the_deformation_less():
    elastic = np.full(COUNT, 1e-3)
    elastic[5] = 0.05
    shown = stills(animation(elastic), history(), Verdict(outcome="rock"), angle=ANGLE, width=1.1, height=4.0)
    assert shown[1].caption.endswith("; elastic part × 2")  # 0.14 m of 4 m
    assert "elastic" not in shown[2].caption
