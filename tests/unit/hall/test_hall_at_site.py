"""A list of containers verified at a site: what is computed again, what is refused, and the command of each row."""

import json
import re
import shlex
from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
from skfem import MeshQuad

from fem.case.validation import CaseError
from fem.hall.file import read_hall
from fem.hall.site import run_hall_at_site
from fem.results.folder import program_of_results
from fem.results.kinds import SITE as KIND
from fem.runtime.progress import SilentReporter
from fem.site.copies import copy_files, texts_of
from fem.site.motions import ground_motions
from fem.site.request import load_site

BASE = """
[container]
width_m = 1.0
height_m = 3.0
mass_kg = 2000.0
[contact]
mu_static = 0.5
[motion]
kind = "none"
"""
SITE = """
container = "base.toml"
[site]
ground = "D"
reference_acceleration_m_s2 = 3.5
[motions]
source = "records"
files = [["1.csv"], ["2.csv"], ["3.csv"]]
vertical = false
[friction]
mu_static = [0.4]
[limits]
slip_m = 0.1
[wind]
german_zone = 2
"""
LIST = "name,width_m,height_m,mass_kg\nlow,1,2,2000\ntall,9,40,200000\nwide,2,2,2000\n"


def record(path, frequency):
    times = np.arange(0.0, 20.0, 0.01)
    lines = (f"{time:.2f},{np.sin(frequency * time) * np.sin(0.157 * time):.6f}" for time in times)
    path.write_text("\n".join(["time_s,acceleration_m_s2", *lines]), encoding="utf-8")


@pytest.fixture
def asked(tmp_path, monkeypatch):
    """The list and the site file, with motions beside it; verifications that answer at once."""
    monkeypatch.chdir(tmp_path)
    for name, text in (("base.toml", BASE), ("site.toml", SITE), ("hall.csv", LIST)):
        Path(name).write_text(text, encoding="utf-8")
    for number in (1, 2, 3):
        record(tmp_path / f"{number}.csv", 5.0 + number)
    made = []

    def verified(request, folder, *, force, copy_records, **options):
        made.append(force)
        if request.container.container.width_m == 2.0:
            raise CaseError("the deciding run cannot be computed")
        folder.mkdir(parents=True, exist_ok=True)
        copy_files(request, folder, records=copy_records)
        for name, text in texts_of(request, KIND, records=copy_records).items():
            (folder / name).write_text(text, encoding="utf-8")
        mark = {"asked": "", **program_of_results()}
        (folder / "assess.json").write_text(json.dumps(mark), encoding="utf-8")
        names = ("margin_factor", "rotation_ratio", "slip_m", "factor_at_first_overturning")
        answer = dict.fromkeys(names) | {"answer": "fulfilled", "reasons": [], "sentence": "It is fulfilled."}
        answer |= {"overturned": 0, "invalid": 3}
        governing = SimpleNamespace(outcome="slide")
        return SimpleNamespace(
            state="finished", status="completed", result=SimpleNamespace(governing=governing, **answer)
        )

    monkeypatch.setattr("fem.hall.site.run_site", verified)

    def hall(**options):
        made.clear()
        site = load_site("site.toml")
        return run_hall_at_site(read_hall(Path("hall.csv")), site, None, tmp_path / "out", **options)

    return hall, made


def test_the_time_of_a_list_is_told_before_its_first_container(asked):
    told = []

    class Told(SilentReporter):
        def message(self, text):
            told.append(text)

    asked[0](reporter=Told(), jobs=1)
    assert re.match(r"2 containers with up to \d+ runs each: at most roughly \d+ s", told[0])
    assert told[1].startswith("container 1 of 2")


