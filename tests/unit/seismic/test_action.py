"""Spectra of EN 1998-1:2004 and of the German zones, against their tables; the given spectrum of a floor."""

from dataclasses import replace

import numpy as np
import pytest

from fem.seismic.action import (
    FloorSpectrum,
    SiteAction,
    SpectrumShape,
    eurocode_shape,
    german_shape,
    read_spectrum,
)
from fem.seismic.artificial import artificial_set
from fem.seismic.motion_set import check_set

PERIODS = np.array([0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0])
#: S_e/a_g at 5 % damping, evaluated by hand from (3.2) to (3.5) with tables 3.2 and 3.3, and d_g/a_g (3.12)
HORIZONTAL = {
    (1, "A"): "1 1.5 2 2.5 2.5 2.5 2 1.25 1 .6667 .5 .2222 .125 .02",
    (1, "B"): "1.2 1.8 2.4 3 3 3 3 1.875 1.5 1 .75 .3333 .1875 .03",
    (1, "C"): "1.15 1.5812 2.0125 2.4437 2.875 2.875 2.875 2.1562 1.725 1.15 .8625 .3833 .2156 .0345",
    (1, "D"): "1.35 1.8563 2.3625 2.8688 3.375 3.375 3.375 3.375 2.7 1.8 1.35 .6 .3375 .054",
    (1, "E"): "1.4 2.1 2.8 3.5 3.5 3.5 3.5 2.1875 1.75 1.1667 .875 .3889 .2188 .035",
    (2, "B"): "1.35 3.375 3.375 3.375 3.375 2.8125 1.6875 1.0547 .8438 .45 .2531 .1125 .0633 .01013",
    (2, "D"): "1.8 3.15 4.5 4.5 4.5 4.5 2.7 1.6875 1.35 .72 .405 .18 .1012 .0162",
}
#: S_ve/a_g, (3.8) to (3.11) with table 3.4
VERTICAL = {
    1: ".9 2.7 2.7 2.7 2.025 1.35 .81 .5062 .405 .18 .1013 .045 .0253",
    2: ".45 1.35 1.35 1.35 1.0125 .675 .405 .2531 .2025 .09 .0506 .0225 .0127",
}
#: a_g S, plateau, S_e(1 s) in zone 3 with gamma_I = 1.6 [m/s2]
GERMAN = {
    "A-R": (1.28, 3.2, 0.64),
    "B-R": (1.60, 4.0, 1.00),
    "C-R": (1.92, 4.8, 1.44),
    "B-T": (1.28, 3.2, 0.96),
    "C-T": (1.60, 4.0, 1.60),
    "C-S": (0.96, 2.4, 1.20),
}


def numbers(row: str) -> np.ndarray:
    return np.array([float(word) for word in row.split()])


def unit_action(kind: int, ground: str) -> SiteAction:
    return SiteAction(shape=eurocode_shape(kind, ground), reference_acceleration=1.0)


@pytest.mark.parametrize(("kind", "ground"), HORIZONTAL)
def test_horizontal_spectra_and_ground_displacement_follow_the_tables(kind, ground):
    action, expected = unit_action(kind, ground), numbers(HORIZONTAL[kind, ground])
    np.testing.assert_allclose(action.horizontal(PERIODS), expected[:-1], atol=5.1e-5)
    assert action.ground_displacement == pytest.approx(expected[-1], abs=5.1e-6)


@pytest.mark.parametrize(("kind", "ground"), [(1, "A"), (1, "D"), (2, "C"), (2, "E")])
def test_vertical_spectra_follow_the_table_on_every_ground(kind, ground):
    found = unit_action(kind, ground).vertical(PERIODS)
    np.testing.assert_allclose(found, numbers(VERTICAL[kind]), atol=5.1e-5)


@pytest.mark.parametrize(
    ("kind", "ground", "expected"),
    [(2, "A", (1.0, 0.05, 0.25, 1.2)), (2, "C", (1.5, 0.1, 0.25, 1.2)), (2, "E", (1.6, 0.05, 0.25, 1.2))],
)
def test_grounds_of_type_2_that_public_programs_confuse(kind, ground, expected):
    shape = eurocode_shape(kind, ground)
    assert (shape.soil_factor, *shape.corner_periods) == expected


@pytest.mark.parametrize("subsoil", GERMAN)
def test_german_zones(subsoil):
    action = SiteAction(shape=german_shape(subsoil, 0.5), reference_acceleration=0.8, importance_factor=1.6)
    found = action.horizontal(np.array([0.0, 0.15, 1.0]))
    np.testing.assert_allclose(found, GERMAN[subsoil], rtol=1e-12)
    vertical = action.vertical(np.array([0.0, 0.2, 2.0]))
    np.testing.assert_allclose(vertical, [0.64, 1.92, 0.192], rtol=1e-12)


def test_displacement_beyond_four_seconds_falls_to_that_of_the_ground():
    """Annex A: 2.5 d_g at T_E, d_g from 10 s on, linear between; the code rounds 1/(4 pi^2) to 0.025."""
    action = unit_action(1, "D")
    periods = np.array([4.0, 5.0, 6.0, 8.0, 10.0, 15.0])
    displacement = action.horizontal(periods) * (periods / (2.0 * np.pi)) ** 2
    exact = 2.5 * 1.35 * 0.8 * 2.0 / (4.0 * np.pi**2)
    np.testing.assert_allclose(displacement, [exact, exact, 0.135, 0.0945, 0.054, 0.054], rtol=1e-12)


