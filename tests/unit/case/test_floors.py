"""The presets of the floor; what a case of one holds is in `said/cases.txt`."""

import re
from pathlib import Path

import pytest

from fem.case.tables import floors

UNITS = {"GPa": 1e9, "MPa": 1e6}
KEYS = (Path(floors.__file__).parents[1] / "keys.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", floors.PRESETS)
def test_the_value_of_a_preset_lies_in_the_range_that_is_told(name):
    preset = floors.PRESETS[name]
    (row,) = re.findall(rf'^\| `"{re.escape(name)}"` \| (.*) \|$', KEYS, flags=re.MULTILINE)
    modulus, poisson, strength = row.split(" | ")
    for cell, value in ((modulus, preset.youngs_modulus), (strength, preset.bearing_strength)):
        told, low, high = map(float, re.findall(r"[\d.]+", cell))
        assert low < told < high and told * UNITS[cell.split()[-1]] == pytest.approx(value)
    assert float(poisson) == preset.poisson_ratio
