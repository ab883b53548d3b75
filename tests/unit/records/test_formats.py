"""Files of every format, written from one motion: all read to the same numbers, to the digits of the format."""

import re

import numpy as np
import pytest
import record_files as files
from record_files import STEP, WRITTEN, G, synthetic_motion

from fem.records.files import read_record

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


def horizontal(record):
    return record.component("horizontal", quantity="acceleration")


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
    with pytest.raises(
        ValueError, match=f"sample_interval_s is for a file of one column, and this is a {form.format}"
    ):
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
def test_a_header_without_data_is_refused(tmp_path, name):
    _, values, text = written(name)
    lines = text.split("\n")
    first = next(k for k, line in enumerate(lines) if str(values.size) in line or "Memo" in line)
    with pytest.raises(ValueError, match=r"motion\.txt"):
        read(tmp_path, "\n".join(lines[: first + 1]))


@pytest.mark.parametrize("name", COUNTED)
@pytest.mark.parametrize("wrong", ["x", "nan"])
def test_what_is_no_number_is_refused_with_its_line(tmp_path, name, wrong):
    _, _, text = written(name)
    lines = text.rstrip("\n").split("\n")
    last = next(k for k in range(len(lines) - 1, 0, -1) if lines[k][-1].isdigit())
    lines[last] = lines[last][: -len(wrong)] + wrong
    with pytest.raises(ValueError, match=f"line {last + 1}: not a number"):
        read(tmp_path, "\n".join(lines))


def test_the_fixtures_have_numbers_that_touch():
    for name in ("SMC", "COSMOS", "CSMIP V1", "CSMIP V2"):
        assert re.search(r"\d-\d[\d.]+-\d", written(name)[2].partition("points")[2] or written(name)[2]), name


class TestDirections:
    """Which component is vertical, and which sense is up."""

    @pytest.mark.parametrize(
        ("word", "direction", "sense"),
        [
            ("UP", "vertical", 1), ("DWN", "vertical", -1), ("V", "vertical", 1), ("000", "horizontal", 1),
            ("N90W", "horizontal", 1), ("TRANSVERSE", "horizontal", 1), ("HNZ", "vertical", 1), ("BOX", None, 1),
        ],
    )  # fmt: skip
    def test_peer_names_it_last(self, tmp_path, word, direction, sense):
        (found,) = read(tmp_path, files.peer(FIRST / G, word)).components
        assert found.direction == direction and found.name == word
        assert found.values == pytest.approx(sense * FIRST, abs=2e-6)

    def test_every_other_format_names_it_in_its_way(self, tmp_path):
        for text, direction in (
            (files.esm(FIRST, "HNZ"), "vertical"),
            (files.esm(FIRST, "HGN"), "horizontal"),
            (files.knet(FIRST[:2000], "U-D"), "vertical"),
            (files.knet(FIRST[:2000], "6"), "vertical"),
            (files.knet(FIRST[:2000], "4"), "horizontal"),
            (files.smc(FIRST, "UP"), "vertical"),
            (files.smc(FIRST, "90"), "horizontal"),
            (files.cosmos([(FIRST, 402)]), "vertical"),
            (files.cosmos([(FIRST, 360)]), "horizontal"),
            (files.cosmos([(FIRST, 700)]), "horizontal"),
            (files.csmip_v2([(FIRST, "Up")]), "vertical"),
            (files.csmip_v1([(FIRST, "360 Deg")]), "horizontal"),
        ):
            (found,) = read(tmp_path, text).components
            assert found.direction == direction, text[:200]

    @pytest.mark.parametrize(
        ("code", "comment", "direction"),
        [
            (0, "<SCNL>BMR.BNZ.AK.--", "vertical"),
            (0, "RcrdId: AK2018.AK.BMR.BNZ", "vertical"),
            (0, "<SCNL>BMR.BNE.AK.--", "horizontal"),
            (0, "none", "horizontal"),  # its name is "0 deg"
            (90, "<SCNL>BMR.BNZ.AK.--", None),
            (400, "<SCNL>BMR.HNZ.AK.--", "vertical"),
        ],
    )
    def test_cosmos_names_the_sensor_in_a_comment_too(self, tmp_path, code, comment, direction):
        (found,) = read(tmp_path, files.cosmos([(FIRST, code)], comment=comment)).components
        assert found.direction == direction

    def test_down_is_turned_upward(self, tmp_path):
        for text in (files.cosmos([(100.0 * FIRST, 401)]), files.smc(100.0 * FIRST, "DOWN")):
            (found,) = read(tmp_path, text).components
            assert found.values == pytest.approx(-FIRST, abs=1e-5)

    def test_two_horizontal_components_are_a_choice_of_the_user(self, tmp_path):
        record = read(tmp_path, files.csmip_v2([(FIRST, "90 Deg"), (SECOND, "360 Deg"), (THIRD, "Up")]))
        with pytest.raises(
            ValueError, match=r"2 components may be the horizontal one \(#1 90 Deg.*#2 360 Deg.*#3 Up"
        ):
            horizontal(record)
        for channel in ("2", "360 deg"):
            found = record.component("horizontal", quantity="acceleration", channel=channel)
            assert found.values == pytest.approx(0.01 * SECOND, abs=1e-7)
        assert record.component("vertical", quantity="acceleration").name == "Up"
        with pytest.raises(ValueError, match="no channel '4'"):
            record.component("horizontal", quantity="acceleration", channel="4")

    def test_a_vertical_component_is_no_horizontal_one(self, tmp_path):
        record = read(tmp_path, files.peer(FIRST, "UP"))
        with pytest.raises(ValueError, match=r"no horizontal component \(#1 UP"):
            horizontal(record)
        assert record.component("horizontal", quantity="acceleration", channel="1").name == "UP"


