"""Files of every format, written from one motion: all read to the same numbers, to the digits of the format.

Columns of numbers: what is understood; a file is read once as long as it stays as it is.
"""

import os
from pathlib import Path

import numpy as np
import pytest
from record_files import STEP, WRITTEN, synthetic_motion

from fem.records.files import read_record
from fem.records.record import RecordError

FIRST, SECOND, THIRD = synthetic_motion()
TIMES = STEP * np.arange(FIRST.size)


def read(folder, text, **options):
    path = folder / "motion.txt"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_record(path, **options)


def written(name):
    form = WRITTEN[name]
    values = FIRST[:2000] if form.centred else FIRST
    return form, values, form.text(values, SECOND, THIRD)


def first_of(record):
    return record.component("horizontal", quantity="acceleration", channel="1")


@pytest.mark.parametrize("name", WRITTEN)
def test_every_format_is_read_to_the_same_numbers(tmp_path, name):
    form, values, text = written(name)
    record = read(tmp_path, text, unit=form.unit, sample_interval=form.sample_interval)
    found = first_of(record)
    assert record.format == form.format and len(record.components) == form.components
    assert found.times == pytest.approx(TIMES[: values.size], abs=1e-12)
    upward = [record.component("vertical", quantity="acceleration")] if form.components > 1 else []
    for component, motion in zip([found, *upward], (values, THIRD[: values.size]), strict=False):
        expected = motion - motion.mean() if form.centred else motion
        assert np.abs(component.values - expected).max() < 1.01 * form.digits


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("\n", "\r\n").encode(),
        lambda text: text.encode("utf-16"),
        lambda text: text.encode("utf-8-sig"),
        lambda text: (text + "\n\n\x1a").encode(),
        lambda text: text.encode("latin-1"),
    ],
    ids=["CRLF", "UTF-16", "UTF-8 with a mark", "end of file of DOS", "Latin-1"],
)
@pytest.mark.parametrize("name", WRITTEN)
def test_encodings_and_line_ends_make_no_difference(tmp_path, name, change):
    form, values, text = written(name)
    text = text.replace("Nowhere", "Görlitz")
    found = first_of(read(tmp_path, change(text), unit=form.unit, sample_interval=form.sample_interval))
    assert found.times.size == values.size


@pytest.mark.parametrize(
    "name", [name for name, form in WRITTEN.items() if form.unit is None and form.format != "columns"]
)
def test_the_file_states_the_unit_and_its_user_may_not_state_another(tmp_path, name):
    form, _, text = written(name)
    found = first_of(read(tmp_path, text))
    assert found.unit_stated
    assert first_of(read(tmp_path, text, unit=found.unit)).values == pytest.approx(found.values)
    with pytest.raises(ValueError, match=f"the file states '{found.unit}', but unit = 'mm/s2' is given"):
        read(tmp_path, text, unit="mm/s2")
    words = f"sample_interval_s is for a file of one column, and this is a {form.format}"
    with pytest.raises(ValueError, match=words):
        read(tmp_path, text, sample_interval=0.01)


def cut_line(text):
    """Without the last line of numbers."""
    lines = text.rstrip("\n").split("\n")
    last = next(k for k in range(len(lines) - 1, 0, -1) if lines[k][-1].isdigit() and lines[k][:9].strip())
    return "\n".join(lines[:last] + lines[last + 1 :])


ROWS = ("columns", "JMA CSV", "AFAD", "ASA")  #: without a block of numbers
COUNTED = [
    name
    for name, form in WRITTEN.items()
    if form.format not in ROWS and form.unit is None and name != "K-NET CSV"
]


@pytest.mark.parametrize("name", ["AFAD", "ASA", "K-NET CSV"])
def test_rows_that_are_not_as_many_as_the_header_says_are_refused(tmp_path, name):
    text = written(name)[2].rstrip("\n")
    with pytest.raises(ValueError, match=r"the header (says \d+ values, found|gives a length of)"):
        read(tmp_path, text.rsplit("\n", 10)[0])
    with pytest.raises(ValueError, match=r"line \d+: [345] columns are needed as in .*, found 1"):
        read(tmp_path, text + "\n1.0")


