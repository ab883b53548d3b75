"""`size` from a site file to its folder, interrupted and resumed."""

import io
import json
import re
from contextlib import redirect_stderr

import numpy as np
import pytest
from small_site import SITE

from fem.__main__ import main
from fem.site.motions import ground_motions
from fem.site.request import load_site
from fem.site.size import size_axis, stages_at

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
        patch.setattr("fem.site.run.confirmed", confirmed)
        same = ground_motions(load_site(place / "hall.toml"), 4.0)  # instead of 72 others
        patch.setattr("fem.site.stages.artificial_motions", lambda *_, first, **__: [same[first % 3]])
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
    assert [line for line in told.splitlines() if "being tried" in line][:2] == [
        "number of boxes: 1 being tried",
        "number of boxes: 1 fulfilled, 2 being tried",
    ]


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


@pytest.mark.parametrize(
    ("key", "ends", "folders"),
    [
        ("container.width_m", (0.8, 1.0), 1),
        ("limits.slip_m", (0.1, 0.2), 1),
        ("site.importance_factor", (0.8, 1.2), 2),
    ],
)
def test_values_share_a_folder_of_motions_where_these_are_the_same(tmp_path, key, ends, folders):
    (tmp_path / "hall.toml").write_text(SITE, encoding="utf-8")
    asked = load_site(tmp_path / "hall.toml")
    axis = size_axis(asked, key, low=ends[0], high=ends[1], count=2)
    works = [stages_at(asked, axis, value, tmp_path / "made", {}) for value in axis.values]
    assert len({work.folder for work in works}) == len(list((tmp_path / "made").iterdir())) == folders
    for work in works:
        key = work.of_set()[0]
        assert (work.folder / "motions" / f"{key.stem}_h.csv").is_file()
        np.testing.assert_array_equal(work.motions[key.stem].horizontal, work.ground[0].horizontal)
