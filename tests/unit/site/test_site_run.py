"""Verifications from file to folder: the same result on any number of cores and after an interruption."""

import json
import re

import pytest
from small_site import three_records

from fem.__main__ import main
from fem.records.files import read_record
from fem.seismic.artificial import artificial_motions
from fem.seismic.ground_motion import write_csv
from fem.site.motions import ground_motions
from fem.site.request import load_site
from fem.site.run import run_site
from fem.site.runs import NOT_COMPUTED, cases_of, key_of
from fem.site.stages import SCANNED, Stages
from fem.study.runner import run_chunk

CONTAINER = """
schema = 1
[container]
width_m = 1.1
height_m = 4.0
mass_kg = 10000.0
[contact]
mu_static = 0.4
[motion]
kind = "harmonic"
peak_acceleration_m_s2 = 4.0
frequency_Hz = 1.0
[solver]
model = "rigid"
"""
SITE = """
schema = 1
container = "k1.toml"
{heading}
[site]
type = 1
ground = "D"
reference_acceleration_m_s2 = {reference}
[motions]
count = 3
stationary_s = 10.0
further = {further}
{motions}
[friction]
mu_static = [0.4]
mu_kinetic_over_static = [0.5]
[limits]
slip_m = 0.1
{more}
"""


def site_file(folder, *, reference=2.4 / 1.35, further=72, heading="", motions="", more=""):
    (folder / "k1.toml").write_text(CONTAINER)
    text = SITE.format(reference=reference, further=further, heading=heading, motions=motions, more=more)
    (folder / "site.toml").write_text(text)
    return folder / "site.toml"


@pytest.fixture
def brief(monkeypatch):
    """Runs at one factor, and no page."""
    monkeypatch.setattr("fem.site.stages.SCANNED", ())
    monkeypatch.setattr("fem.site.run.confirmed", lambda *arguments: [])
    monkeypatch.setattr("fem.site.page.site_report", lambda *arguments: "")


