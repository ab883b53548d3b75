"""What a file says of itself is read, or the file is refused: one test for each kind of slip that real files had."""

import numpy as np
import pytest
import record_files as files
from record_files import STEP, G, synthetic_motion

from fem.case.plausible import doubts
from fem.records.files import read_record
from fem.records.processing import Processing, processed
from fem.records.record import Component, RecordError

FIRST, SECOND, THIRD = (component[:401] for component in synthetic_motion(801))


def read(folder, text, **options):
    path = folder / "motion.txt"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_record(path, **options)


def directions(record):
    return [component.direction for component in record.components]


ROWS = "0,0.3\n0.05,0.8\n0.1,-0.8\n0.15,0.7\n0.2,0.5\n"


class TestColumnsThatAreNoMotion:
    """A first column that is no time, and a second one that is no motion, are refused with their names."""

    @pytest.mark.parametrize(
        ("heading", "words"),
        [
            ('"T(s)","Sae(g)"', "its first column is T, a period"),
            ('"T(s)","S<sub>ae</sub>(g)"', "its first column is T, a period"),
            ("Period (s),Sa (g)", "first column is period, a period"),
            ("period_s,acceleration_g", "first column is period, a period"),
            ("T,PSA [g]", "first column is T, a period"),
            ("frequency [Hz],a [g]", "first column is frequency, a frequency"),
            ("f,a [g]", "first column is F, a frequency"),
            ("freq_hz,acc_g", "first column is freq, a frequency"),
            ("No.,a [g]", "first column is No, a count"),
            ("sample,a [g]", "first column is sample, a count"),
            ("Index;a [g]", "first column is index, a count"),
            ("data point,a [g]", "first column is point, a count"),
            ("# sample, a (g)", "first column is sample, a count"),
            ("t [s],Sa [g]", "a period"),
            ("time [s],spectral acceleration [g]", "second column is spectral, a spectrum"),
            ("time (s),Fourier amplitude", "second column is fourier, a Fourier spectrum"),
            ("time,Arias intensity [m/s]", "second column is arias, an intensity"),
            ("time [s],strain [m]", "second column is strain, a strain or a force"),
            ("time [s],velocity", "names column 2 velocity, and 'g' measures acceleration"),
        ],
    )
    def test_they_are_refused_by_name(self, tmp_path, heading, words):
        rows = ROWS.replace(",", ";") if ";" in heading else ROWS
        unit = "g" if "velocity" in heading else None
        with pytest.raises(RecordError, match=words):
            read(tmp_path, f"{heading}\n{rows}", unit=unit)

    @pytest.mark.parametrize(
        "heading", ["time [h],a [g]", "t [Hz],a [g]", "Hz,g", "time (%),a (g)", "t [fortnights],a [g]"]
    )
    def test_a_unit_of_time_that_is_not_known_is_not_taken_as_seconds(self, tmp_path, heading):
        with pytest.raises(
            RecordError, match=r"the header gives times in .*; they must be in s, ms, us, min"
        ):
            read(tmp_path, f"{heading}\n{ROWS}")

    @pytest.mark.parametrize(
        ("unit", "factor"),
        [
            ("s", 1.0), ("sec", 1.0), ("ms", 1e-3), ("msec", 1e-3), ("milliseconds", 1e-3), ("µs", 1e-6),
            ("min", 60.0),
        ],
    )  # fmt: skip
    def test_times_in_other_units_are_converted(self, tmp_path, unit, factor):
        rows = "".join(f"{0.05 * k / factor!r},{k % 2}\n" for k in range(5))
        (found,) = read(tmp_path, f"time [{unit}],a [g]\n{rows}").components
        assert found.times == pytest.approx(0.05 * np.arange(5)) and found.time_stated

    @pytest.mark.parametrize(
        "heading", ["T [s],a [g]", "Zeit (s);a (g)", "Elapsed time (s),acc (g)", "sample time [s],acc [g]"]
    )
    def test_times_are_not_taken_for_anything_else(self, tmp_path, heading):
        rows = ROWS.replace(",", ";") if ";" in heading else ROWS
        (found,) = read(tmp_path, f"{heading}\n{rows}").components
        assert found.values == pytest.approx(G * np.array([0.3, 0.8, -0.8, 0.7, 0.5]))


