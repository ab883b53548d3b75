"""Figures: what is drawn are the run's numbers, whole and readable, and a run does not hang on them."""

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from floors import still_floor
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.legend import Legend

import fem
import fem.figures.cache
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking
from fem.figures import style
from fem.figures.cache import drawings_of
from fem.figures.run import FIGURES, figures_of
from fem.html.units import rounded
from fem.model.container import discretise
from fem.run.run import RunOptions, run_case
from fem.runtime.progress import Reporter

#: of a run that has all but a recorded motion
ALL = [name for name in (*FIGURES, "modes") if name != "spectrum"]
ALWAYS = {*ALL} - {"band", "rigid_check", "joints"}


@pytest.fixture(scope="module")
def runs(gallery):
    """Driven rocking with a check and a band, a fall, a slide, a container at rest on a floor that does not move."""
    return {name: gallery.run(name) for name in ("rigid", "overturned", "slides", "rests")}


@pytest.fixture(scope="module")
def drawn(runs):
    return {name: figures_of(run) for name, run in runs.items()}


def lines(axes, label):
    return [line for line in axes.lines if str(line.get_label()).startswith(label)]


def test_every_run_leaves_its_figures_as_svg(runs):
    for name, run in runs.items():
        joints = {"joints"} if run.history.joints else set()
        files = list(run.place.figures.glob("*.svg"))
        assert {path.stem for path in files} == ({*ALL} if name == "rigid" else ALWAYS | joints)
        for path in files:
            assert ElementTree.parse(path).getroot().tag == "{http://www.w3.org/2000/svg}svg"
            assert path.stat().st_size < 200_000


def test_a_report_reuses_the_figures_in_the_folder_as_long_as_they_are_those_of_the_run(
    gallery, tmp_path, monkeypatch
):
    run = fem.open_run(gallery.copy("rigid", tmp_path))
    container = discretise(run.case)
    monkeypatch.setattr("fem.figures.cache._draw", lambda *_: [])  # drawn again: nothing
    assert list(drawings_of(run, container)) == ALL
    svg, drawn = run.place.figures / "slip.svg", run.place.drawn
    for path, text in (
        (svg, svg.read_text().replace("<g", "<script/><g", 1)),
        (drawn, "{}"),
        (run.place.history, run.place.history.read_text() + "\n"),
        (drawn, drawn.read_text().replace("sources", "other sources")),
        (drawn, drawn.read_text().replace('"slip"', '"../figures/slip"')),
    ):
        whole = path.read_text()
        path.write_text(text)
        assert not drawings_of(run, container)
        path.write_text(whole)
    assert drawings_of(run, container)
    svg.unlink()
    assert not drawings_of(run, container)


def test_axes_carry_units_and_no_text_is_cut_off(drawn):
    for name in ("rigid", "rests"):
        for kind, figure in drawn[name].items():
            canvas = FigureCanvasAgg(figure)
            with style.house_style():
                canvas.draw()
            for axes in figure.axes:
                rows = axes.get_ylabel() == ""  # names of states or of energies stand there
                assert rows or re.search(r"\[.+\]$", axes.get_ylabel()), (name, kind)
                assert axes.get_xlabel() == "" or re.search(r"\[.+\]$", axes.get_xlabel()), (name, kind)
            assert re.search(r"\[.+\]$", figure.axes[-1].get_xlabel()), (name, kind)
            outer = figure.bbox.padded(1.0)
            for text in (
                *figure.texts,
                *figure.findobj(Legend),
                *(panel.xaxis.label for panel in figure.axes),
            ):
                if isinstance(text, Legend) or text.get_text():
                    box = text.get_window_extent(canvas.get_renderer())
                    assert outer.x0 <= box.x0 and box.x1 <= outer.x1, (name, kind, str(text))
                    assert outer.y0 <= box.y0 and box.y1 <= outer.y1, (name, kind, str(text))


def test_the_largest_rotation_is_on_the_curve_in_degrees(runs, drawn):
    for name in ("rigid", "overturned"):
        (curve,) = lines(drawn[name]["rotation"].axes[0], "rigid model")
        largest = np.abs(runs[name].history["rotation_rad"]).max()
        assert np.abs(curve.get_ydata()).max() == pytest.approx(math.degrees(largest), rel=1e-12)


