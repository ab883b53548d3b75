"""Maps from a table: the panels asked for, the same bytes for the same table."""

import numpy as np
import pytest

from fem.batch.axes import Axis
from fem.batch.labels import axis_label
from fem.figures.style import svg_of
from fem.sweep.maps import draw_maps, sweep_map
from fem.sweep.plan import MapChoice
from fem.sweep.result import SweepResult
from fem.sweep.table import SweepTable

FREQUENCY = Axis(
    key="motion.angular_frequency_rad_s", values=(1.0, 2.0, 4.0, 8.0, 16.0), scale="log", unit="rad/s"
)
PEAK = Axis(key="motion.peak_acceleration_m_s2", values=(1.0, 2.0, 3.0, 4.0), scale="linear", unit="m/s2")
MU = Axis(key="contact.mu_static", values=(0.2, 0.3, 0.4))
MODEL = Axis(key="solver.model", values=("rigid", "reduced"))


def table_of(*axes):
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
    info = SweepResult(
        sweep_hash="", axes=(), title="A <title> & more", sweep="try", held="with mu_k = mu_s/2"
    )
    return SweepTable(info=info, axes=axes, columns=columns)


def panels_of(figure):
    return [axes for axes in figure.axes if axes.get_visible() and axes.images and axes.get_label() == ""]


def test_keys_are_named_for_people():
    assert axis_label(PEAK) == "peak acceleration [m/s²]"
    assert axis_label(MU) == "mu static [-]"
    assert axis_label(MODEL) == "model"


def test_a_map_says_what_it_holds_and_how_sure_its_cells_are():
    figure = sweep_map(table_of(FREQUENCY, PEAK), "outcome", MapChoice())
    assert "with mu_k = mu_s/2" in figure.get_suptitle()
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"sure: no sign", "regime unsure", "unsure"} <= set(legend)


def test_two_axes_span_a_map_and_the_rest_has_panels():
    table = table_of(FREQUENCY, MU, PEAK)
    figure = sweep_map(table, "outcome", MapChoice())
    assert [axes.get_title(loc="left") for axes in panels_of(figure)] == [
        "mu static 0.2",
        "mu static 0.3",
        "mu static 0.4",
    ]
    fixed = sweep_map(table, "outcome", MapChoice(fixed={"contact.mu_static": 0.3}))
    assert len(panels_of(fixed)) == 1
    turned = sweep_map(table, "outcome", MapChoice(x="contact.mu_static", y="motion.peak_acceleration_m_s2"))
    assert len(panels_of(turned)) == 5
    assert panels_of(turned)[0].images[0].get_array().shape == (4, 3)


def test_a_cell_stands_where_its_axes_say():
    table = table_of(FREQUENCY, PEAK)
    image = panels_of(sweep_map(table, "rotation", MapChoice()))[0].images[0].get_array()
    assert image.shape == (4, 5)
    cell = 3 * 4 + 1  # frequency 8, peak 2
    assert image[1, 3] == pytest.approx(table["rotation_ratio"][cell])


def test_failed_cells_have_their_own_colour():
    figure = sweep_map(table_of(FREQUENCY, PEAK), "outcome", MapChoice())
    assert "failed" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_maps_are_the_same_bytes_again(tmp_path):
    table = table_of(FREQUENCY, PEAK)
    names = draw_maps(table, tmp_path / "maps", MapChoice())
    assert names == ["maps/outcome.svg", "maps/rotation.svg", "maps/slip.svg"]
    first = (tmp_path / names[0]).read_bytes()
    draw_maps(table, tmp_path / "maps", MapChoice())
    assert (tmp_path / names[0]).read_bytes() == first
    assert b"A &lt;title&gt; &amp; more" in first
    assert svg_of(sweep_map(table, "outcome", MapChoice())).encode() == first


def test_one_axis_makes_a_curve(tmp_path):
    assert draw_maps(table_of(FREQUENCY), tmp_path / "maps", MapChoice()) == ["maps/rotation.svg"]
    assert draw_maps(table_of(MODEL), tmp_path / "words", MapChoice()) == [
        "maps/rotation.svg".replace("maps", "words")
    ]