class TestNumbersOfHeaders:
    """Every number is a whole word with the unit behind it; no part of one is taken."""

    @pytest.mark.parametrize(
        "header",
        [
            "NPTS=   401, DT= 0.5000D-02 SEC", "NPTS=   401, DT= 5.0 MSEC", "NPTS=401, DT=.005SEC",
            "DT= .0050 SEC, NPTS=   401", "NPTS  401  DT  .0050", "DT=0.005 NPTS=401", "   401   .0050   NPTS, DT",
            "401    0.0050", "NPTS: 401; DT: 5E-3 S", "   401    0.5D-02    NPTS, DT",
        ],
    )  # fmt: skip
    def test_peer_gives_number_and_interval_in_many_ways(self, tmp_path, header):
        text = files.peer(FIRST / G).replace("NPTS=  401, DT=   .0050 SEC", header)
        assert header in text
        (found,) = read(tmp_path, text).components
        assert found.step == pytest.approx(STEP) and found.times.size == 401
        assert found.values == pytest.approx(FIRST, abs=2e-6)

    @pytest.mark.parametrize(
        "header",
        [
            "NPTS= 401, DT= 1/200 SEC",
            "NPTS= 401, DT= .0050 HZ",
            "NPTS= 401, DT= .005x",
            "NPTS= 401, DT= 0,005",
        ],
    )
    def test_what_is_no_number_or_in_another_unit_is_refused(self, tmp_path, header):
        with pytest.raises(RecordError, match="interval of the samples"):
            read(tmp_path, files.peer(FIRST / G).replace("NPTS=  401, DT=   .0050 SEC", header))

    def test_other_formats_take_exponents_too(self, tmp_path):
        values = synthetic_motion(2000)[0]
        for text in (
            files.csmip_v2([(100.0 * FIRST, "Up")]).replace("at 0.005 sec", "at 5.0D-03 sec"),
            files.csmip_v1([(FIRST / G, "Up")]).replace("200 pts/sec", "2.0E+02 pts/sec"),
            files.esm(100.0 * FIRST).replace("0.005000", "5.0D-03"),
            files.knet(100.0 * values).replace("200Hz", "2.0E2 Hz"),
        ):
            assert read(tmp_path, text).components[0].step == pytest.approx(STEP)

    def test_the_scale_of_k_net_is_taken_whole(self, tmp_path):
        values = synthetic_motion(2000)[0]
        text = files.knet(100.0 * values)
        plain = read(tmp_path, text).components[0].values
        found = read(tmp_path, text.replace("3920(gal)", "3.92E+3(gal)")).components[0].values
        assert found == pytest.approx(plain) and np.abs(plain).max() == pytest.approx(
            np.abs(values).max(), rel=0.02
        )
        with pytest.raises(RecordError, match="no scale factor in gal"):
            read(tmp_path, text.replace("3920(gal)", "3,920(gal)"))