def test_factors_multiply_the_reference_acceleration_of_a_spectrum_without_annex_a():
    shape = SpectrumShape(
        soil_factor=1.35,
        corner_periods=(0.1, 0.4, 2.0),
        vertical_ratio=0.7,
        vertical_corner_periods=(0.05, 0.2, 1.2),
    )
    factors = {"importance_factor": 1.2, "element_importance_factor": 1.5}
    action = SiteAction(shape=shape, reference_acceleration=1.6, **factors)
    found = (action.ground_acceleration, action.surface_acceleration, action.vertical_acceleration)
    assert found == pytest.approx((2.88, 2.88 * 1.35, 0.7 * 2.88))
    # its displacement stays constant
    assert action.horizontal(np.array([8.0]))[0] == pytest.approx(2.5 * found[1] * 0.4 * 2.0 / 64.0)
    with pytest.raises(ValueError, match=r"between 0\.5 and 2"):
        replace(action, importance_factor=2.1)
    with pytest.raises(ValueError, match="must rise"):
        replace(shape, corner_periods=(0.2, 0.1, 2.0))


@pytest.mark.parametrize(("kind", "ground"), [(1, "S1"), (2, "S2"), (1, "F"), (3, "A")])
def test_ground_that_has_no_spectrum_is_refused(kind, ground):
    with pytest.raises(ValueError, match=r"special study|has A, B|types 1 and 2"):
        eurocode_shape(kind, ground)


GROUND = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=1.6)
POINTS, VALUES = (0.03, 0.1, 0.4, 1.0, 2.0), (3.0, 4.0, 10.0, 4.0, 2.0)


def spectrum(**changes):
    return FloorSpectrum(**{"periods": POINTS, "accelerations": VALUES, "ground": GROUND} | changes)


def test_logarithms_are_straight_between_the_points_and_the_displacement_stays_beyond():
    target = spectrum()
    np.testing.assert_allclose(target.horizontal(np.array(POINTS)), VALUES)
    assert target.horizontal(np.array([0.2]))[0] == pytest.approx(np.sqrt(40.0))  # between 0.1 and 0.4 s
    np.testing.assert_allclose(target.horizontal(np.array([0.0, 0.01, 4.0])), [3.0, 3.0, 0.5])
    assert target.surface_acceleration == 3.0


def test_the_vertical_is_that_of_the_ground_unless_it_is_given():
    np.testing.assert_array_equal(spectrum().vertical(np.array(POINTS)), GROUND.vertical(np.array(POINTS)))
    given = spectrum(vertical_accelerations=(2.0, 5.0, 1.0, 0.5, 0.2))
    assert given.vertical(np.array([0.1]))[0] == pytest.approx(5.0)


def test_artificial_motions_fit_the_spectrum_of_a_floor_with_a_peak_at_the_period_of_the_building():
    target = spectrum(
        periods=(0.03, 0.2, 0.45, 0.5, 0.56, 1.0, 4.0), accelerations=(3.0, 5.0, 14.0, 16.0, 14.0, 4.0, 0.3)
    )
    found = check_set(artificial_set(target, count=3, seed=1), target)
    assert found.valid, found.reasons
    assert found.mean_peak == pytest.approx(3.0, rel=0.1)


@pytest.mark.parametrize(
    "changes",
    [
        {"periods": (0.1, 0.2, 0.4, 1.0, 2.0)},
        {"periods": (0.03, 0.1, 0.2, 0.3, 0.4)},
        {"periods": (0.03, 0.4, 0.1, 1.0, 2.0)},
        {"accelerations": (3.0, 4.0)},
        {"accelerations": (3.0, 0.0, 1.0, 1.0, 1.0)},
        {"vertical_accelerations": (3.0,)},
        {"periods": (), "accelerations": ()},
    ],
)
def test_points_that_are_no_spectrum_are_refused(changes):
    with pytest.raises(ValueError, match=r"must rise|belong together|positive|values and"):
        spectrum(**changes)


@pytest.mark.parametrize(
    "text",
    [
        "period_s,acceleration_m_s2\n1.5,1e-2\n3,1e-3\n",
        "period_s; acceleration_m_s2\r\n1,5;0,01\r\n3;0,001\r\n\r\n",
        "sep=|\nperiod_s|acceleration_m_s2\n1.5|0.01\n3|0.001\n",
    ],
)
def test_points_are_read_whatever_separates_them(tmp_path, text):
    path = tmp_path / "points.csv"
    path.write_bytes(text.encode("utf-8-sig"))
    assert read_spectrum(path) == {"period_s": (1.5, 3.0), "acceleration_m_s2": (0.01, 0.001)}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("period_s;acceleration_m_s2\n1,5;0.01\n", r"decimal commas \(line 2\) and decimal points"),
        ("period_s,acceleration_m_s2\n1.5,x\n", "line must hold 2 numbers"),
        ("period_s,acceleration_m_s2\n1.5,1,2\n", "line must hold 2 numbers"),
        ("period_s,acceleration_m_s2\n", "line must hold 2 numbers"),
        ("", "the file is empty"),
        ("period,sa\n0.1,2\n", "the first line"),
    ],
)
def test_points_that_are_none_are_refused(tmp_path, text, words):
    path = tmp_path / "points.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=words):
        read_spectrum(path)
