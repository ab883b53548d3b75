"""Maps from a table: the panels asked for, the same bytes for the same table."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgba

from fem.figures.style import svg_of
from fem.study.answers import sweep_answer
from fem.study.axes import Axis
from fem.study.design import MapChoice
from fem.study.maps import SHARE_COLOURS, draw_maps, safe_boundary, sweep_map
from fem.study.sweep_table import SweepResult, SweepTable

FREQUENCY = Axis(
    key="motion.angular_frequency_rad_s", values=(1.0, 2.0, 4.0, 8.0, 16.0), scale="log", unit="rad/s"
)
PEAK = Axis(key="motion.peak_acceleration_m_s2", values=(1.0, 2.0, 3.0, 4.0), scale="linear", unit="m/s2")
MU = Axis(key="contact.mu_static", values=(0.2, 0.3, 0.4))
OMEGA = Axis(key="motion.angular_frequency_rad_s", values=(4.0, 6.0, 8.0), scale="linear", unit="rad/s")
MODEL = Axis(key="solver.model", values=("rigid", "reduced"))


def table_of(*axes, copies=False):
    count = int(np.prod([len(axis.values) for axis in axes]))
    words = np.array(["rest", "rock", "overturned", "slide", "slide-rock"], dtype=object)
    outcome = words[np.arange(count) % 5]
    status = np.where(outcome == "overturned", "overturned", "completed").astype(object)
    status[0] = "failed"
    columns = {
        "status": status,
        "outcome": outcome,
        "rotation_ratio": np.linspace(0.0, 1.0, count),
        "max_slip_m": np.linspace(0.0, 0.1, count),
        "unsure": (np.arange(count) % 3 == 0).astype(float),
        "sure": np.array(["unsure", "regime unsure", "sure"], dtype=object)[np.arange(count) % 3],
    }
    if copies:
        columns["overturned_share"] = np.linspace(0.0, 1.0, count)
    info = SweepResult(
        sweep_hash="", axes=axes, title="A <title> & more", sweep="try", held="with mu_k = mu_s/2"
    )
    return SweepTable(info=info, columns=columns)


def panels_of(figure):
    return [axes for axes in figure.axes if axes.get_visible() and axes.patches and axes.get_label() == ""]


def colours_of(axes):
    """The colour of each cell, (rows, columns, 4): of the last rectangles over its middle."""
    columns, rows = (round(max(limits) + 0.5) for limits in (axes.get_xlim(), axes.get_ylim()))
    colours = np.zeros((rows, columns, 4))
    for patch in axes.patches:
        for row, column in np.ndindex(rows, columns):
            if (
                patch.get_fill()
                and patch.get_hatch() is None
                and patch.get_path().contains_point((column, row))
            ):
                colours[row, column] = patch.get_facecolor()
    return colours


def words_of(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_a_map_shows_how_many_copies_overturn_beside_the_outcome():
    table = table_of(FREQUENCY, PEAK, copies=True)
    figure = sweep_map(table, "outcome", MapChoice())
    assert "with mu_k = mu_s/2" in figure.get_suptitle()
    share, outcome = panels_of(figure)
    legend = ["none overturns", "up to a quarter", "up to three quarters", "more", "all overturn"]
    assert words_of(share) == legend
    assert {"rest", "slide", "rock", "slide-rock", "overturned"} <= set(words_of(outcome))
    shades = [to_rgba(one) for one in SHARE_COLOURS.values()]
    classes = [[shades.index(tuple(cell)) for cell in row] for row in colours_of(share)]
    for cell, part in enumerate(table["overturned_share"]):
        frequency, peak = divmod(cell, 4)
        least = [0.0, 0.0, 0.25, 0.75, 1.0][classes[peak][frequency]]
        most = [0.0, 0.25, 0.75, 1.0, 1.0][classes[peak][frequency]]
        assert least <= part <= most


def test_two_axes_span_a_map_and_the_rest_has_panels():
    table = table_of(FREQUENCY, MU, PEAK)
    figure = sweep_map(table, "outcome", MapChoice())
    titles = [axes.get_title(loc="left") for axes in panels_of(figure)]
    assert titles == [f"Outcome; mu static {mu}" for mu in (0.2, 0.3, 0.4)]
    assert len(panels_of(sweep_map(table_of(FREQUENCY, MU, PEAK, copies=True), "outcome", MapChoice()))) == 6
    fixed = sweep_map(table, "outcome", MapChoice(fixed={"contact.mu_static": 0.3}))
    assert len(panels_of(fixed)) == 1
    turned = sweep_map(table, "outcome", MapChoice(x="contact.mu_static", y="motion.peak_acceleration_m_s2"))
    assert len(panels_of(turned)) == 5
    assert colours_of(panels_of(turned)[0]).shape == (4, 3, 4)


@pytest.mark.parametrize("case", ["seed_stack_plateau", "my-stack"])
def test_the_paper_is_marked_on_maps_of_its_containers_alone(case):
    table = table_of(OMEGA, MU)
    marked = replace(table, info=replace(table.info, case=case))
    (axes,) = panels_of(sweep_map(marked, "rotation", MapChoice()))
    crosses = [sorted(line.get_xydata()[0]) for line in axes.lines if line.get_marker() == "+"]
    assert crosses == (
        [] if case == "my-stack" else [pytest.approx([1.464, 2.0])]
    )  # of 6.928 rad/s and mu 0.4


def test_maps_are_the_same_bytes_again(tmp_path):
    table = table_of(FREQUENCY, PEAK)
    names = draw_maps(table, tmp_path / "maps", MapChoice())
    assert names == [f"maps/{kind}.svg" for kind in ("outcome", "rotation", "slip")]
    first = (tmp_path / names[0]).read_bytes()
    assert b"A &lt;title&gt; &amp; more" in first
    assert svg_of(sweep_map(table, "outcome", MapChoice())).encode() == first


def test_a_sweep_with_thresholds_begins_with_the_boundary_of_the_safe_region_and_its_band(tmp_path):
    aspect = Axis(key="free.aspect_ratio", values=(1.0, 2.0, 4.0, 6.0, 8.0), scale="linear")
    table = table_of(MODEL, MU, aspect)
    cell = np.arange(len(table["status"]))
    ratio, mu = np.array(aspect.values)[cell % 5], cell // 5 % 3
    fallen = ratio > np.array([4.0, 4.0, 2.0])[mu]  # first at 6, 6 and 4
    table.columns["outcome"] = np.where(fallen, "overturned", "rock").astype(object)
    table.columns["status"] = np.where(fallen, "overturned", "completed").astype(object)
    table.columns["unsure"] = (ratio == np.array([4.0, 2.0, 8.0])[mu]).astype(float)
    info = replace(table.info, threshold={"axis": aspect.key}, case="seed_stack_plateau")
    table = replace(table, info=info)
    choice = MapChoice(x=aspect.key, y=MU.key)
    assert draw_maps(table, tmp_path / "maps", choice)[0] == "maps/boundary.svg"
    figure = safe_boundary(table, sweep_answer(table, tmp_path), choice)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["model rigid", "model reduced"]
    for axes in figure.axes:
        first, paper = axes.lines
        assert first.get_xydata().tolist() == [[6.0, 0.2], [6.0, 0.3], [4.0, 0.4]]
        assert paper.get_xydata() == pytest.approx(np.array([[1.0 / 1.1, 0.4], [4.0 / 1.1, 0.4]]))
        safe, band = (collection.get_paths()[0].vertices for collection in axes.collections)
        for least, most, part in ((1.0, [2.0, 1.0, 2.0], safe), ([2.0, 1.0, 2.0], [6.0, 6.0, 4.0], band)):
            for mu, low, high in zip(MU.values, np.broadcast_to(least, 3), most, strict=True):
                ends = part[np.isclose(part[:, 1], mu), 0]
                assert (ends.min(), ends.max()) == (low, high)
    assert safe_boundary(table, sweep_answer(table, tmp_path), MapChoice(x="solver.model", y=MU.key)) is None