class TestDirectionsAndSigns:
    """A name is what it says after brackets, station and network are cut off."""

    @pytest.mark.parametrize(
        ("last", "direction", "sense"),
        [
            ("DWN (CDMG STATION 99999)", "vertical", -1), ("UP (CDMG STATION 99999)", "vertical", 1),
            ("090 (CDMG STATION 58373)", "horizontal", 1), ("E, (CWB)", "horizontal", 1), ("V, (CWB)", "vertical", 1),
            ("T", "horizontal", 1), ("L", "horizontal", 1), ("NIS090", None, 1), ("DOWN [USGS]", "vertical", -1),
        ],
    )  # fmt: skip
    def test_of_peer(self, tmp_path, last, direction, sense):
        record = read(tmp_path, files.peer(FIRST / G, last, old=True))
        (found,) = record.components
        assert found.direction == direction and record.event == "Nowhere-02"
        assert found.values == pytest.approx(sense * FIRST, abs=2e-6)
        assert bool(found.notes) == (sense < 0)

    @pytest.mark.parametrize(
        ("names", "found"),
        [
            (("NS", "UD"), ["horizontal", "vertical"]), (("UD", "NS"), ["vertical", "horizontal"]),
            (("NS", "DOWN"), ["horizontal", "down"]), (("N-S", "E-W"), ["horizontal", "horizontal"]),
            (("H1", "Z"), ["horizontal", "vertical"]), (("HN1", "HNZ"), ["horizontal", "vertical"]),
            (("acc_x", "acc_z"), ["horizontal", "vertical"]),
            (("horizontal_m_s2", "vertical_m_s2"), ["horizontal", "vertical"]),
            (("Horizontal", "Vertical"), ["horizontal", "vertical"]),
            (("one", "two"), [None, None]), (("", ""), ["horizontal", "vertical"]),
        ],
    )  # fmt: skip
    def test_of_three_columns(self, tmp_path, names, found):
        heading = f"Time [s],{names[0]} [m/s2],{names[1]} [m/s2]"
        record = read(tmp_path, files.columns([FIRST, THIRD], heading=heading))
        assert directions(record) == ["vertical" if one == "down" else one for one in found]
        for component, values, one in zip(record.components, (FIRST, THIRD), found, strict=True):
            assert component.values == pytest.approx(-values if one == "down" else values, abs=1e-6)
            assert bool(component.notes) == (one == "down")

    def test_two_horizontal_columns_are_no_vertical_one(self, tmp_path):
        record = read(tmp_path, files.columns([FIRST, SECOND], heading="t [s],NS [g],EW [g]"))
        with pytest.raises(RecordError, match=r"no vertical component \(#1 NS, horizontal"):
            record.component("vertical", quantity="acceleration")
        for heading in ("t [s],NS [g]", "t [s],090 (CDMG) [g]"):
            record = read(tmp_path, files.columns([FIRST], heading=heading))
            with pytest.raises(RecordError, match="no vertical component"):
                record.component("vertical", quantity="acceleration")

    def test_three_components_and_a_time_are_read_where_all_are_named(self, tmp_path):
        record = read(tmp_path, files.columns([FIRST, SECOND, THIRD], heading="t [s],EW [g],NS [g],UD [g]"))
        assert directions(record) == ["horizontal", "horizontal", "vertical"]
        for heading in ("t [s],a [g],v [m/s],d [m]", "t [s],a [g],b [g],c [g]"):
            with pytest.raises(RecordError, match="4 columns; a motion has one"):
                read(tmp_path, files.columns([FIRST, SECOND, THIRD], heading=heading))


class TestUnitsInComments:
    """Comment lines above the numbers are a header, too."""

    @pytest.mark.parametrize(
        ("comment", "unit"),
        [
            ("# Time (s), Acceleration (g)", "g"), ("% time [s]  acc [gal]", "gal"), ("// t_s, a_m_s2", "m/s2"),
            ("# units: cm/s2", "cm/s2"), ("# Kobe\n# dt = 0.005 s\n# Acceleration in units of g", "g"),
            ("ACCELERATION IN G", "g"), ("UNIT: CM/SEC/SEC", "cm/s2"),
            ("1999 Chi-Chi earthquake, acceleration in gal", "gal"),
            ("# acceleration time history in m/s^2", "m/s2"), ("Acceleration, gal", "gal"),
        ],
    )  # fmt: skip
    def test_they_are_stated(self, tmp_path, comment, unit):
        text = f"{comment}\n{files.columns([FIRST], mark=' ')}"
        (found,) = read(tmp_path, text).components
        assert (found.unit, found.unit_stated) == (unit, True)
        with pytest.raises(RecordError, match=f"the file states '{unit}', but unit = 'mm/s2' is given"):
            read(tmp_path, text, unit="mm/s2")

    def test_an_interval_is_stated_too(self, tmp_path):
        values = "".join(f"{value:.7f}\n" for value in FIRST)
        for comment in ("# dt = 0.005 s, units of g", "# dt: 5 ms; unit: g", "Sampling rate 200 Hz, unit g"):
            (found,) = read(tmp_path, f"{comment}\n{values}").components
            assert found.step == pytest.approx(STEP) and found.unit == "g"
            with pytest.raises(
                RecordError, match=r"states an interval of 0.005 s, but sample_interval_s = 0.01"
            ):
                read(tmp_path, f"{comment}\n{values}", sample_interval=0.01)


