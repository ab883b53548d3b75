"""Inputs of every kind, the same ones every time; `FUZZ=100` tries a hundred times as many."""

import os
from dataclasses import replace

import pytest
from data_inputs import BY_A_FILE, HOSTILE, NAMED, SIZES, SPECIAL, hostile, special
from fuzz import KINDS, end_of
from hypothesis import HealthCheck, given, settings
from inputs import FIELDS, values_of
from random_cases import random_case

import fem
from fem.case.case import load_case
from fem.case.tables.all_tables import TABLES
from fem.case.validation import known_keys
from fem.model.model import build_model
from fem.results.outcome import Outcome
from fem.run.recorder import Recorder
from fem.run.simulation import simulate


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """Import and compile before the clocks run: an import that is interrupted leaves half a module behind."""
    for model in ("rigid", "reduced", "full"):
        built = build_model(load_case("seed_box", [f"solver.model={model}", "solver.duration_s=0.02"]))
        simulate(built, Recorder(built))


MANY = int(os.environ.get("FUZZ", "1"))
COUNTS = {"text": 20, "mesh": 20, "table": 20, "record": 15, "hostile": 5, "case": 15, "option": 8}


@pytest.mark.parametrize("share", [MANY, pytest.param(3 * MANY, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("kind", "count"), COUNTS.items())
def test_any_input_is_refused_with_words_or_computed(kind, count, share):
    @settings(max_examples=share * count, derandomize=True, suppress_health_check=list(HealthCheck))
    @given(KINDS[kind])
    def feed(given_input):
        end = end_of(given_input)
        assert not end.broken, end.words
        codes.add(end.code)

    codes = set()
    feed()
    # Some of it is wrong, and found to be; some of it is computed: of cases a half, of all else a fifth or less.
    assert codes >= ({0, 2} if kind == "case" else {2})


@pytest.mark.parametrize("name", HOSTILE)
def test_a_large_file_is_refused_as_soon_as_a_small_one(name):
    end = end_of(hostile(name, SIZES[-2]))
    assert end.code == 2 and not end.broken, (end.cpu_s, end.words)


@pytest.mark.parametrize("name", NAMED)
def test_what_is_no_regular_file_is_refused_where_a_file_is_read(name):
    for kind in SPECIAL:
        end = end_of(special(name, kind))
        assert end.code == 2 and not end.broken, (kind, end.cpu_s, end.words)
        assert name in end.words, kind


@pytest.mark.parametrize("name", BY_A_FILE)
def test_a_file_names_none_in_another_folder_by_a_link(name, tmp_path):
    (tmp_path / "secret").write_text("a word that no message may quote", encoding="utf-8")
    to_elsewhere = {name: lambda path: path.symlink_to(tmp_path / "secret")}
    end = end_of(replace(special(name, "pipe"), made=to_elsewhere))
    assert end.code == 2 and name in end.words and "quote" not in end.words, end.words


def test_every_key_of_the_schema_is_fuzzed():
    assert {f"{table}.{key}" for table, model in TABLES.items() for key in known_keys(model)} <= set(FIELDS)
    for key in FIELDS:
        values_of(key, None).validate()


def outcome_of(case):
    """What a case comes to, or why it comes to nothing."""
    try:
        run = fem.compute(case, band=False, margin=False)
    except ValueError as error:
        return f"refused: {error}"
    return run.verdict.outcome or f"failed: {run.result['error']}"


def test_random_valid_cases_end_with_an_outcome_a_failure_or_a_refusal():
    ends = [outcome_of(random_case(number, "rigid", 5.0)) for number in range(1, 17)]
    assert all(end in tuple(Outcome) or end.startswith(("refused: ", "failed: ")) for end in ends)
    assert sum(end in tuple(Outcome) for end in ends) > 8


BLOCK = ("container.section=solid", "container.density_kg_m3=2000.0")
AXES = {  # key -> its extremes, and what is set beside them
    "container.youngs_modulus_Pa": ((1e6, 1e13), ()),
    "container.width_m": ((0.02, 0.05, 5.0, 20.0), BLOCK),
    "container.boxes": ((1, 10, 50), ()),
    "contact.mu_static": ((0.0,), ("contact.mu_kinetic=0.0",)),
    "contact.mu_kinetic": ((0.4,), ("contact.mu_static=5.0",)),
    "motion.amplitude_m": ((0.0, 1e-6, 10.0), ()),
    "motion.frequency_Hz": ((0.01, 100.0), ("motion.amplitude_m=0.001",)),
    "solver.duration_s": ((1e-3, 100.0), ()),
    "container.wall_m": ((1e-6, 0.1, 0.49), ("container.wall_density_kg_m3=50.0",)),
    "support.kind": (("feet", "flat"), ()),
}
SHORT = ("solver.model=rigid", "solver.duration_s=2", "output.fields_s=0", "solver.element_size_m=0.5")


@pytest.mark.parametrize(
    ("key", "value", "beside"),
    [(key, value, beside) for key, (values, beside) in AXES.items() for value in values],
)
def test_an_extreme_is_computed_or_refused_with_a_reason(key, value, beside):
    end = outcome_of(load_case("seed_stack_plateau", (*SHORT, f"{key}={value}", *beside)))
    assert end in tuple(Outcome) or end.startswith("refused: ")
    assert end.startswith("refused: ") == ("[floor] " in end)  # nothing but a slab that gives way
