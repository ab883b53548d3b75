"""Files of the spectrum of a floor as spreadsheets write them."""

import pytest

from fem.seismic.floor_spectrum import read_spectrum

NAMES = ("period_s", "acceleration_m_s2")


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
    assert read_spectrum(path) == dict(zip(NAMES, [(1.5, 3.0), (0.01, 0.001)], strict=True))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("period_s;acceleration_m_s2\n1,5;0.01\n", r"decimal commas \(line 2\) and decimal points"),
        ("period_s,acceleration_m_s2\n1.5,x\n", "line must hold 2 numbers"),
        ("period_s,acceleration_m_s2\n1.5,1,2\n", "line must hold 2 numbers"),
        ("period_s,acceleration_m_s2\n", "line must hold 2 numbers"),
        ("", "the file is empty"),
    ],
)
def test_points_that_are_none_are_refused(tmp_path, text, words):
    path = tmp_path / "points.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=words):
        read_spectrum(path)