class TestWhatAFileStates:
    """Peaks, counts and lengths are compared with what was read."""

    def test_a_peak_that_contradicts_the_values_is_refused(self, tmp_path):
        values, peak = synthetic_motion(2000)[0], 100.0 * np.abs(FIRST).max()
        for text, stated, wrong in (
            (files.esm(100.0 * FIRST), f"{peak:.6f}", f"{0.1 * peak:.6f}"),
            (files.knet(100.0 * values), "Max. Acc. (gal)   ", "Max. Acc. (gal)   9"),
            (files.afad((100.0 * FIRST, 100.0 * SECOND, 100.0 * THIRD)), f"{peak:.6f}", f"{10.0 * peak:.6f}"),
            (files.csmnc(100.0 * FIRST), "PEAK VALUE: ", "PEAK VALUE: 9"),
        ):
            read(tmp_path, text)
            assert stated in text
            with pytest.raises(RecordError, match="the header states a peak of"):
                read(tmp_path, text.replace(stated, wrong, 1))

    @pytest.mark.parametrize(
        ("statement", "words"),
        [
            ("NPTS = 400", "the header says 400 values, found 401"),
            ("number of points: 999", "the header says 999 values, found 401"),
            ("dt = 0.01 s", "states an interval of 0.01 s, and the samples are 0.005 s apart"),
            ("PGA (cm/s2) = 58", "the header states a peak of 58"),
            ("PGA: 9 g", "the header states a peak of 9,"),
            ("duration 40 s", "the header gives a length of 40 s"),
        ],
    )
    def test_of_columns(self, tmp_path, statement, words):
        rows = files.columns([FIRST], heading="t [s],a [m/s2]")
        with pytest.raises(RecordError, match=words):
            read(tmp_path, f"# {statement}\n{rows}")
        true = ("NPTS = 401", "dt = 0.005 s", f"PGA = {np.abs(FIRST).max():.4f} m/s2", "duration 2 s")
        assert read(tmp_path, "".join(f"# {one}\n" for one in true) + rows).components[0].times.size == 401

    @pytest.mark.parametrize(
        ("first", "words"), [("401", "is the number of the values"), ("0.005", "is the interval")]
    )
    def test_a_count_or_interval_above_one_column_is_no_value(self, tmp_path, first, words):
        values = "".join(f"{value:.7f}\n" for value in FIRST)
        with pytest.raises(RecordError, match=rf"its first number {words}"):
            read(tmp_path, f"{first}\n{values}", unit="m/s2", sample_interval=0.005)

    def test_number_and_interval_in_a_line_are_read(self, tmp_path):
        for title in ("", "Kobe 1995\n", "1999 Chi-Chi\n"):
            text = f"{title}401 0.005\n" + "\n".join(files.rows([f"{value:12.7f}" for value in FIRST], 8))
            (found,) = read(tmp_path, text, unit="m/s2").components
            assert found.step == pytest.approx(0.005) and found.values == pytest.approx(FIRST, abs=1e-7)


