"""A small set of the fuzz and of the soak, for the suite; the large ones are scripts."""

import extremes
import pytest
from fuzz import ALLOWED, fuzz, warm_up
from soak import end_of


@pytest.fixture(scope="module", autouse=True)
def compiled():
    warm_up()


@pytest.mark.parametrize(("kind", "count"), [("text", 60), ("mesh", 30), ("table", 20), ("case", 4)])
def test_damaged_input_is_refused_with_words_or_computed(kind, count):
    told: list[str] = []
    ends = fuzz(kind, range(count), told.append)
    assert set(ends) <= {str(code) for code in ALLOWED}, told
    assert ends["2"] > 0 or kind == "case"  # some of it is wrong, and found to be


def test_random_valid_cases_end_with_an_outcome_a_failure_or_a_refusal():
    ends = [end_of(number, "rigid", 5.0) for number in range(1, 31)]
    assert not [end for end in ends if end.startswith("BROKEN")]
    assert sum(not end.startswith(("failed", "refused")) for end in ends) > 20


@pytest.mark.parametrize("overrides", extremes.EXTREMES, ids=" ".join)
def test_an_extreme_is_computed_or_refused_with_a_reason(overrides):
    if "solver.duration_s=10000.0" in overrides:
        pytest.skip("a minute: by hand")
    assert extremes.end_of(overrides, "rigid").startswith(("completed", "overturned", "refused: "))
