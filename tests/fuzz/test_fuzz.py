"""A small set of the fuzz and of the soak, the same every time, for the suite; the large ones are scripts."""

from dataclasses import replace

import pytest
from data_inputs import BY_A_FILE, HOSTILE, NAMED, SIZES, SPECIAL, hostile, special
from fuzz import KINDS, warm_up
from fuzz import end_of as answer_to
from hypothesis import HealthCheck, given, settings
from inputs import FIELDS, LISTS, values_of, values_of_type
from random_cases import random_case
from soak import EXTREMES, end_of, extreme

from fem.case.tables.all_tables import TABLES
from fem.case.validation import known_keys
from fem.results.outcome import Outcome


@pytest.fixture(scope="module", autouse=True)
def compiled():
    warm_up()


COUNTS = {
    "text": 20,
    "mesh": 20,
    "table": 20,
    "record": 15,
    "hostile": 5,
    "case": 15,
    "option": 8,
    "folder": 3,
}


@pytest.mark.parametrize("share", [1, pytest.param(3, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("kind", "count"), COUNTS.items())
def test_any_input_is_refused_with_words_or_computed(kind, count, share):
    @settings(max_examples=share * count, derandomize=True, suppress_health_check=list(HealthCheck))
    @given(KINDS[kind][0])
    def feed(given_input):
        end = answer_to(given_input)
        assert not end.broken, end.words
        codes.add(end.code)

    codes = set()
    feed()
    # Some of it is wrong, and found to be; some of it is computed: of cases a half, of all else a fifth or less.
    assert codes >= ({0, 2} if kind == "case" else {2})


@pytest.mark.parametrize("name", HOSTILE)
def test_a_large_file_is_refused_as_soon_as_a_small_one(name):
    end = answer_to(hostile(name, SIZES[-2]))
    assert end.code == 2 and not end.broken, (end.cpu_s, end.words)


@pytest.mark.parametrize("name", NAMED)
def test_what_is_no_regular_file_is_refused_where_a_file_is_read(name):
    for kind in SPECIAL:
        end = answer_to(special(name, kind))
        assert end.code == 2 and not end.broken, (kind, end.cpu_s, end.words)
        assert name in end.words, kind


@pytest.mark.parametrize("name", BY_A_FILE)
def test_a_file_names_none_in_another_folder_by_a_link(name, tmp_path):
    (tmp_path / "secret").write_text("a word that no message may quote", encoding="utf-8")
    to_elsewhere = {name: lambda path: path.symlink_to(tmp_path / "secret")}
    end = answer_to(replace(special(name, "pipe"), made=to_elsewhere))
    assert end.code == 2 and name in end.words and "quote" not in end.words, end.words


def test_every_key_of_the_schema_is_fuzzed():
    assert {f"{table}.{key}" for table, model in TABLES.items() for key in known_keys(model)} <= set(FIELDS)
    for key in FIELDS:
        values_of(key, None).validate()


@pytest.mark.parametrize("name", LISTS)
def test_every_key_of_a_stop_a_tie_and_a_neighbour_is_fuzzed(name):
    seen = set()

    @settings(max_examples=100, derandomize=True, suppress_health_check=list(HealthCheck))
    @given(values_of_type(name, LISTS[name], None, None))
    def draw(rows):
        seen.update(*rows)

    draw()
    assert seen == set(known_keys(LISTS[name]))


def test_random_valid_cases_end_with_an_outcome_a_failure_or_a_refusal():
    ends = [end_of(lambda number=number: random_case(number, "rigid", 5.0)) for number in range(1, 17)]
    assert not [end for end in ends if end.startswith("BROKEN")]
    assert sum(not end.startswith(("failed", "refused")) for end in ends) > 8


@pytest.mark.parametrize("overrides", EXTREMES, ids=" ".join)
def test_an_extreme_is_computed_or_refused_with_a_reason(overrides):
    if "solver.duration_s=10000.0" in overrides:
        pytest.skip("a minute: by hand")
    end = end_of(lambda: extreme(overrides, "rigid"))
    assert end.startswith((*Outcome, "refused: "))
    assert end.startswith("refused: ") == ("[floor] " in end)  # nothing but a slab that gives way
