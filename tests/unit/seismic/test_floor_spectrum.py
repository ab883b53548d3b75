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
    ("changes", "words"),
    [
        ({"periods": (0.1, 0.2, 0.4, 1.0, 2.0)}, "0.05 s or less"),
        ({"periods": (0.03, 0.1, 0.2, 0.3, 0.4)}, "to 1 s or more"),
        ({"periods": (0.03, 0.4, 0.1, 1.0, 2.0)}, "must rise"),
        ({"accelerations": (3.0, 4.0)}, "5 values and acceleration_m_s2 2"),
        ({"accelerations": (3.0, 0.0, 1.0, 1.0, 1.0)}, "positive"),
        ({"vertical_accelerations": (3.0,)}, "vertical_acceleration_m_s2 1"),
        ({"periods": (), "accelerations": ()}, "positive|rise"),
    ],
)
def test_points_that_are_no_spectrum_are_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        spectrum(**changes)


def test_a_file_holds_its_columns(tmp_path):
    place = tmp_path / "floor.csv"
    place.write_text("period_s,acceleration_m_s2\n0.03,3\n4,0.5\n")
    assert read_spectrum(place) == {"period_s": (0.03, 4.0), "acceleration_m_s2": (3.0, 0.5)}
    place.write_text("\ufeffperiod_s, acceleration_m_s2\r\n0.03, 3\r\n\r\n4,0.5\r\n", encoding="utf-8")
    assert read_spectrum(place) == {"period_s": (0.03, 4.0), "acceleration_m_s2": (3.0, 0.5)}
    for text, words in (
        ("", "the file is empty"),
        ("period,sa\n0.1,2\n", "the first line"),
        ("period_s,acceleration_m_s2\n0.1\n", "2 numbers"),
        ("period_s,acceleration_m_s2\n0.1,x\n", "2 numbers"),
        ("period_s,acceleration_m_s2\n", "2 numbers"),
    ):
        place.write_text(text)
        with pytest.raises(ValueError, match=words):
            read_spectrum(place)
