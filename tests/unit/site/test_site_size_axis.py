"""The key that `size` varies, and its range."""

from dataclasses import replace

import pytest

from fem.case.validation import CaseError
from fem.site.request import SiteRequest, load_site
from fem.site.size import at, size_axis

SITE = load_site("site")


def in_building(**keys: int) -> SiteRequest:
    """The site with a building of one mode, or of storeys."""
    building = {"z_over_h": 1.0, "building_period_s": 0.3, **keys}
    return replace(SITE, data={**SITE.data, "building": building}).with_value("building.damping_ratio", 0.05)


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
    axis = size_axis(SITE, key)
    assert (axis.wanted, axis.unit, len(axis.values)) == (wanted, unit, count)
    assert (axis.values[0], axis.values[-1]) == pytest.approx(ends, rel=1e-5)


def test_the_request_takes_the_value():
    assert at(SITE, size_axis(SITE, "container.boxes"), 3.0).container.container.boxes == 3
    axis = size_axis(SITE, "container.width_m", low=0.8, high=1.2, count=3)
    assert axis.values == (0.8, 1.0, 1.2)
    box = at(SITE, axis, 0.8).container.container
    assert (box.width_m, box.depth_m) == (0.8, 0.8)  # it was square
    deep = at(SITE.with_value("container.depth_m", 1.3), axis, 0.8).container.container
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