def test_one_row_that_cannot_be_verified_is_a_row_with_its_reason(asked):
    low, tall, wide = asked[0]().table
    assert (low["status"], low["answer"], low["outcome"]) == ("completed", "fulfilled", "slide")
    assert (low["motions_overturned"], low["motions_invalid"]) == (0, 3)
    assert tall["status"] == "refused" and "[wind]" in tall["reason"]
    assert (wide["status"], wide["reason"]) == ("failed", "the deciding run cannot be computed")
    assert low["rank"] == 2 and wide["rank"] == 1


def test_changed_contents_of_records_are_another_hall(asked):
    hall, made = asked
    first = hall()
    assert hall().asked == first.asked and not made
    record(Path("2.csv"), 9.0)
    assert hall(force=True).asked != first.asked


def test_another_spectrum_of_the_floor_under_the_same_name_is_another_hall(asked):
    hall, _ = asked
    artificial = SITE.replace('files = [["1.csv"], ["2.csv"], ["3.csv"]]\n', "").replace(
        "records", "artificial"
    )
    Path("site.toml").write_text(artificial + '[floor_spectrum]\nfile = "floor.csv"\n', encoding="utf-8")
    Path("floor.csv").write_text("period_s,acceleration_m_s2\n0.03,3\n4,0.5\n", encoding="utf-8")
    first = hall()
    assert hall().asked == first.asked
    Path("floor.csv").write_text("period_s,acceleration_m_s2\n0.03,9\n4,1.5\n", encoding="utf-8")
    assert hall(force=True).asked != first.asked


def test_with_force_every_container_is_verified_again_and_with_resume_those_that_are_missing(asked, tmp_path):
    hall, made = asked
    hall()
    assert made == [True, True]  # nothing is there to be continued
    whole, log = tmp_path / "out" / "hall.json", tmp_path / "out" / "sites.csv"
    found = json.loads(whole.read_text(encoding="utf-8")) | {"status": "interrupted"}
    whole.write_text(json.dumps(found), encoding="utf-8")
    lines = log.read_text(encoding="utf-8").splitlines(keepends=True)
    log.write_text("".join(line for line in lines if not line.startswith("0,")), encoding="utf-8")
    hall(resume=True)
    assert made == [False]
    hall(force=True)
    assert made == [True, True]


def test_records_outside_the_folder_need_the_flag_and_the_command_of_a_row_runs(asked, tmp_path):
    hall, _ = asked
    first = hall()
    row = first.table[0]
    words = shlex.split(row["command"])
    assert words[-1] == "--allow-outside"
    again = load_site(words[4])
    assert len(ground_motions(again, 4.0, allow_outside=True)) == 3
    (tmp_path / "below").mkdir()
    for name in ("site.toml", "base.toml"):
        Path(name).rename(tmp_path / "below" / name)
    text = SITE.replace('["', '["../')
    (tmp_path / "below" / "site.toml").write_text(text, encoding="utf-8")
    site, listed = load_site("below/site.toml"), read_hall(Path("hall.csv"))
    with pytest.raises(CaseError, match="allow-outside"):
        run_hall_at_site(listed, site, None, tmp_path / "other")
    found = run_hall_at_site(listed, site, None, tmp_path / "other", allow_outside=True)
    assert found.table[0]["answer"] == "fulfilled"
    assert found.asked == first.asked  # wherever the records lie


def test_the_folder_of_a_container_holds_its_mesh(asked, tmp_path):
    mesh = MeshQuad.init_tensor(np.linspace(-0.5, 0.5, 4), np.linspace(0.0, 3.0, 10))
    cells = [("quad", mesh.t.T)]
    solid = {"solid": [np.arange(mesh.t.shape[1])]}
    meshio.Mesh(np.column_stack([mesh.p.T, 0.0 * mesh.p[0]]), cells, cell_sets=solid).write("box.inp")
    Path("hall.csv").write_text("name,mesh_file,mass_kg\nbox,box.inp,2000\n", encoding="utf-8")
    (row,) = asked[0]().table
    again = load_site(shlex.split(row["command"])[4])
    assert again.container.data_files["container.mesh_file"].parent != tmp_path
