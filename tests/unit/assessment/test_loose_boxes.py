"""What the summary says of a loose stack: its first line, its rows, the table of its boxes."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from fem.assessment.loose_boxes import box_rows, largest_joint_slip
from fem.assessment.rule_or_run import governing
from fem.assessment.summary import outcome_sentence, plain_summary
from fem.results import run_result
from fem.results.figures import BoxResult

STILL = BoxResult(max_rotation_rad=0.0, max_slip_m=0.0, residual_slip_m=0.0, max_opening_m=0.0, fell=False)
#: four boxes of 1.1 m x 1 m: slip counts from 0.11 mm, an opening from 3 mm
STATIC = run_result.StaticResult(centroid_m=2.0, slenderness_angle_rad=math.atan(0.55 / 2.0))


def result(*changed: tuple[int, dict], **verdict) -> run_result.RunResult:
    """Of a stack of four boxes, some of them changed."""
    boxes = [STILL] * 4
    for number, values in changed:
        boxes[number - 1] = replace(boxes[number - 1], **values)
    found = run_result.Verdict(**({"outcome": "slide-rock", "boxes": tuple(boxes)} | verdict))
    return run_result.RunResult(status="completed", verdict=found, static=STATIC)


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ([], "; the boxes moved as one."),
        ([(1, {"max_slip_m": 0.3, "max_opening_m": 0.2})], "; the boxes moved as one."),  # over the floor
        ([(3, {"max_slip_m": 1.0e-4, "max_opening_m": 2.9e-3})], "; the boxes moved as one."),
        ([(3, {"max_slip_m": 1.2e-3})], "; box 3 slid 1.20 mm on box 2."),
        ([(2, {"max_slip_m": 0.2194}), (4, {"max_slip_m": 0.1})], "; box 2 slid 219 mm on box 1."),
        (
            [(2, {"max_slip_m": 0.05}), (4, {"max_opening_m": 0.012})],
            "; box 2 slid 50.0 mm on box 1, box 4 opened 12.0 mm from box 3.",
        ),
    ],
)
def test_the_first_line_says_how_the_boxes_moved_on_one_another(changed, says):
    assert (
        outcome_sentence(result(*changed))
        == f"Result: slid, rocked and did not overturn under this motion{says}"
    )


def test_the_first_line_names_the_box_that_fell():
    fell = result(outcome="overturned", fell_box=4, overturned_at_s=4.21)
    assert outcome_sentence(fell) == "Result: box 4 fell at t = 4.210 s."
    below = result(outcome="overturned", fell_box=2, overturned_at_s=4.21)
    assert outcome_sentence(below) == "Result: box 2 fell at t = 4.210 s, with what stood on it."


def test_a_container_that_moves_as_one_body_has_no_boxes():
    text = plain_summary(result(boxes=None), folder=Path("outputs"))
    assert "Boxes" not in text and "between boxes" not in text and "largest slip of box 1" not in text


def test_the_table_has_a_row_a_box_from_the_floor_up():
    run = result(
        (2, {"max_slip_m": 0.2194, "residual_slip_m": -0.1}), (4, {"max_rotation_rad": 0.1, "fell": True})
    )
    lines = plain_summary(run, folder=Path("outputs")).splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("Boxes"))
    rows = [line.split() for line in lines[start + 4 : start + 8]]
    assert rows[1] == ["2", "0", "219", "-100", "0"]
    assert rows[3] == ["4", "5.73", "0", "0", "0", "fell"]


def test_the_figures_of_a_box_have_their_ranges_over_the_band():
    reach = run_result.BoxReach(
        max_rotation_rad=(0.0, 0.1),
        max_slip_m=(0.1, 0.25),
        residual_slip_m=(-0.3, 0.1),
        max_opening_m=(0.0, 0.0),
    )
    band = run_result.Band(
        boxes=(reach, reach, reach, replace(reach, fell=2)), members=(run_result.ChangedRun(status=""),) * 9
    )
    run = result((2, {"max_slip_m": 0.2194, "residual_slip_m": -0.1}), band=band)
    assert box_rows(run)[1] == ("2", "0 (0 to 5.7)", "220 (100 to 250)", "-100 (-300 to 100)", "0", "")
    assert box_rows(run)[3][-1] == "in 2 of 9 runs"
    assert largest_joint_slip(run.verdict) == ("220 (100 to 250) mm", "box 2 on box 1")
    text = plain_summary(run, folder=Path("outputs"))
    assert max(map(len, text.splitlines())) <= 80


def test_of_many_boxes_the_table_has_those_that_decide():
    boxes = [STILL] * 20
    boxes[7], boxes[11] = replace(STILL, max_slip_m=0.1), replace(STILL, fell=True)
    text = " ".join(plain_summary(result(boxes=tuple(boxes)), folder=Path("outputs")).split())
    assert "8 0 100 0 0" in text and "12 0 0 0 0 fell" in text and "17 more boxes are in run.json" in text


@pytest.mark.parametrize(
    ("on_floor", "words"),
    [
        (
            0.0,
            "The rule does not cover the joints between its boxes, where the run slid 36.5 mm (box 2 on box 1).",
        ),
        (0.01, "and the run slid; only the band can tell which of the two governs"),
    ],
)
def test_the_static_rule_is_that_of_the_stack_on_its_floor(on_floor, words):
    run = result((1, {"max_slip_m": on_floor}), (2, {"max_slip_m": 0.0365}), outcome="slide")
    rule = run_result.ActionResult(utilisation_sliding=0.765, utilisation_overturning=0.9)
    (said,) = governing(replace(run, static=replace(STATIC, own_motion=rule)))
    assert said.startswith("Sliding: the static rule holds at 0.765") and words in said