class TestQuantities:
    """Velocities do not move a floor; displacements do where they are asked for."""

    def test_velocities_are_refused(self, tmp_path):
        for text in (
            files.peer(FIRST, title="VELOCITY", unit="CM/S"),
            files.esm(FIRST, data_type="VELOCITY", unit="cm/s"),
            files.smc(FIRST, title="3 VELOCITY"),
        ):
            with pytest.raises(ValueError, match="it holds velocities, and accelerations are needed"):
                horizontal(read(tmp_path, text))

    def test_displacements_are_taken_as_such_only(self, tmp_path):
        record = read(tmp_path, files.peer(FIRST, title="DISPLACEMENT", unit="CM"))
        assert record.component("horizontal", quantity="displacement").values == pytest.approx(
            0.01 * FIRST, abs=1e-8
        )
        with pytest.raises(ValueError, match='set quantity = "displacement"'):
            horizontal(record)

    def test_a_unit_that_measures_something_else_is_refused(self, tmp_path):
        with pytest.raises(ValueError, match="accelerations in 'cm', which measures displacements"):
            read(tmp_path, files.peer(FIRST, unit="CM"))
        with pytest.raises(ValueError, match="in a unit that is not known"):
            read(tmp_path, files.esm(FIRST, unit="furlongs"))
        with pytest.raises(ValueError, match="the unit is 'g' by its code and 'cm/s2' by this line"):
            read(tmp_path, files.cosmos([(FIRST, 90)], code=2))

    def test_counts_and_spectra_are_refused(self, tmp_path):
        with pytest.raises(ValueError, match="raw counts are no motion"):
            read(tmp_path, files.cosmos([(FIRST, 90)], code=50, unit="counts"))
        with pytest.raises(ValueError, match="spectra do not move a floor"):
            read(tmp_path, files.smc(FIRST, title="5 RESPONSE SPECTRA"))
        with pytest.raises(ValueError, match="spectra do not move a floor"):
            read(tmp_path, "Response and Fourier Amplitude Spectra\n" + files.csmip_v2([(FIRST, "Up")]))


