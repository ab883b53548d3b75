"""The static calculation of a report can be redone with a pocket calculator, from the figures it prints."""

import math
import re

import pytest
from cases import named_case

from fem.model.geometry import build_container
from fem.model.motion import build_motions, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.report.static_sheet import static_sheet

CASES = ("seed_stack_plateau", "seed_box", "overturning", "sliding", "uneven")
ALONG = {"floor.slope_percent": 5.0, "floor.motion_along": "floor"}


def sheet_of(name, values=None):
    case = named_case(name, values)
    static = static_checks_of(case, build_container(case), *peaks_in_run(case, *build_motions(case)))
    return static_sheet(static, case)


def calculated(numbers):
    """What a calculator in degrees makes of printed numbers."""
    text = (
        numbers.replace("×", "*").replace("−", "-").replace("²", "**2").replace("√", "sqrt").replace("°", "")
    )
    text = re.sub(r"(\d)\s+(?=\d)", r"\1", text)
    words = {
        "sqrt": math.sqrt,
        "π": math.pi,
        "arctan": lambda x: math.degrees(math.atan(x)),
        "tan": lambda x: math.tan(math.radians(x)),
        "cos": lambda x: math.cos(math.radians(x)),
        "sin": lambda x: math.sin(math.radians(x)),
    }
    return eval(text, {"__builtins__": {}}, words)  # printed by our own program


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize(
    "slope",
    [{}, {"floor.slope_percent": -2.0}, ALONG, {"support.effective_width": 0.9}],
    ids=["level", "slope", "along", "inside"],
)
def test_every_line_gives_its_result_with_the_numbers_it_prints(name, slope):
    lines = [line for _, group in sheet_of(name, slope) for line in group]
    assert len(lines) >= 14
    for line in lines:
        printed = float(line.result.replace("−", "-"))
        assert calculated(line.numbers) == pytest.approx(printed, rel=6e-4, abs=6e-4), line.name


def test_the_stack_under_its_plateau_value_is_the_papers():
    # The paper, section 7, with g = 9.81: 40 kN against 39.24 kN, 80 kNm against 53.955 kNm.
    groups = dict(sheet_of("seed_stack_plateau"))
    own = {line.name: line for line in groups["Static rule under the peak floor acceleration of this run"]}
    assert own["base shear"].result == "40.00"
    assert own["utilisation, sliding"].value == pytest.approx(40.0 / 39.24, rel=1e-6)
    assert own["utilisation, overturning"].value == pytest.approx(80.0 / 53.955, rel=1e-6)
    assert own["utilisation, overturning"].verdict == "overturns"
    assert "EN 1998-1:2004, 4.4.2.4" in own["utilisation, overturning"].source
