"""The table [floor]: presets, what a case of a slab holds, and cases without one."""

import re
from pathlib import Path

import pytest
from cases import LEAST

from fem.case.case import case_from, case_hash, load_case, read_case, to_toml
from fem.case.tables import floors

UNITS = {"GPa": 1e9, "MPa": 1e6}
KEYS = (Path(floors.__file__).parents[1] / "keys.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", floors.PRESETS)
def test_the_value_of_a_preset_lies_in_the_range_that_is_told_and_has_a_source(name):
    preset = floors.PRESETS[name]
    (row,) = re.findall(rf'^\| `"{re.escape(name)}"` \| (.*) \|$', KEYS, flags=re.MULTILINE)
    modulus, poisson, strength = row.split(" | ")
    for cell, value in ((modulus, preset.youngs_modulus), (strength, preset.bearing_strength)):
        told, low, high = map(float, re.findall(r"[\d.]+", cell))
        assert low < told < high and told * UNITS[cell.split()[-1]] == pytest.approx(value)
    assert float(poisson) == preset.poisson_ratio and preset.source


def test_a_resolved_slab_has_the_numbers_of_its_preset_and_no_penalty():
    case = load_case("seed_stack", ["floor.preset=concrete C25/30", "floor.corner_patch_m=[0.008, 1.1]"])
    resolved = case.resolved()
    assert resolved["floor"] == {
        "kind": "slab",
        "preset": "concrete C25/30",
        "youngs_modulus_Pa": 31e9,
        "poisson_ratio": 0.2,
        "bearing_strength_Pa": 50e6,
        "corner_patch_m": [0.008, 1.1],
        "slope_percent": 0.0,
    }
    assert resolved["contact"].keys().isdisjoint({"normal_penalty_Pa_m", "tangential_ratio", "damping_ratio"})
    assert read_case(to_toml(case)).resolved() == resolved


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("concrete", "concrete C25/30"),
        ("C25/30", "concrete C25/30"),
        ("steel", "steel plate"),
        ("asphalt", "asphalt"),
    ],
)
def test_a_preset_alone_is_a_slab_by_its_full_or_short_name(name, meant):
    tables = load_case("seed_stack").given()
    tables["floor"] = {"preset": name}
    floor = case_from(tables).floor
    assert (floor.kind, floor.preset) == ("slab", meant)
    assert floor.youngs_modulus_Pa == floors.PRESETS[meant].youngs_modulus
    assert load_case("seed_stack", [f"floor.preset={name}"]).floor.preset == meant


def test_explicit_numbers_take_the_place_of_the_preset():
    keys = ["floor.preset=concrete C25/30", "floor.bearing_strength_Pa=25e6"]
    floor = load_case("seed_stack", keys).floor
    assert (floor.bearing_strength_Pa, floor.youngs_modulus_Pa, floor.density) == (25e6, 31e9, 2400.0)


def test_a_slab_has_its_own_damping_unless_one_is_given():
    slab = load_case("seed_stack", ["floor.preset=asphalt"])
    assert slab.contact_damping_ratio is None
    given = slab.with_values({"contact.damping_ratio": 2.0})
    assert given.contact_damping_ratio == 2.0
    assert given.resolved()["contact"]["damping_ratio"] == 2.0
    assert case_hash(given) != case_hash(slab)
    assert load_case("free_rocking").contact_damping_ratio == 2.0


def test_a_level_rigid_floor_is_no_part_of_a_resolved_case():
    plain, written = read_case(LEAST), read_case(LEAST + '[floor]\nkind = "rigid"\nslope_percent = 0\n')
    assert to_toml(written) == to_toml(plain)
    assert case_hash(written) == case_hash(plain)


def test_a_slope_is_part_of_a_rigid_floor():
    case = read_case(LEAST + "[floor]\nslope_percent = 1.5\n")
    assert case.resolved()["floor"] == {"kind": "rigid", "slope_percent": 1.5, "motion_along": "horizontal"}
    assert case.with_values({"floor.slope_percent": 0.0}).floor.motion_along is None
