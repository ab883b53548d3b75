"""A hall of containers: what a list may look like, what its rows show, and that each is the run by itself."""

import csv
import io
import json
import shlex

import pytest
from small_sweep import rows_of

from fem.__main__ import main
from fem.case.case import load_case
from fem.case.validation import CaseError
from fem.html.units import typeset
from fem.results.figures import SCALARS
from fem.results.level import STANDING, Level
from fem.run.compute import compute
from fem.study.hall import run_hall, weakness
from fem.study.hall_file import read_hall
from fem.study.hall_result import FALLS, GRAVEST
from fem.study.table import table_text

BASE = """
[container]
width_m = 1.0
height_m = 3.0
mass_kg = 2000.0
[contact]
mu_static = 0.5
[motion]
kind = "pulse"
shape = "sine"
peak_acceleration_m_s2 = 5.0
pulse_s = 1.0
[solver]
model = "rigid"
duration_s = 4.0
[uncertainty]
draws = 2
"""
LIST = """name,count,tag,width_m,mass_kg,mu_static,owner
A,2,north,1.0,2000,0.5,ACME
=B,1,north,0.6,2000,,
bad,1,south,-1,2000,,
C,3,south,1.0,2000.0,0.5,x
D,1,,2.4,,0.2,y
"""


@pytest.fixture
def base(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "base.toml"
    path.write_text(BASE, encoding="utf-8")
    return path


def listed(tmp_path, text, name="hall.csv", encoding="utf-8"):
    path = tmp_path / name
    path.write_bytes(text.encode(encoding))
    return path


def _hall_of(tmp_path, text, **options):
    """The result of a list, whose margins are not asked for by default."""
    options = {"checks": "none"} | options
    return run_hall(read_hall(listed(tmp_path, text)), load_case("base.toml"), tmp_path / "out", **options)


def test_a_row_is_the_run_by_itself_bit_for_bit(tmp_path, base, capsys):
    command = ["batch", str(listed(tmp_path, LIST)), "--case", "base.toml", "--out", "out", "-q"]
    assert main([*command, "--margins", "none"]) == 0
    said = capsys.readouterr().out
    assert "1 row was refused" in said and "refused    1 of 5 rows" in said
    found = json.loads((tmp_path / "out" / "hall.json").read_text(encoding="utf-8"))
    assert (found["rows"], found["containers"], found["distinct"], found["refused"]) == (5, 8, 3, 1)
    assert found["kept"] == ["owner"] and found["runs"] == 3
    texts = rows_of(tmp_path / "out" / "hall.csv")
    assert [one["name"] for one in texts] == ["A", "'=B", "bad", "C", "D"]
    assert [one["owner"] for one in texts] == ["ACME", "", "", "x", "y"]
    assert [one["status"] for one in texts] == [*["overturned"] * 2, "refused", "overturned", "completed"]
    assert "[container] width_m must be" in texts[2]["reason"] and "--set" not in texts[2]["reason"]
    for row, text in zip(found["table"], texts, strict=True):
        if row["status"] == "refused":
            assert not row["outcome"] and not row["rank"]
        if row["name"] not in "=BD":  # the others are of one container
            continue
        *_, case = words = shlex.split(row["command"])[:5]
        assert words[:4] == ["python", "-m", "fem", "run"] and case == "base.toml"
        alone = compute(load_case(case, shlex.split(row["command"])[6::2]), band=False).verdict
        for name in SCALARS:
            assert row[name] == getattr(alone, name), name
            if isinstance(row[name], float):
                assert text[name] == f"{row[name]:.4g}"
        assert row["card"].split(" | ") == [*alone.card] and text["first_line"] == alone.card[0]
    ranks = {row["name"]: row["rank"] for row in found["table"]}
    assert ranks == {"=B": 1, "A": 2, "C": 2, "D": 3, "bad": None}
    tags = {one["tag"]: one["counts"] for one in found["tags"]}
    assert (tags["north"]["overturned"], tags["south"]["overturned"], tags["south"]["refused"]) == (3, 3, 1)
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "7 of 7" not in page and "6 of 7 containers overturned" in page and 'href="#row-2"' in page
    assert main(["report", "out", "-q"]) == 0
    assert main(["report", "out", "--short", "--to", "short.html", "-q"]) == 0
    short = (tmp_path / "short.html").read_text(encoding="utf-8")
    assert "6 of 7 containers overturned" in short and len(short) < len(page) and "row-2" not in short


def test_the_weakest_rows_are_as_sure_and_have_the_margin_of_the_run_by_itself(tmp_path, base):
    (row,) = _hall_of(tmp_path, "name,width_m\na,1\n", checks="weakest").table
    alone = compute(load_case(base)).verdict
    assert row["sure"] == alone.sure and row["decided_by"] == (" ".join(alone.decided_by) or None)
    found = alone.margin
    assert (row["margin"], row["margin_low"], row["margin_high"]) == (found.factor, found.low, found.high)
    assert row["margin_governs"] == found.governing.factor


def test_a_list_in_which_only_variations_overturn_says_so_first(tmp_path, base):
    result = _hall_of(tmp_path, "name,width_m\nsafe,1.2\ntight,1.08\n", checks="all")
    first, second = result.ranked
    assert (first["name"], first["outcome"], first["does"]) == ("tight", "rock", "may overturn")
    assert first["card"].startswith("May overturn")
    assert first["margin_governs"] < 1.0 < second["margin_governs"]
    assert "none of 2 containers overturned; 1 may overturn: variations of its inputs do" in result.answer


def test_motions_that_destroy_a_corner_are_counted_by_themselves_and_are_worse_than_those_without_an_outcome(
    tmp_path, base
):
    motions = tuple(f"{number}.csv" for number in range(6))
    for number, name in enumerate(motions):
        samples = [f"{0.1 * k},{0.5 * (k % 2)}" for k in range(5 + number)]
        listed(tmp_path, "\n".join(["time_s,acceleration_m_s2", *samples]), name)
    runs = tmp_path / "out" / "runs.csv"
    _hall_of(tmp_path, "name,width_m\na,3\n", motions=motions)
    rows = rows_of(runs)
    for row, outcome in zip(rows, ["rock", "", "invalid", "", "invalid", ""], strict=True):
        row |= {"status": "completed" if outcome else "failed", "outcome": outcome}
    runs.write_text(table_text(rows[0], (row.values() for row in rows)), encoding="utf-8")
    (row,) = _hall_of(tmp_path, "name,width_m\nb,3\n", motions=motions).table
    assert (row["name"], row["outcome"], row["motion"]) == ("b", "invalid", "2.csv")
    counts = (row["motions_overturned"], row["motions_invalid"], row["motions_failed"])
    assert counts == (0, 2, 3)


def test_of_what_stands_the_larger_rotation_is_weaker_and_what_does_not_rock_follows_the_static_rule():
    rows = [
        {"status": "completed", "outcome": outcome, "rotation_ratio": ratio, "utilisation_overturning": use}
        for outcome, ratio, use in [
            ("rest", 0.001, 0.8),
            ("rock", 0.02, 1.2),
            ("rest", 0.005, 0.9),
            ("rock", 0.95, 1.1),
            ("invalid", 0.3, 1.0),
            ("overturned", 1.0, 1.0),
        ]
    ]
    assert sorted(range(6), key=lambda row: weakness(rows[row])) == [5, 4, 3, 1, 2, 0]


FLOOR = '[floor]\npreset = "concrete C25/30"\ncorner_patch_m = [0.3, 0.5]\n[limits]\nslip_m = 0.05\n'
OF_ALL_KINDS = (
    "name,width_m,height_m,mass_kg,mu_static,floor.bearing_strength_Pa\nrests,2,2,9000,0.9,\nrocks,2,6,24000,0.9,\n"
    "slides,2,2,9000,0.45,\nleaves,2,2,9000,0.2,\ndestroyed,2,6,24000,0.9,1.9e6\nfalls,0.8,6,24000,0.9,\n"
)


def test_the_gravest_stands_first_with_the_card_of_its_run(tmp_path, base, capsys):
    base.write_text(BASE + FLOOR)
    command = ["batch", str(listed(tmp_path, OF_ALL_KINDS)), "--case", "base.toml", "--margins", "none", "-q"]
    assert main([*command, "--out", "out", "--set", "motion.pulse_s=0.7"]) == 0
    said = capsys.readouterr().out
    table = json.loads((tmp_path / "out/hall.json").read_text())["table"]
    ranked = sorted(table, key=lambda row: row["rank"])
    assert [row["name"] for row in ranked] == ["falls", "destroyed", "leaves", "rocks", "slides", "rests"]
    assert [row["does"] for row in ranked] == [
        *FALLS[:2],
        Level.LEAVES,
        *[*STANDING.values()][:2],
        GRAVEST[-1],
    ]
    texts = {row["name"]: row for row in rows_of(tmp_path / "out" / "hall.csv")}
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    for row in ranked:
        alone = compute(load_case("base.toml", shlex.split(row["command"])[6::2]), band=False).verdict
        first = alone.card[0].replace(f", {alone.invalid_reason}", "")
        assert row["card"].split(" | ") == [first, *alone.card[1:]]
        assert first in said and texts[row["name"]]["first_line"] == first
        assert f"<strong>{row['name']}</strong>: {typeset(first)}" in page
    assert "1 left its place by" in said and "beyond the limit, 50.0 mm; it stands" in ranked[2]["card"]


def test_equal_rows_are_computed_once_and_labels_cost_nothing(tmp_path, base):
    """A list of which names alone changed is written again from the runs that are there."""
    text = "name,width_m,boxes\na,1,1\nb,1.00,\nc,,\nd,1.5,1\n"
    result = _hall_of(tmp_path, text)
    assert (result.distinct, result.runs, result.checked) == (2, 2, 0)
    again = _hall_of(tmp_path, text.replace("a,", "renamed,"))
    assert [row["name"] for row in again.table] == ["renamed", "b", "c", "d"]
    assert len((tmp_path / "out" / "runs.csv").read_text(encoding="utf-8").splitlines()) == 3
    assert rows_of(tmp_path / "out" / "hall.csv")[0]["name"] == "renamed"


def test_under_several_motions_the_worst_governs_and_the_largest_slip_is_told(tmp_path, base):
    for name, half, peak in (("weak", 3, 2.0), ("strong", 8, 9.0), ("middle", 5, 2.5)):
        samples = [
            f"{0.1 * k},{peak if 1 <= k <= half else -peak if half < k <= 2 * half else 0.0}"
            for k in range(20)
        ]
        listed(tmp_path, "\n".join(["time_s,acceleration_m_s2", *samples]), f"{name}.csv")
    text = "name,width_m,mu_static\nwide,3,0.3\nslim,0.8,0.9\n"
    motions = ("weak.csv", "strong.csv", "middle.csv")
    result = _hall_of(tmp_path, text, motions=motions)
    assert (result.runs, result.motions) == (6, motions)
    wide, slim = result.table
    found = slim["outcome"], slim["motions_overturned"], slim["motion"]
    assert found == ("overturned", 1, "strong.csv")
    assert wide["largest_slip_motion"] == "strong.csv" and wide["largest_slip_m"] >= wide["max_slip_m"] > 0.1
    assert (slim["rank"], wide["rank"]) == (1, 2)
    words = shlex.split(slim["command"])
    assert words[5:7] == ["--motion", "strong.csv"]
    alone = compute(load_case("base.toml", words[8::2], motion="strong.csv"), band=False).verdict
    assert slim["rotation_ratio"] == alone.rotation_ratio
    for pairs in (("strong.csv,weak.csv", "middle.csv"), ("strong.csv", "weak.csv,middle.csv")):
        result = _hall_of(tmp_path, text, motions=pairs, force=True)
        words = shlex.split(result.table[0]["command"])
        kind = "table" if "," in pairs[0] else "none"
        assert words[6] == "strong.csv" and words[8] == f"vertical.kind={kind}"
        alone = compute(load_case("base.toml", words[8::2], motion=words[6]), band=False).verdict
        assert result.table[0]["max_slip_m"] == alone.max_slip_m


def test_another_height_under_the_stated_mass_centre_of_the_case_is_a_bad_row(tmp_path, base, capsys):
    stated = BASE.replace("mass_kg = 2000.0", "mass_kg = 2000.0\ncentroid_m = 1.0")
    (tmp_path / "stated.toml").write_text(stated, encoding="utf-8")
    rows = "name,height_m,centroid_m\nsame,3,\ntaller,4,\nown,4,1.5\n"
    command = ["batch", str(listed(tmp_path, rows)), "--case", "stated.toml", "--out", "out", "-q"]
    assert main([*command, "--margins", "none"]) == 0
    reasons = {row["name"]: row["reason"] for row in rows_of(tmp_path / "out" / "hall.csv")}
    assert "centroid_m = 1 of the case belongs to height_m = 3" in reasons["taller"]
    assert (reasons["same"], reasons["own"]) == ("", "")


@pytest.mark.parametrize(("first", "mark"), [("", ";"), ("", "\t"), ("sep=|\n", "|")])
def test_results_stand_in_the_separator_and_the_decimal_mark_of_the_list(tmp_path, base, first, mark):
    rows = [("name", "width_m", "note"), ("=A;1", "0,9", "-0,5"), ("B", "0,6", "+1 x")]
    text = io.StringIO()
    csv.writer(text, delimiter=mark, lineterminator="\n").writerows(rows)
    found = _hall_of(tmp_path, first + text.getvalue()).table
    written = (tmp_path / "out" / "hall.csv").read_text(encoding="utf-8")
    assert written.startswith(first)
    kept = [*csv.DictReader(io.StringIO(written.removeprefix(first)), delimiter=mark)]
    assert [(row["name"], row["width_m"], row["note"]) for row in kept] == [
        ("'=A;1", "0,9", "-0,5"),  # a formula is marked, a number with a decimal comma is none
        ("B", "0,6", "'+1 x"),
    ]
    for row, own in zip(kept, found, strict=True):
        assert row["utilisation_overturning"] == f"{own['utilisation_overturning']:.4g}".replace(".", ",")
    again = read_hall(tmp_path / "out" / "hall.csv")
    assert [row.name for row in again.rows] == ["=A;1", "B"]


SIDES = "name,width_m,depth_m\nacross,2.4,1.0\nalong,1.0,2.4\nsquare,1.0,1.0\n"


def test_the_narrower_side_governs_and_a_square_one_costs_nothing(tmp_path, base):
    command = ["batch", str(listed(tmp_path, SIDES)), "--case", "base.toml", "--margins", "none", "-q"]
    assert main(command) == 0 and main([*command, "--out", "one", "--one-side"]) == 0
    both, one = (
        json.loads((tmp_path / folder / "hall.json").read_text(encoding="utf-8"))
        for folder in ("outputs/hall", "one")
    )
    assert (both["runs"], one["runs"]) == (4, 3)
    assert [row["side"] for row in both["table"]] == ["depth", "width", "width"]
    assert {row["side"] for row in one["table"]} == {"width"}
    assert [row["outcome"] for row in both["table"]] == ["overturned"] * 3
    assert one["table"][0]["outcome"] != "overturned"
    across = both["table"][0]
    turned = compute(load_case("base.toml", shlex.split(across["command"])[6::2])).verdict
    assert turned.overturned_at_s == across["overturned_at_s"]
    page = (tmp_path / "one" / "report.html").read_text(encoding="utf-8")
    assert "--margins none --one-side" in page


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ("name;width_m;mass_kg\nBehälter;1,25;2000\n", "utf-8-sig"),
        ("name;width_m;mass_kg\r\nBehälter;1,25;2000\r\n", "latin-1"),
        ("sep=;\nName;WIDTH_M;mass_kg\nBehälter;1,25;2000\n", "utf-8"),
        ("name\twidth_m\tmass_kg\t\nBehälter\t1.25\t2e3\t\n\n", "utf-16"),
        ('name,container.width_m,mass_kg\n"Behälter","1,25",2000\n', "utf-8"),
    ],
)
def test_lists_of_every_spreadsheet_are_read(tmp_path, text, encoding):
    (row,) = read_hall(listed(tmp_path, text, encoding=encoding)).rows
    assert row.name == "Behälter" and row.values == {"container.width_m": 1.25, "container.mass_kg": 2000.0}


RECORD = "0 0\n0.1 1.5\n0.2 -2.5\n0.3 1\n0.4 0\n"


@pytest.mark.parametrize("name", ["runs.csv", "figures"])
def test_a_record_with_the_name_of_a_result_is_refused_before_anything_is_written(tmp_path, base, name):
    (tmp_path / name).write_text(RECORD, encoding="utf-8")
    motion = {"motion.kind": "table", "motion.file": name, "motion.unit": "m/s2"}
    case = load_case(base).replace(motion)
    with pytest.raises(CaseError, match="like a result of the hall"):
        run_hall(read_hall(listed(tmp_path, LIST)), case, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_page_of_a_finished_list_is_left_alone_and_a_missing_one_is_made(tmp_path, base):
    command = ["batch", str(listed(tmp_path, LIST)), "--case", "base.toml", "--margins", "none", "-q"]
    page = tmp_path / "outputs" / "hall" / "report.html"
    assert main(command) == 0 and page.is_file()
    page.write_text("signed", encoding="utf-8")
    assert main(command) == 0 and page.read_text(encoding="utf-8") == "signed"
    page.unlink()
    assert main(command) == 0 and page.is_file()