def test_a_length_that_is_not_that_of_the_samples_is_refused(tmp_path):
    text = files.cosmos([(FIRST, 90)]).replace(f"{FIRST.size * STEP:15.6f}", f"{99.0:15.6f}")
    with pytest.raises(ValueError, match=r"a length of 99 s, and 2003 samples 0.005 s apart take 10"):
        read(tmp_path, text)


@pytest.mark.parametrize("step", ["1e-300", "1e-9", "100.", "1e11"])
def test_an_interval_that_no_sensor_has_is_refused(tmp_path, step):
    with pytest.raises(ValueError, match="it must be between 1e-06 and 10 s"):
        read(tmp_path, files.peer(FIRST / G).replace(".0050", step))


@pytest.mark.parametrize(("name", "count"), [("PEER", "2003"), ("ESM", "NDATA: 2003")])
def test_a_count_is_believed_only_when_the_numbers_are_there(tmp_path, name, count):
    with pytest.raises(ValueError, match="999999999 as number of samples"):
        read(tmp_path, written(name)[2].replace(count, count.replace("2003", "999999999")))


def test_the_name_of_a_file_does_not_matter(tmp_path):
    path = tmp_path / "motion.v2"
    path.write_text(files.peer(FIRST / G))
    assert read_record(path).format == "PEER"


def test_headers_say_where_and_when(tmp_path):
    found = read(tmp_path, files.peer(FIRST / G))
    assert (found.event, found.station) == ("Nowhere-02", "Test Array #9")
    found = read(tmp_path, files.esm(FIRST))
    assert (found.event, found.station, found.date) == ("NOWHERE", "TST", "19990102")
    assert read(tmp_path, files.knet(FIRST[:2000])).station == "TST001"


@pytest.mark.parametrize(
    ("name", "key", "words"),
    [
        ("JMA", " UNIT  =", "the header has no UNIT, as JMA CSV has; write one component into a column"),
        ("JMA", " SAMPLING RATE=", "has no SAMPLING, as JMA CSV"),
        ("AFAD", "SAMPLING INTERVAL (sec) :", "the header has no SAMPLING INTERVAL, as AFAD"),
        ("ASA", "ORIENTACION", "the header has no ORIENTACION C1-C6, as ASA"),
        ("JMA", "gal(cm/s/s)", "in a unit that is not known"),
        ("ASA", "/0.005/0.005/", "its channels have different intervals"),
        (
            "K-NET CSV",
            "#Time,RelativeTime",
            "components in gal, as CSV of K-NET does; write one component into a",
        ),
        ("K-NET CSV", "SamplingFrequency(Hz)", "the header gives no sampling frequency"),
    ],
)
def test_a_national_format_that_lacks_a_key_is_refused_by_name(tmp_path, name, key, words):
    text = written(name)[2]
    assert key in text
    with pytest.raises(ValueError, match=re.escape(words)):
        read(tmp_path, text.replace(key, "/0.005/0.01/" if key.startswith("/") else "X "))


def test_a_borehole_of_kik_net_has_six_sensors(tmp_path):
    record = read(tmp_path, files.knet_csv([100.0 * FIRST[:2000]] * 6))
    directions = ["horizontal", "horizontal", "vertical"] * 2
    assert [component.direction for component in record.components] == directions
    assert record.station == "TST001"
    with pytest.raises(ValueError, match=r"4 components may be the horizontal one \(#1 1, horizontal"):
        horizontal(record)
    with pytest.raises(ValueError, match="its times contradict the sampling frequency"):
        read(
            tmp_path,
            files.knet_csv([100.0 * FIRST[:2000]] * 3).replace("#200\n", "#100\n").replace("#10\n", "#20\n"),
        )


def test_smc_of_type_0_does_not_say_what_it_holds(tmp_path):
    text = files.smc(100.0 * FIRST, title="0 UNKNOWN")
    with pytest.raises(
        ValueError, match="an SMC file of type 0 does not say what its values are; state it as unit"
    ):
        read(tmp_path, text)
    (found,) = read(tmp_path, text, unit="cm/s2").components
    assert found.values == pytest.approx(FIRST, abs=1e-7) and not found.unit_stated
