"""`size`: the key and its range, scan, refinement and islands, from a site file to its folder."""

import io
import json
import re
from contextlib import redirect_stderr
from dataclasses import replace

import numpy as np
import pytest
from site_answers import FRICTION, WIDTH, ends, size
from site_example import INPUTS
from small_site import SITE

from fem.__main__ import main
from fem.case.validation import CaseError
from fem.results.json_block import to_json
from fem.site.motions import ground_motions
from fem.site.page import draw_size
from fem.site.request import SiteRequest, load_site
from fem.site.result import SizeResult
from fem.site.size import at, size_axis, stages_at


def test_the_least_width_is_found_within_one_per_cent_on_the_side_that_fulfils():
    result = size(WIDTH, lambda width: width >= 1.2345)
    assert 1.2345 <= result.value <= 1.2345 * 1.0101
    assert result.intervals == ((result.value, 2.0),)
    assert result.sentence.startswith("The least width is 1.2")
    assert float(result.sentence.split()[4]) >= result.value
    assert len(result.points) < 25


@pytest.mark.parametrize(("axis", "fulfilled"), [(WIDTH, False), (WIDTH, True), (FRICTION, False)])
def test_a_range_without_a_change_is_not_refined(axis, fulfilled):
    result = size(axis, lambda _: fulfilled)
    assert result.value == (0.8 if fulfilled else None)
    assert len(result.points) == len(axis.values)


def test_the_result_survives_its_file_and_is_drawn():
    result = size(WIDTH, lambda width: width >= 1.5 or 1.0 <= width <= 1.21)
    assert SizeResult.from_json(json.loads(to_json(result.to_json()))) == result
    assert "The least width is" in draw_size(result, INPUTS)
    assert "not standing [%]" in draw_size(ends(overturned=0, invalid=2), INPUTS)


SHIPPED = load_site("site")


def in_building(**keys: int) -> SiteRequest:
    """The site with a building of one mode, or of storeys."""
    building = {"z_over_h": 1.0, "building_period_s": 0.3, **keys}
    site = replace(SHIPPED, data={**SHIPPED.data, "building": building})
    return site.with_value("building.damping_ratio", 0.05)


@pytest.mark.parametrize(
    ("key", "wanted", "unit", "ends", "count"),
    [
        # the next of 13 values up to 3.3 m is 1.32 m, where walls and posts weigh more than the empty box, 600 kg
        ("container.width_m", "least", "m", (1.1 / 3.0, 1.1), 7),
        ("container.boxes", "largest", "", (1.0, 12.0), 12),
        ("contact.mu_static", "window", "", (0.05, 1.0), 13),
        ("site.reference_acceleration_m_s2", "largest", "m/s2", (2.3 / 3.0, 6.9), 13),
        ("site.importance_factor", "largest", "", (0.5, 2.0), 13),
        ("limits.slip_m", "window", "m", (0.25 / 3.0, 0.75), 13),
    ],
)
def test_each_key_has_its_range_about_the_value_of_the_files(key, wanted, unit, ends, count):
    axis = size_axis(SHIPPED, key)
    assert (axis.wanted, axis.unit, len(axis.values)) == (wanted, unit, count)
    assert (axis.values[0], axis.values[-1]) == pytest.approx(ends, rel=1e-5)


def test_the_request_takes_the_value():
    assert at(SHIPPED, size_axis(SHIPPED, "container.boxes"), 3.0).container.container.boxes == 3
    axis = size_axis(SHIPPED, "container.width_m", low=0.8, high=1.2, count=3)
    assert axis.values == (0.8, 1.0, 1.2)
    box = at(SHIPPED, axis, 0.8).container.container
    assert (box.width_m, box.depth_m) == (0.8, 0.8)  # it was square
    deep = at(SHIPPED.with_value("container.depth_m", 1.3), axis, 0.8).container.container
    assert (deep.width_m, deep.depth_m) == (0.8, 1.3)


def test_of_a_building_of_storeys_every_floor_is_tried_and_none_between():
    tall = in_building(storeys=5)
    axis = size_axis(tall, "building.z_over_h")
    assert axis.values == (0.0, 0.2, 0.4, 0.6, 0.8, 1.0) and axis.whole
    assert [at(tall, axis, value).building.z_over_h for value in axis.values] == list(axis.values)
    assert size_axis(in_building(storeys=3), "building.z_over_h", low=0.3, high=0.66666).values == (
        1 / 3,
        2 / 3,
    )
    low = in_building()
    assert len(size_axis(low, "building.z_over_h").values) == 13
    with pytest.raises(CaseError, match="fewer than two values"):
        size_axis(tall, "building.z_over_h", low=0.3, high=0.5)


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
    points = result_in(place / "found")["points"]
    assert expected and int(expected[1]) > sum(point["runs"] for point in points)
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