@pytest.mark.parametrize("name", COUNTED)
def test_fewer_or_more_values_than_the_header_says_are_refused(tmp_path, name):
    _, _, text = written(name)
    with pytest.raises(ValueError, match=r"motion\.txt.*the header says"):
        read(tmp_path, cut_line(text))
    lines = text.rstrip("\n").split("\n")
    for end in (" 1.0", " 1.0\n 2.0 3.0"):
        if lines[-1][-1].isdigit():
            with pytest.raises(ValueError, match="the header says"):
                read(tmp_path, "\n".join(lines) + "\n" + end)


@pytest.mark.parametrize("name", COUNTED)
@pytest.mark.parametrize("wrong", ["x", "nan"])
def test_what_is_no_number_is_refused_with_its_line(tmp_path, name, wrong):
    _, _, text = written(name)
    lines = text.rstrip("\n").split("\n")
    last = next(k for k in range(len(lines) - 1, 0, -1) if lines[k][-1].isdigit())
    lines[last] = lines[last][: -len(wrong)] + wrong
    with pytest.raises(ValueError, match=f"line {last + 1}: not a number"):
        read(tmp_path, "\n".join(lines))


@pytest.mark.parametrize(
    "text",
    [
        "0,1.5\n0.5,-2\n1.25,3e0\n",
        "0;1.5\n0.5;-2\n1.25;3e0",
        "0 1.5\n0.5\t-2\n 1.25   +3.0D+00\n".replace("\t", "  "),
        "0\t1.5\n0.5\t-2\n1.25\t3.0d+00\n",
        "time,acceleration\n0,1.5\n0.5,-2\n1.25,3\n",
        "# a station\r\ntime_s;a_m_s2\r\n\r\n0;1.5\r\n0.5;-2 # the peak\r\n1.25;3.\r\n",
        "time (s)  acc (m/s^2)\n0 1.5\n0.5 -2\n1.25 3\n",
        "\ufefft [s], a [m/s²]\n0,1.5\n0.5,-2\n1.25,3\n",
        "0,1.5\r0.5,-2\r1.25,3\r",
        # decimal commas: between semicolons, tabs and blanks
        "Zeit;a\n0;1,5\n0,5;-2\n1,25;3\n",
        "Zeit\ta\n0,0\t1,5\n0,5\t-2,0\n1,25\t3,0\n",
        "0,0 1,5\n0,5 -2,0\n1,25 3,0\n",
        # several lines of header, in Latin-1 and UTF-16
        "Meßstation Görlitz\nZeit;a\ns;m/s²\n0;1,5\n0,5;-2\n1,25;3\n".encode("latin-1"),
        "Meßstation\r\nZeit\ta\r\n0,0\t1,5\r\n0,5\t-2,0\r\n1,25\t3,0\r\n".encode("utf-16"),
    ],
)
def test_two_columns_of_the_usual_forms_are_read(tmp_path, text):
    (found,) = read(tmp_path, text, unit="m/s2").components
    assert found.times.tolist() == [0.0, 0.5, 1.25]
    assert found.values.tolist() == [1.5, -2.0, 3.0]


@pytest.mark.parametrize(("unit", "factor"), [("g", 9.80665), ("gal", 0.01), ("cm/s2", 0.01)])
def test_values_are_taken_in_the_unit_that_is_given(tmp_path, unit, factor):
    found = first_of(read(tmp_path, "0,1.5\n0.5,-2\n", unit=unit))
    assert found.values == pytest.approx([1.5 * factor, -2.0 * factor], rel=1e-12)


def test_no_message_quotes_what_is_in_the_file(tmp_path):
    for text in ("secret\n0,1\nsecret,2\n", "root:secret:0\n", "1 secret\n", "secret,secret\n1,2,secret\n"):
        with pytest.raises(ValueError, match=r"motion\.txt") as found:
            read(tmp_path, text, unit="m/s2")
        assert "secret" not in str(found.value)


def test_files_of_the_kernel_that_never_end_are_taken_at_the_size_they_state():
    with pytest.raises(ValueError, match="the file is empty"):
        read_record(Path("/proc/self/status"))


def test_a_file_is_read_again_only_when_it_changed(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("0.0,1.0\n0.1,2.0\n")
    first = read_record(path, unit="g")
    assert read_record(path, unit="g") is first
    assert read_record(path, unit="m/s2") is not first
    path.write_text("0.0,1.0\n0.1,3.0\n")
    os.utime(path, ns=(1, 1))  # of the same size; a clock may be too coarse to tell two writings apart
    assert read_record(path, unit="g").components[0].readings[1] == 3.0
    path.unlink()
    with pytest.raises(RecordError, match="does not exist"):
        read_record(path, unit="g")