@pytest.fixture(scope="module")
def computed(tmp_path_factory):
    """A verification without its deciding runs, whose bands `said/studies.txt` computes, and its folder."""
    folder = tmp_path_factory.mktemp("site")
    place = site_file(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("fem.site.run.confirmed", lambda *arguments: [])
        patch.setattr("fem.site.page.site_report", lambda *arguments: "")
        same = ground_motions(load_site(place), 4.0)  # instead of 72 others, which take as long as all runs
        patch.setattr("fem.site.stages.artificial_motions", lambda *_, first, **__: [same[first % 3]])
        return run_site(load_site(place), folder / "out", jobs=1), folder


def test_every_motion_runs_with_both_signs_at_every_factor(computed):
    result, _ = computed
    assert result.status == "completed"
    own = [run for run in result.runs if run.stage == "set"]
    assert {(run.motion, run.vertical_sign) for run in own} >= {(k, s) for k in (1, 2, 3) for s in (1, -1)}
    factors = [point.factor for point in result.result.scan]
    assert factors == sorted([1.0, *SCANNED])[: len(factors)]
    assert all(point.runs == 6 for point in result.result.scan)
    assert result.result.runs == 6 and [one.motions for one in result.result.further] == [72]


def test_the_container_of_the_example_fulfils_the_rule_and_overturns_at_a_higher_factor(computed):
    answer = computed[0].result
    assert (answer.answer, answer.fulfilled, answer.overturned) == ("fulfilled", True, 0)
    assert answer.rotation_ratio < 0.01 and answer.slip_m < 0.005
    first = answer.factor_at_first_overturning
    assert 1.25 < answer.margin_factor <= first <= 4.0
    runs = computed[0].runs
    assert first == min(run.factor for run in runs if run.outcome == "overturned")
    # The scan ends where a run overturns; between the last factors of the scan, others were tried.
    fell = [point.factor for point in answer.scan if point.overturned and point.factor > 1.0]
    assert max(run.factor for run in runs) == min(fell)
    assert {run.factor for run in runs if run.stage == "refined"} - {1.0, *SCANNED}


def test_runs_below_uplift_and_slip_are_not_computed_and_rest_where_they_are(computed):
    """What the rigid bound says of a run is what the run says: the nearest one that it spares, computed."""
    result, folder = computed
    spared = [line for line in (folder / "out" / "runs.csv").read_text().splitlines() if NOT_COMPUTED in line]
    assert spared and result.result.still == sum(line.startswith("set,") for line in spared)
    request = load_site(folder / "site.toml")
    made = cases_of(request, folder / "out")
    cases = lambda key: made(key).with_values({"output.stop_when_still": False})  # noqa: E731 - to the end
    stages = Stages.of(request, folder / "out")
    keys = [key for factor in SCANNED for key in stages.scanned(factor)]
    near = max((key for key in keys if stages.at_rest(key)), key=stages.used)
    (row,) = run_chunk(cases, [near])
    # of a base that keeps its place, as far as its springs creep
    assert row["outcome"] == "rest" and row["rotation_ratio"] < 1e-4 and row["max_slip_m"] < 1e-5
    beyond = min((key for key in keys if stages.used(key) > 1.3), key=stages.used)
    (row,) = run_chunk(cases, [beyond])
    assert row["rotation_ratio"] > 1e-4 or row["max_slip_m"] > 1e-6


def test_what_the_rule_decides_by_is_computed_as_a_single_run_and_what_is_counted_more_coarsely(computed):
    result, folder = computed
    request = load_site(folder / "site.toml")
    made = cases_of(request, folder / "out")
    tolerances = {run.stage: made(key_of(run)).solver.energy_tolerance for run in result.runs}
    assert tolerances.keys() >= {"set", "repeated", "scan", "refined", "further"}
    usual = request.container.solver.energy_tolerance
    assert {tolerances.pop(stage) for stage in ("set", "repeated")} == {usual}
    assert {*tolerances.values()} == {10.0}


@pytest.mark.parametrize(("preset", "spared"), [("concrete C25/30", True), ("compacted gravel", False)])
def test_on_a_floor_that_gives_way_every_run_is_computed(tmp_path, preset, spared):
    place = site_file(tmp_path)
    floor = f'[floor]\nkind = "slab"\npreset = "{preset}"\n[support]\nkind = "flat"\n'
    (tmp_path / "k1.toml").write_text(CONTAINER + floor)
    request = load_site(place)
    stages = Stages.of(request, tmp_path)
    weak = stages.scanned(0.1)
    assert [stages.at_rest(key) for key in weak] == [spared] * len(weak)


def test_the_motions_are_written_and_read_back_to_the_same_bits(computed):
    result, folder = computed
    assert {motion.files for motion in result.set.motions}
    for motion in result.set.motions:
        values = {name: read_record(folder / "out" / name).components[0] for name in motion.files}
        for letter in ("h", "v", "t"):
            csv, at2 = (
                values[f"motions/motion_{motion.number:02d}_{letter}.{end}"] for end in ("csv", "at2")
            )
            assert csv.values.tobytes() == at2.values.tobytes()
            assert csv.times.tobytes() == at2.times.tobytes()
        assert motion.end_velocity_m_s < 1e-10 and motion.end_displacement_m < 1e-9


def test_on_a_floor_the_period_of_the_building_is_varied(tmp_path, brief):
    more = "[building]\nz_over_h = 1.0\nbuilding_period_s = 0.5"
    place = site_file(tmp_path, reference=0.6, further=0, motions="vertical = false", more=more)
    result = run_site(load_site(place), tmp_path / "out", jobs=1)
    own = [run for run in result.runs if run.stage == "set"]
    assert {run.building_period_s for run in own} == {0.425, 0.5, 0.575}
    assert {run.vertical_sign for run in own} == {0}
    assert result.floor.peak_m_s2 > 2.0 * result.set.mean_pga_m_s2
    assert result.result.further == ()
    assert any("4.3.5.2" in method.source for method in result.methods)


def records(folder, *, scale=0.5):
    return f'source = "records"\nfiles = {three_records(folder, load_site("site").action, scale=scale)}'


def test_records_are_scaled_to_the_site(tmp_path, brief):
    place = site_file(tmp_path, further=0, motions=records(tmp_path, scale=0.1))
    result = run_site(load_site(place), tmp_path / "out", jobs=1)
    assert result.set.valid and result.set.source == "records" and result.set.stationary_s is None
    assert all(motion.scale > 5.0 for motion in result.set.motions)
    assert min(result.set.mean_pga_m_s2 / 2.4, result.set.least_ratio / 0.9) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("EVENT", "IZMIT", "records of one event"),
        ("r0_h.at2", "none.at2", "none.at2"),
        ("r0_h.at2", "../r0_h.at2", "in the folder"),
    ],
)
def test_records_that_cannot_be_used_are_refused(tmp_path, capsys, old, new, message):
    motions = records(tmp_path)
    for file in tmp_path.glob("*.at2"):
        file.write_text(re.sub(rf"{old} \d", new, file.read_text()))
    place = site_file(tmp_path, motions=motions.replace(old, new))
    assert main(["assess", str(place), "--out", str(tmp_path / "out"), "-q"]) == 2
    assert message in capsys.readouterr().err


