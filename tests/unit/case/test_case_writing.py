"""The resolved case: complete, exact, and the same whatever way it was written."""

import math
import pickle
import tomllib

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fem.case.case import CaseError, case_hash, load_case, read_case, to_toml
from fem.case.files import CASES
from fem.case.tables.all_tables import TABLES
from fem.case.template import case_template
from fem.case.toml import toml_value
from fem.case.validation import known_keys, quantity_of


@pytest.mark.parametrize("name", CASES.names)
def test_a_shipped_case_says_in_its_first_line_what_it_shows(name):
    assert CASES.text(name).startswith("# ")
    assert 40 < len(CASES.description(name)) < 130


@pytest.mark.parametrize("name", CASES.names)
def test_a_resolved_case_and_its_template_of_every_key_read_back_to_it(name):
    case = load_case(name)
    template = case_template(case)
    for again in map(read_case, (to_toml(case), template)):
        assert (again.resolved(), case_hash(again)) == (case.resolved(), case_hash(case))
        assert to_toml(again) == to_toml(case)
    for table in TABLES.values():
        for key in known_keys(table):
            assert (f"{key} = " if key != "box" else "[[container.box]]") in template


class TestHash:
    """The hash is that of the computation, not of the file."""

    @pytest.mark.parametrize(
        "change",
        [
            {"contact.mu_static": math.nextafter(0.4, 1.0)},
            {"gravity_m_s2": 9.80665},
            {"solver.model": "rigid"},
            {"output.fields_s": 0.0},
            {"static.soil_factor": 1.2},
            {"motion.phase_rad": 0.1},
        ],
    )
    def test_a_value_that_counts_changes_it(self, change):
        case = load_case("seed_stack")
        assert case_hash(case.with_values(change)) != case_hash(case)

    def test_the_content_of_a_motion_file_changes_it(self, tmp_path):
        text = CASES.text("seed_box").replace(
            'kind = "harmonic" ', 'kind = "table"\nfile = "floor.csv"\nquantity = "acceleration"\nunit = "g" '
        )
        record = tmp_path / "floor.csv"
        record.write_text("0,0\n1,0.1\n2,0\n", encoding="utf-8")
        first = case_hash(read_case(text, folder=tmp_path))
        assert first == case_hash(read_case(text, folder=tmp_path))
        record.write_text("0,0\n1,0.2\n2,0\n", encoding="utf-8")
        assert case_hash(read_case(text, folder=tmp_path)) != first
        record.unlink()
        with pytest.raises(CaseError, match="names no file"):
            case_hash(read_case(text, folder=tmp_path))


def test_every_key_of_the_template_may_be_uncommented():
    # Each commented key has an example that is of the right type and in range.
    data = tomllib.loads("\n".join(_uncommented(case_template(load_case("free_rocking")))))
    said = []
    for name, table in TABLES.items():
        for key, field in known_keys(table).items():
            quantity = quantity_of(field.annotation, field.metadata)
            value = data[name][key]
            numbers = value if isinstance(value, list) else [value]
            if quantity is not None and not isinstance(value, str) and not all(map(quantity.allows, numbers)):
                said.append(f"{name}.{key} = {value}")
    assert said == []


def _uncommented(template):
    for line in template.splitlines():
        commented = line.startswith("# [") or (line.startswith("# ") and " = " in line)
        yield line[2:] if commented else line


def test_a_case_survives_the_way_to_another_process():
    case = load_case("seed_box", ["contact.mu_static=0.5"])
    there = pickle.loads(pickle.dumps(case))
    assert there == case
    assert (there.name, there.text, there.overrides) == (case.name, case.text, case.overrides)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_float_reads_back_to_the_same_bits(value):
    (again,) = tomllib.loads(f"v = {toml_value(value)}").values()
    assert math.copysign(1.0, again) == math.copysign(1.0, value)
    assert again == value
    assert isinstance(again, float)


@given(st.text(alphabet=st.characters(exclude_categories=["Cs"])))
def test_a_text_reads_back_to_itself(value):
    assert tomllib.loads(f"v = {toml_value(value)}") == {"v": value}


FLOATS = {
    f"{table}.{key}": quantity
    for table, model in TABLES.items()
    for key, field in known_keys(model).items()
    if (quantity := quantity_of(field.annotation, field.metadata)) is not None
}
WITHOUT_GROUPS = sorted(
    set(FLOATS)
    - {
        f"motion.{key}"
        for key in ("amplitude_m", "peak_acceleration_m_s2", "angular_frequency_rad_s", "frequency_Hz")
    }
    - {"container.weight_N", "container.mass_kg", "container.density_kg_m3"}
)


@st.composite
def changes(draw):
    """Some keys, each with a value of its own range, or an integer where it is counted."""
    chosen = draw(st.lists(st.sampled_from(WITHOUT_GROUPS), max_size=6, unique=True))
    values = {}
    for key in chosen:
        quantity = FLOATS[key]
        low = next(bound for bound in (quantity.least, quantity.above, 0.0) if bound is not None)
        high = next(bound for bound in (quantity.most, quantity.below, 1e6) if bound is not None)
        if isinstance(quantity.least, int):
            values[key] = draw(st.integers(int(low), int(high)))
        else:
            values[key] = draw(st.floats(low, high).filter(quantity.allows))
    return values


@settings(max_examples=40)
@given(changes(), st.sampled_from(CASES.names))
def test_every_case_that_is_read_is_written_and_read_back(values, name):
    try:
        case = load_case(name).with_values(values)
    except CaseError:  # rules between keys: refused in words, which is all that is asked here
        assume(False)
    again = read_case(to_toml(case))
    assert again.resolved() == case.resolved()
    assert case_hash(again) == case_hash(case)
