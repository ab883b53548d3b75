"""Cases made and changed in a script: the same keys, the same checks, the same messages as a case file."""

import tomllib

import numpy as np
import pytest
from cases import LEAST

import fem
from fem.case.case import CaseError, case_hash, read_case, to_toml
from fem.case.recorded import recorded_motion
from fem.results.run_files import copy_data_files


def test_a_mapping_is_the_case_file_that_it_holds():
    case = fem.case_from(tomllib.loads(LEAST))
    assert case.resolved() == read_case(LEAST).resolved()
    assert case_hash(case) == case_hash(read_case(LEAST))
    assert read_case(case.text).resolved() == case.resolved()


def test_values_may_be_those_of_numpy():
    mapping = tomllib.loads(LEAST) | {"uncertainty": {"mu_kinetic": np.array([0.2, 0.4])}}
    mapping["container"] |= {"boxes": np.int64(2), "width_m": np.float32(1.5)}
    case = fem.case_from(mapping)
    assert (case.container.boxes, case.container.width_m, case.uncertainty.mu_kinetic) == (2, 1.5, [0.2, 0.4])
    (changed,) = (case.replace({"contact.mu_static": mu}) for mu in np.linspace(0.5, 0.5, 1))
    assert changed.contact.mu_static == 0.5
    assert type(changed.contact.mu_static) is float


def test_a_change_leaves_the_case_as_it_was_and_replaces_alternatives():
    case = fem.case_from(tomllib.loads(LEAST))
    lighter = case.replace({"container.mass_kg": 2000.0, "title": "lighter"})
    assert (lighter.box_mass, lighter.container.weight_N, lighter.title) == (2000.0, None, "lighter")
    assert (case.container.weight_N, case.title) == (24525.0, "")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fem.case_from({}), "case: [container] width_m is missing"),
        (lambda: fem.case_from(["container"]), "case_from: a mapping of tables is needed, got list"),
        (lambda: fem.compute("seed_box"), "a case from fem.load_case or fem.case_from is needed, got str"),
        (lambda: fem.compute_many(fem.load_case("seed_box")), "is needed, got tuple"),
        (
            lambda: fem.load_case("seed_box").replace({"contact.mu": 0.4}),
            "[contact] unknown key 'mu'; did you mean 'mu_static'?",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_the_words_of_the_command(make, words):
    with pytest.raises(CaseError) as refused:
        make()
    assert words in str(refused.value)
    assert isinstance(refused.value, ValueError)


def test_the_package_gives_away_its_interface_and_nothing_else():
    with pytest.raises(AttributeError, match="integrate your fragility curve"):
        fem.annual_rate  # noqa: B018
    for name in fem.__all__:
        assert getattr(fem, name).__doc__.strip()
        assert getattr(fem, name).__annotations__["return"]
    with pytest.raises(AttributeError, match="no attribute 'calculate'"):
        fem.calculate  # noqa: B018


TIMES = np.arange(0.0, 2.0, 0.01)
ALONG, UP = 3.0 * np.sin(5.0 * TIMES), 1.0 * np.sin(12.0 * TIMES)


def test_a_motion_may_be_given_by_arrays():
    case = read_case(LEAST).with_motion(TIMES, ALONG, UP)
    assert (case.motion.kind, case.vertical.kind) == ("table", "table")
    np.testing.assert_array_equal(recorded_motion(case, "motion").motion.values, ALONG)
    np.testing.assert_array_equal(recorded_motion(case, "vertical").motion.values, UP)
    assert case.replace({"motion.scale": 2.0}).recorded is case.recorded
    assert case.with_motion(TIMES, ALONG).vertical.kind == "none"
    assert case_hash(case) != case_hash(case.with_motion(TIMES, 2.0 * ALONG, UP))


def test_a_motion_given_by_arrays_is_written_as_a_file_that_reads_back_to_the_same_bits(tmp_path):
    case = read_case(LEAST).with_motion(TIMES / 3.0, ALONG, UP)
    copy_data_files(case, tmp_path)
    again = read_case(to_toml(case), folder=tmp_path)
    for table, values in (("motion", ALONG), ("vertical", UP)):
        found = recorded_motion(again, table).motion
        np.testing.assert_array_equal(found.values, values)
        np.testing.assert_array_equal(found.times, TIMES / 3.0)


@pytest.mark.parametrize(
    ("time", "along", "reason"),
    [
        (TIMES, ALONG[:-1], "200 times and 199 values"),
        (TIMES[::-1], ALONG, "times must increase"),
        (TIMES, ALONG * np.nan, "not a finite number"),
        (0.0, 1.0, "must be as many"),
    ],
)
def test_arrays_that_are_no_motion_are_refused(time, along, reason):
    with pytest.raises(CaseError, match=reason):
        read_case(LEAST).with_motion(time, along)
