"""`size` from a site file to its folder, interrupted and resumed."""

import io
import json
import re
from contextlib import redirect_stderr

import numpy as np
import pytest
from small_site import SITE

from fem.__main__ import main
from fem.seismic.ground_motion import GroundMotion
from fem.site_check.file import load_site
from fem.site_check.size_run import written_motions

SURE = SITE.replace("further = 2", "further = 72\nvertical = false")


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with a site file, and the stacks that it allows."""
    place = tmp_path_factory.mktemp("size")
    asked: list[float] = []

    def confirmed(cases, runs, keys, jobs):
        """In place of bands of a minute, which `assess` tests: that they are asked for."""
        asked.extend(key.mu_static for key in keys)
        return []

    (place / "hall.toml").write_text(SURE, encoding="utf-8")
    command = ["size", str(place / "hall.toml"), "--over", "container.boxes", "--to", "4", *out(place)]
    told = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stderr(told):
        patch.setattr("fem.site_check.size_run.confirmed", confirmed)
        patch.setattr("fem.run.expected.LONG_S", 0.0)
        assert main(command) == 0
    (place / "told.txt").write_text(told.getvalue(), encoding="utf-8")
    assert asked  # of the boxes that stand and move
    return place


def out(place) -> list[str]:
    return ["--out", str(place / "found"), "-j", "1"]


def test_the_time_of_its_runs_is_told_before_the_first(place):
    told = (place / "told.txt").read_text(encoding="utf-8")
    expected = re.search(r"4 values, up to (\d+) runs: roughly \d", told)
    assert expected and int(expected[1]) > sum(
        point["runs"] for point in result_in(place / "found")["points"]
    )
    assert told.index(expected[0]) == re.search(r"\d+ (values|runs)", told).start()


def result_in(folder) -> dict:
    return json.loads((folder / "size.json").read_text(encoding="utf-8"))


def test_the_tallest_stack_is_found(place):
    found = result_in(place / "found")
    fulfilled = [point["fulfilled"] for point in found["points"]]
    assert [point["answer"] == "fulfilled" for point in found["points"]] == [one is True for one in fulfilled]
    assert fulfilled[0] and not fulfilled[-1]  # one box does not rock at 0.48 g; four rotate too far
    assert found["value"] == next(k for k, one in enumerate(fulfilled) if not one)
    assert found["sentence"].startswith(f"The largest number of boxes is {found['value']:g}")
    assert [point["runs"] for point in found["points"]] == [3] * 4
    assert (place / "found" / "figures" / "size.svg").is_file()
    assert not (place / "found" / ".motions").exists()


def test_values_share_a_folder_of_motions_where_the_further_motions_are_the_same(tmp_path):
    """The set may be the same all the same: one of records has no seed, and its scale need not follow the spectrum."""
    wave = np.sin(np.arange(0.0, 2.0, 0.01))
    floors = {None: [GroundMotion(name="record", step=0.01, horizontal=wave, vertical=0.5 * wave)]}
    site = load_site("site")

    def folder(key, value, longest=4.0):
        return written_motions(site.with_value(key, value), floors, longest, tmp_path)

    own = folder("motions.seed", site.motions.seed)
    assert folder("container.width_m", 1.5) == folder("friction.mu_static", [0.3]) == own
    others = {
        folder("motions.seed", site.motions.seed + 1),
        folder("motions.stationary_s", 20.0),
        folder("motions.vertical", False),
        folder("site.importance_factor", 1.2),
        folder("container.width_m", 1.5, longest=5.0),
    }
    assert len(others) == 5 and own not in others
    assert {path.name for path in own.rglob("*.csv")} == {"motion_01_h.csv", "motion_01_v.csv"}


def test_bad_input_is_told_before_anything_is_computed(place, capsys):
    for over, message in (("container.boxs", "did you mean 'boxes'"), ("site.ground", "no single number")):
        assert main(["size", str(place / "hall.toml"), "--over", over, *out(place)]) == 2
        assert message in capsys.readouterr().err
