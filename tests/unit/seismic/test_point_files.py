"""Files of points as spreadsheets write them."""

import pytest

from fem.seismic.point_files import read_points

NAMES = ("acceleration_m_s2", "rate")


@pytest.mark.parametrize(
    "text",
    [
        "acceleration_m_s2,rate\n1.5,1e-2\n3,1e-3\n",
        "acceleration_m_s2; rate\r\n1,5;0,01\r\n3;0,001\r\n\r\n",
        "sep=|\nacceleration_m_s2|rate\n1.5|0.01\n3|0.001\n",
    ],
)
def test_points_are_read_whatever_separates_them(tmp_path, text):
    path = tmp_path / "points.csv"
    path.write_bytes(text.encode("utf-8-sig"))
    assert read_points(path, [NAMES]) == dict(zip(NAMES, [(1.5, 3.0), (0.01, 0.001)], strict=True))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("acceleration_m_s2;rate\n1,5;0.01\n", r"decimal commas \(line 2\) and decimal points"),
        ("acceleration_m_s2,rate\n1.5,x\n", "line must hold 2 numbers"),
        ("acceleration_m_s2,rate\n1.5,1,2\n", "line must hold 2 numbers"),
        ("acceleration_m_s2,rate\n", "line must hold 2 numbers"),
        ("", "the file is empty"),
    ],
)
def test_points_that_are_none_are_refused(tmp_path, text, words):
    path = tmp_path / "points.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=words):
        read_points(path, [NAMES])