def test_quick_is_never_fulfilled_of_a_container_that_moves(tmp_path, capsys, brief):
    place = site_file(tmp_path, reference=3.2, motions="vertical = false")
    assert main(["assess", str(place), "--out", str(tmp_path / "out"), "--quick", "-j", "1"]) == 0
    shown = capsys.readouterr()
    assert "3 to compute, up to 18 with repetitions: up to roughly" in shown.err
    found = json.loads((tmp_path / "out" / "assess.json").read_text())["result"]
    assert found["answer"] in ("not sure", "not fulfilled") and found["further"] == []
    assert any("Left out by --quick" in reason for reason in found["reasons"])


def test_a_container_that_rests_is_answered_without_a_run(tmp_path, monkeypatch, brief):
    place = site_file(tmp_path, reference=0.8, further=72)
    same = ground_motions(load_site(place), 4.0)[:1]
    monkeypatch.setattr("fem.site.stages.further_motion", lambda *arguments: same[0])
    result = run_site(load_site(place), tmp_path / "out", jobs=1, quick=True)
    answer = result.result
    assert (answer.answer, answer.still, answer.runs) == ("fulfilled", 6, 6)
    assert answer.further[0].motions == 72 and answer.factor_at_first_movement > 1.5


@pytest.mark.parametrize("most", [20_000_000, 1000])
def test_a_folder_of_results_is_repeated_by_itself(tmp_path, monkeypatch, brief, most):
    """From where it was moved, with the records of two folders; a record that is too large stays where it is."""
    monkeypatch.setattr("fem.site.run.MOST_COPIED", most)
    target = load_site(site_file(tmp_path)).action
    names = ["in/one.csv", "in/two.csv", "other/one.csv"]
    for name, motion in zip(names, artificial_motions(target, count=3, seed=5, vertical=False), strict=True):
        place = tmp_path / name
        place.parent.mkdir(exist_ok=True)
        write_csv(place, motion.step, 0.2 * motion.horizontal)
    keys = 'source = "floor"\nvertical = false\nsecond_component = 0.0\n'
    files = f"{keys}files = {[[name] for name in names]}  # as they came"
    place = site_file(tmp_path, further=2, motions=files)
    place.write_text(place.read_text().replace("count = 3\nstationary_s = 10.0\n", ""))
    first = run_site(load_site(place), tmp_path / "out", quick=True, jobs=1)
    copied = most > 1000
    (tmp_path / "out").rename(tmp_path / "moved")
    for name in ("site.toml", "k1.toml", *(names if copied else ())):
        (tmp_path / name).unlink()
    own = tmp_path / "moved" / "site.toml"
    assert 'container = "container.toml"' in own.read_text() and "# as they came" in own.read_text()
    again = run_site(load_site(own), tmp_path / "again", quick=True, jobs=1, allow_outside=not copied)
    assert (again.result, again.runs) == (first.result, first.runs)
    assert first.result.still == 3 and [one.motions for one in first.result.further] == [2]
    assert [one.pga_m_s2 for one in again.set.motions] == [one.pga_m_s2 for one in first.set.motions]
    left = [note for note in first.set.notes if "not copied" in note]
    assert len(left) == (0 if copied else 3) and all("SHA-256" in note for note in left)
