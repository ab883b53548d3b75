"""A site file: what it asks for, and the reasons why it cannot be used."""

import numpy as np
import pytest
from small_site import LEAST

from fem.case.validation import CaseError
from fem.site.request import SiteRequest, load_site

#: ground D with S_alpha,RP = 4.0 and S_beta,RP = 1.2 m/s2: 4.0 x 1.580 and 1.2 x 2.809, T_D = 1 + 1.2 s
SECOND = """spectrum = "second-generation"
plateau_m_s2 = 6.319
one_second_m_s2 = 3.370
end_periods_s = [0.02, 0.1, 2.2]
vertical_ratio = 0.7"""


def request(tmp_path, *changes: tuple[str, str]) -> SiteRequest:
    text = LEAST
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    place = tmp_path / "hall.toml"
    place.write_text(text)
    return load_site(place)


def test_topography_multiplies_the_action(tmp_path):
    flat, ridge = (
        request(tmp_path, ("= 1.6", f"= 1.6\ntopographic_factor = {factor}")).action for factor in (1.0, 1.4)
    )
    for one in ("surface_acceleration", "vertical_acceleration"):
        assert getattr(ridge, one) == pytest.approx(1.4 * getattr(flat, one))


def test_a_spectrum_of_the_second_generation_is_given_by_its_parameters(tmp_path):
    asked = request(tmp_path, ('ground = "D"\nreference_acceleration_m_s2 = 1.6', SECOND))
    periods = np.array([0.0, 0.02, 0.06, 0.1, 0.3, 1.0, 2.2, 3.0])
    plateau, one = 6.319, 3.370
    least = plateau / 2.5
    expected = [least, least, 0.5 * (least + plateau), plateau, plateau, one, one / 2.2, 2.2 * one / 9.0]
    assert asked.action.horizontal(periods).tolist() == pytest.approx(expected)
    assert asked.action.surface_acceleration == pytest.approx(2.528, abs=5e-4)
    assert asked.action.shape.corner_periods[1] == pytest.approx(0.533, abs=5e-4)
    np.testing.assert_allclose(asked.action.vertical(periods), 0.7 * np.array(expected))


def test_wind_pressures_come_from_a_table_or_a_terrain(tmp_path):
    zone = request(tmp_path, ("[limits]", "[wind]\ngerman_zone = 2\n[limits]"))
    assert zone.wind_pressure == (650.0, "simplified German pressure, zone 2, inland")
    terrain = request(tmp_path, ("[limits]", '[wind]\nterrain = "II"\nbasic_velocity_m_s = 25.0\n[limits]'))
    assert terrain.wind_pressure[0] == pytest.approx(703.3, abs=0.05)


@pytest.mark.parametrize(
    ("contents", "given", "factor"),
    [
        ("ordinary", "", 1.0),
        ("toxic", "", 1.5),
        ("explosive", "", 1.5),
        ("toxic", "1.8", 1.8),
        ("toxic", "1.2", None),
    ],
)
def test_contents_set_the_importance_factor_of_the_element(tmp_path, contents, given, factor):
    """EN 1998-1:2004, 4.3.5.3 (1): at least 1.5 for what is toxic or explosive."""
    key = given and f"\nelement_importance_factor = {given}"
    changes = ("= 1.6", f"= 1.6{key}"), ('"seed_stack"', f'"seed_stack"\ncontents = "{contents}"')
    if factor is None:
        with pytest.raises(CaseError, match=r"asks for 1\.5 at least"):
            request(tmp_path, *changes)
        return
    action = request(tmp_path, *changes).action
    assert action.element_importance_factor == factor
    assert action.ground_acceleration == pytest.approx(1.6 * factor)


def test_records_of_the_command_line_take_the_place_of_those_of_the_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "here").mkdir()
    path = tmp_path / "here" / "mine.toml"
    path.write_text(LEAST, encoding="utf-8")
    single = load_site(path, ["here/a.at2", "c.csv#2", "d.csv"])
    assert single.motions.files == [["a.at2"], [str(tmp_path / "c.csv#2")], [str(tmp_path / "d.csv")]]
    assert (single.motions.source, single.motions.vertical) == ("records", False)
    copy = tmp_path / "here" / "copy.toml"
    copy.write_text(single.origin.text, encoding="utf-8")  # as the results keep it
    assert load_site(copy).motions == single.motions
    pairs = load_site(path, ["here/a.at2,b.at2", "c.csv,d.csv", "e.csv, f.csv"])
    assert pairs.motions.files[0] == ["a.at2", str(tmp_path / "b.at2")]
    assert pairs.motions.vertical
    for few in (["a.at2,b.at2", "c.csv", "d.csv"], ["a.at2"]):
        with pytest.raises(CaseError, match="files"):
            load_site(path, few)
