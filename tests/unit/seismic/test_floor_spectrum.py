"""The spectrum of a floor as a target: its points, what lies between and beyond them, what is refused."""

import numpy as np
import pytest

from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_set
from fem.seismic.floor_spectrum import FloorSpectrum, read_spectrum
from fem.seismic.motion_set import check_set

GROUND = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=1.6)
PERIODS, VALUES = (0.03, 0.1, 0.4, 1.0, 2.0), (3.0, 4.0, 10.0, 4.0, 2.0)


def spectrum(**changes):
    return FloorSpectrum(**{"periods": PERIODS, "accelerations": VALUES, "ground": GROUND} | changes)


def test_logarithms_are_straight_between_the_points_and_the_displacement_stays_beyond():
    target = spectrum()
    np.testing.assert_allclose(target.horizontal(np.array(PERIODS)), VALUES)
    assert target.horizontal(np.array([0.2]))[0] == pytest.approx(np.sqrt(40.0))  # between 0.1 and 0.4 s
    np.testing.assert_allclose(target.horizontal(np.array([0.0, 0.01, 4.0])), [3.0, 3.0, 0.5])
    assert target.surface_acceleration == 3.0
    # (3.6) at 10 %: sqrt(10/15)
    assert target.horizontal(np.array([0.4]), 0.1)[0] == pytest.approx(10.0 * np.sqrt(2.0 / 3.0))


def test_the_vertical_is_that_of_the_ground_unless_it_is_given():
    np.testing.assert_array_equal(spectrum().vertical(np.array(PERIODS)), GROUND.vertical(np.array(PERIODS)))
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