class TestSpreadsheets:
    """CSV as spreadsheets write it is read by one reader, that of lists."""

    @pytest.mark.parametrize(
        "text",
        [
            "t [s];a [m/s2];\n0;0.1;\n0.01;-0.2;\n0.02;0.3;\n",
            "t [s],a [m/s2],,,\n0,0.1,,,\n0.01,-0.2,,,\n0.02,0.3,,,\n",
            '"t [s]","a [m/s2]"\n"0","0.1"\n"0.01","-0.2"\n"0.02","0.3"\n',
            '"t [s]","a [m/s2]"\n"0,00","0,1"\n"0,01","-0,2"\n"0,02","0,3"\n',
            "t [s];a [m/s2]\n0;0,1\n0,01;\u22120,2\n0,02;0,3\n", "sep=;\nt [s];a [m/s2]\n0;0.1\n0.01;-0.2\n0.02;0.3\n",
            "\ufeffsep=|\r\nt [s]|a [m/s2]|\r\n0|0.1|\r\n0.01|-0.2|\r\n0.02|0.3|\r\n",
        ],
    )  # fmt: skip
    def test_it_is_read(self, tmp_path, text):
        (found,) = read(tmp_path, text).components
        assert found.times == pytest.approx([0.0, 0.01, 0.02]) and found.unit_stated
        assert found.values == pytest.approx([0.1, -0.2, 0.3])


def judged(times, values, *, unit_stated=True, time_stated=True, baseline="none"):
    found = Component(times=times, readings=values, unit_stated=unit_stated, time_stated=time_stated)
    made = processed(found, Processing(baseline=baseline))
    return doubts("motion.txt", found, made, scale=1.0, confirmed=False)


class TestPlausibility:
    """One check of every motion; a sentence names the likely slip."""

    SHAKE = FIRST - FIRST.mean()
    TIMES = STEP * np.arange(401)

    def test_a_usual_motion_has_no_doubts(self):
        assert judged(self.TIMES, self.SHAKE, baseline="linear") == []

    @pytest.mark.parametrize(
        ("factor", "guess"), [(1e3, "0.005 s if its times are in ms"), (1 / 60, "if its times are in min")]
    )
    def test_an_interval_that_nobody_states_is_refused_outside_those_of_records(self, factor, guess):
        with pytest.raises(RecordError, match=rf"{guess}.*'t \[ms\]'"):
            judged(factor * self.TIMES, self.SHAKE, time_stated=False)
        if factor > 1.0:  # stated, it is what it does to the floor that is refused
            with pytest.raises(RecordError, match=r"the floor would move .* are its times in another unit"):
                judged(factor * self.TIMES, self.SHAKE)
        else:
            assert "those of records 0.0005 to 0.1 s" in judged(factor * self.TIMES, self.SHAKE)[0]

    def test_a_spectrum_without_words_pushes_the_floor_away(self):
        with pytest.raises(RecordError, match=r"have one sign, and the floor would move .* is it a spectrum"):
            judged(0.05 * np.arange(163), 8.0 * np.exp(-0.03 * np.arange(163)))

    def test_gravity_or_an_offset_is_refused_where_it_moves_the_floor_away(self):
        with pytest.raises(RecordError, match="the floor would move"):
            judged(0.02 * np.arange(401), 9.81 + np.sin(np.arange(401)))
        said = judged(self.TIMES, 2.0 + 2.5 * np.sin(np.arange(401)))
        assert any("the mean of its accelerations is" in note for note in said)

    def test_a_braking_truck_is_no_spectrum(self):
        times = 0.01 * np.arange(60)
        said = judged(times, np.interp(times, [0.0, 0.05, 0.35, 0.4], [0.0, 4.0, 4.0, 0.0]))
        assert said == ["its accelerations have one sign"]

    def test_a_peak_beyond_every_record_is_refused(self):
        for stated, peak in ((False, 35.0), (True, 70.0)):
            motion = peak * self.SHAKE / np.abs(self.SHAKE).max()
            with pytest.raises(RecordError, match="hardly any record reaches"):
                judged(self.TIMES, motion, unit_stated=stated)
