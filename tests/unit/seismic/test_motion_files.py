"""Motions written for other programs and read back to the same bits."""

import numpy as np
import pytest

from fem.records.files import read_record
from fem.seismic.ground_motion import in_whole_g, write_at2, write_csv

GENERATOR = np.random.default_rng(7)
VALUES = in_whole_g(
    np.concatenate([GENERATOR.standard_normal(4000) * 10.0 ** GENERATOR.integers(-9, 2, 4000), [0.0]])
)


@pytest.mark.parametrize("step", [0.005, 0.01, 1.0 / 3.0])
def test_csv_and_at2_read_back_to_the_same_bits(tmp_path, step):
    write_csv(tmp_path / "a.csv", step, VALUES)
    write_at2(tmp_path / "a.at2", step, VALUES, "ARTIFICIAL, , MOTION 1, H")
    for name in ("a.csv", "a.at2"):
        (component,) = read_record(tmp_path / name).components
        assert component.times.tobytes() == (np.arange(VALUES.size) * step).tobytes()
        assert component.values.tobytes() == VALUES.tobytes()
    heading = (tmp_path / "a.at2").read_text().splitlines()[2:4]
    assert heading == ["ACCELERATION TIME SERIES IN UNITS OF G", f"NPTS= 4001, DT= {step!r} SEC"]


def test_rounding_to_a_number_in_g_is_no_more_than_that():
    values = GENERATOR.standard_normal(100_000)
    rounded = in_whole_g(values)
    np.testing.assert_allclose(rounded, values, rtol=4e-16)
    assert in_whole_g(rounded).tobytes() == rounded.tobytes()


def test_what_has_no_number_in_g_is_refused(tmp_path):
    values = GENERATOR.standard_normal(1000)
    assert (in_whole_g(values) != values).any()
    with pytest.raises(ValueError, match=r"9\.80665"):
        write_at2(tmp_path / "a.at2", 0.01, values, "A, B, C, H")