def test_the_rigid_block_stands_beside_the_run(runs, drawn):
    (block,) = lines(drawn["rigid"]["rotation"].axes[0], "rigid block")
    expected = np.degrees(runs["rigid"].rigid_check["analytic_rotation_rad"])
    assert np.nanmax(block.get_ydata()) == pytest.approx(np.nanmax(expected), rel=1e-12)
    assert lines(drawn["overturned"]["rotation"].axes[0], "rigid block") == []
    difference = drawn["rigid"]["rigid_check"].axes[1].lines
    assert any(np.ptp(line.get_ydata()) > 0.0 for line in difference)


def test_a_free_block_returns_from_within_the_curve_of_the_phase_portrait(drawn):
    (bound,) = lines(drawn["rigid"]["phase_portrait"].axes[0], "a free rigid block")
    tilt, rate = np.radians(bound.get_xdata()), np.radians(bound.get_ydata())
    block = RigidBlock.homogeneous(width=1.1, height=4.0)
    for index in (60, 100, 140):  # of the upper half: falling back, upright, tilted away
        for factor, falls in ((0.98, False), (1.02, True)):
            start = {"rotation": abs(tilt[index]), "angular_velocity": factor * rate[index]}
            motion = simulate_rocking(block, still_floor(), duration=20.0, **start)
            assert (motion.overturned_at is not None) == falls, (index, factor)


def test_what_bolts_hold_is_drawn_from_the_instant_that_an_unbolted_joint_opens_or_slides(runs, drawn):
    run, figure = runs["rigid"], drawn["rigid"]["joints"]
    joints = run.result["joints"]
    tension, shear = figure.axes[:2]
    for fill, key, first in (
        (tension.collections[0], "bolt_tension_left_N", None),
        (tension.collections[1], "bolt_tension_right_N", None),
        (shear.collections[0], "bolt_shear_N", "slides_at_s"),
    ):
        time, force = fill.get_paths()[0].vertices.T
        assert 1e3 * np.abs(force).max() == pytest.approx(max(joint[key] for joint in joints))
        if first:
            assert time[force != 0.0].min() == min(joint[first] for joint in joints if joint[first])
    held = [fill.get_paths()[0].vertices for fill in tension.collections]
    opened = min(path[path[:, 1] != 0.0, 0].min() for path in held)
    assert opened == min(joint["opens_at_s"] for joint in joints if joint["opens_at_s"])
    assert "joints" not in drawn["slides"]  # one box


def test_no_peak_is_lost_in_a_long_curve():
    values = np.sin(np.linspace(0.0, 60.0, 200_000))
    values[[1234, 150_000]] = 7.0, -8.0
    kept = style.kept_samples(values)
    assert {0, 1234, 150_000, 199_999} <= set(kept.tolist())
    assert len(kept) <= 4 * style.STRETCHES
    assert (np.diff(kept) > 0).all()
    assert style.kept_samples(values[:1000]).tolist() == list(range(1000))
    both = style.kept_samples(values, np.roll(values, 5))
    assert {1234, 1239} <= set(both.tolist())
    values[100:] = np.nan  # a block no longer followed
    assert style.kept_samples(values)[-1] == 199_999


def test_a_fault_in_the_drawing_does_not_spoil_a_run(tmp_path, monkeypatch):
    def full(run, container):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(fem.figures.cache, "write_figures", full)
    messages, reporter = [], Reporter()
    monkeypatch.setattr(reporter, "message", messages.append)
    keys = ["floor.kind=rigid", "solver.model=rigid", "motion.kind=none", "solver.duration_s=0.5"]
    case, alone = fem.load_case("seed_box", keys), RunOptions(band=False, margin=False)
    run = run_case(case, case_text="", folder=tmp_path / "r", options=alone, reporter=reporter)
    assert run.status == "completed"
    assert "figures were not drawn (OSError: [Errno 28] No space left on device)" in messages[-1]


@pytest.mark.parametrize(
    ("value", "text"),
    [(1349.6, "1350"), (-0.00184, "−0.00184"), (0.0, "0"), (5e-9, "5 × 10⁻⁹"), (15.376, "15.4")],
)
def test_numbers_are_for_people(value, text):
    assert rounded(value) == text
