"""Reports of ensembles and response curves: the answer first, then figures, request, points, how to repeat."""

import json
import re
import shlex

import pytest
from study_folders import ensemble_folder, response_folder

from fem.__main__ import main
from fem.html.units import ABSENT
from fem.report.study_page import ensemble_report, folded, response_report
from fem.results.errors import FolderError

#: headings in the order in which a reader wants them
HEADINGS = {
    "ensemble": ["Found", "Fragility curve", "The ensemble", "Points"],
    "response": [
        *("Found", "Response", "What lasts at each frequency", "Where a sweep overturns"),
        *("The drive and the case", "Points of the sweeps"),
    ],
}
END = ["Assumptions and exclusions", "Provenance and how to repeat it"]
MADE = {"ensemble": (ensemble_folder, ensemble_report), "response": (response_folder, response_report)}


def page_of(kind, folder, **more):
    make, report = MADE[kind]
    return report(make(folder, **more))


def rows_of(page, label):
    """The texts of a table's rows."""
    table = re.search(rf'aria-label="{label}">.*?</table>', page, re.DOTALL)[0]
    rows = re.findall(r"<tr>(.*?)</tr>", table, re.DOTALL)
    return [re.findall(r">([^<]*)</t[hd]>", row) for row in rows[1:]]


@pytest.mark.parametrize("kind", MADE)
def test_a_page_begins_with_the_answer_and_ends_with_how_to_repeat_it(kind, tmp_path):
    page = page_of(kind, tmp_path)
    assert re.findall(r"<h2[^>]*>([^<]*)</h2>", page) == HEADINGS[kind] + END
    assert page.index('class="sentence"') < page.index("<svg")
    assert "</script><b>" not in page
    assert "Stack <b>" not in page


def test_an_ensemble_says_where_half_overturned_and_shows_every_point(tmp_path):
    page = page_of("ensemble", tmp_path)
    sentence = re.search(r'<p class="sentence">(.*?)</p>', page)[1]
    assert sentence == (
        "Peak acceleration: half of 100 draws overturned at 0.45 g (95 % interval 0.4 g to 0.5 g); "
        "at most 5 % up to 0.2 g, by the upper end of the interval."
    )
    assert [row[1:] for row in rows_of(page, "points")] == [
        ["100", "100", "0", "0", "0", "0 %", "0 to 4.00 %", "at most 5 %", ABSENT],
        ["100", "60", "40", "0", "0", "40.0 %", "30.0 to 50.0 %", "more than 5 %", ABSENT],
        ["100", "20", "80", "0", "0", "80.0 %", "70.0 to 90.0 %", "more than 5 %", ABSENT],
    ]
    assert rows_of(page, "random quantities") == [
        [
            "contact.mu_static",
            "normal, mean 1, deviation 0.05, cut at 3 deviations, times the value of the key",
        ],
        ["free.ratio", "uniform, 0.5 to 1"],
        ["motion.start", "over its range as an unknown input"],
    ]
    assert "case = &#34;&lt;b&gt;.toml&#34;" in page
    assert "python -m fem ensemble &#39;my ensemble.toml&#39;" in page


def test_a_curve_of_which_no_point_was_judged_says_nothing_of_stable_ones(tmp_path):
    page = page_of("response", tmp_path)
    assert "Stable: 3 of 4 points: amplitudes do not diverge" in page
    assert "rock of period 1 at 3, overturned at 1." in page
    found = response_folder(tmp_path / "none")
    text = (found / "response.json").read_text()
    (found / "response.json").write_text(re.sub(r'"stable": (true|false)', '"stable": null', text))
    assert "Stable:" not in response_report(found)


def test_a_response_curve_is_repeated_by_its_command(tmp_path):
    page = page_of("response", tmp_path)
    assert (
        "Frequency: largest lasting motion 0.62 of the slenderness angle, rock of period 1 at 1 Hz (going up); "
        "overturned at 0.5 Hz going down; stood at the other 3 points; slid by up to 12 mm a period, at 0.5 "
        "Hz going up; motions coexist at 1 Hz." in page
    )
    assert rows_of(page, "points")[-1] == ["down", "0.5", "overturned", *"–––––", "no", ""]
    assert rows_of(page, "what lasts")[-1] == [
        *("1", "3.3", "0.620 rock of period 1 (up); 0.200 rock of period 1 (down)")
    ]
    assert "0.5 Hz going down: a motion that was carried there" in page
    words = shlex.split(re.search(r'<pre class="command">(.*?)</pre>', page)[1])
    assert words[:5] == ["python", "-m", "fem", "response", "case.toml"]
    assert dict(zip(words[5::2], words[6::2], strict=True))["--hold"] == "acceleration"


@pytest.mark.parametrize("kind", MADE)
def test_the_command_line_tells_them_apart(kind, tmp_path, capsys):
    MADE[kind][0](tmp_path / "made")
    assert main(["report", str(tmp_path / "made"), "--author", "N. N."]) == 0
    written = tmp_path / "made" / "report.html"
    assert capsys.readouterr().out.strip() == str(written)
    assert 'value="N. N."' in written.read_text(encoding="utf-8")


@pytest.mark.parametrize("kind", MADE)
def test_an_unfinished_one_is_refused_with_the_way_out(kind, tmp_path):
    folder = MADE[kind][0](tmp_path)
    (folder / f"{kind}.json").write_text(json.dumps({"status": "running", "asked": "ab"}))
    with pytest.raises(FolderError, match="not finished; continue it with --resume"):
        MADE[kind][1](folder)


@pytest.mark.parametrize("kind", MADE)
def test_an_interrupted_one_shows_what_there_is_without_an_answer(kind, tmp_path):
    page = page_of(kind, tmp_path, status="interrupted")
    assert "(interrupted)" in page
    assert "half of 100 draws" not in page
    assert "largest rotation 0.62" not in page


def test_an_ensemble_that_has_come_to_no_point_tells_no_share(tmp_path):
    page = page_of("ensemble", tmp_path, status="interrupted", points=[], regions={})
    assert "0 points of 100 draws (interrupted).<" in page


def test_equal_containers_are_one_row_and_those_that_rest_stand_apart():
    outcomes = ("overturned", "rest", "rest", "rest", "rest")
    ranked = [
        {"name": f"C{k}", "command": f"run {k % 4}", "tag": "", "line": k + 2, "count": 1, "outcome": outcome}
        for k, outcome in enumerate(outcomes)
    ]
    ranked[4]["command"] = "run 3"
    moving, resting = folded(ranked)
    assert [row["name"] for row in moving] == ["C0"]
    assert [row["name"] for row in resting] == ["C1", "C2", "C3 and 1 alike"]
    assert resting[-1]["line"] == "5, 6" and resting[-1]["count"] == 2
    assert folded(ranked[:3]) == (ranked[:3], []) and folded(ranked[1:4]) == (ranked[1:4], [])
