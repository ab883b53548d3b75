"""Pictures and movies: the container in place and to scale, and a clear message where none can be made."""

import dataclasses
import math
import shutil

import numpy as np
import pytest
from interrupted_runs import stored_run
from PIL import Image

import fem
import fem.render.picture
from fem import __main__ as command_line
from fem.render import opengl as rendering
from fem.render.picture import Scene, caption, time_of_largest_rotation, write_movie, write_picture
from fem.render.scene import summarise_frames
from fem.results.errors import FolderError
from fem.results.fields import FieldError


@pytest.fixture(scope="session")
def renders():
    """Skips where nothing can be rendered."""
    reason = rendering.probe_rendering()
    if reason is not None:
        pytest.skip(f"no pictures on this machine: {reason}; {rendering.MEND_PICTURES}")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A stack that rocks on a moving floor, with stresses."""
    keys = ("output.figures=false", "solver.element_size_m=0.5", "solver.elastic_modes=4")
    case = fem.load_case("rocking", [*keys, "solver.duration_s=1", "output.fields_s=0.1"])
    return stored_run(case, tmp_path_factory.mktemp("pictures") / "r", band=False)


@pytest.fixture(scope="module")
def scene(run, renders):
    """Of that run."""
    made = Scene(run)
    yield made
    made.close()


def colour_of(image, place):
    return np.array(image.convert("RGB").getpixel(place), dtype=float)


def pixel(view, x, z):
    """Where a place of the elevation lies in the picture."""
    left, _, low, _ = view.edges
    scale = view.pixels_per_metre
    return int((x - left) * scale), int(view.size[1] - (z - low) * scale)


class TestView:
    def test_it_encloses_the_whole_motion_at_one_scale(self, run):
        frames = list(run.fields)
        view = summarise_frames(frames).view
        left, right, low, high = view.edges
        assert (right - left) * view.pixels_per_metre == pytest.approx(view.size[0])
        assert (high - low) * view.pixels_per_metre == pytest.approx(view.size[1])
        for frame in frames:
            places = frame.points + frame.displacement
            assert left < places[:, 0].min() and places[:, 0].max() < right
            assert low < places[:, 1].min() and places[:, 1].max() < high


class TestScene:
    def test_the_container_is_where_the_fields_say(self, run, scene):
        for index in (0, len(run.fields) - 1):
            frame = run.fields.frame(index)
            image = scene.image(frame)
            middle = (frame.points + frame.displacement).mean(axis=0)
            assert colour_of(image, pixel(scene.view, *middle)).min() < 225.0  # not the white behind it
            corner = (frame.points + frame.displacement)[np.argmax(frame.points @ (1.0, 1.0))]
            assert colour_of(image, pixel(scene.view, corner[0] + 0.1, corner[1])).min() > 250.0
            assert colour_of(image, pixel(scene.view, middle[0], -0.9 * scene.view.depth)).min() < 250.0

    def test_the_mark_moves_with_the_floor_and_the_ruler_does_not(self, run, scene):
        frame = run.fields.frame(0)
        moved = dataclasses.replace(frame, floor_displacement=0.3)
        first, second = scene.image(frame), scene.image(moved)
        at = -0.15 * scene.view.depth
        assert colour_of(first, pixel(scene.view, 0.0, at)).max() < 60.0
        assert colour_of(second, pixel(scene.view, 0.0, at)).max() > 100.0
        assert colour_of(second, pixel(scene.view, 0.3, at)).max() < 60.0
        foot = (0, first.height - 25, 200, first.height)
        assert np.array_equal(np.asarray(first.crop(foot)), np.asarray(second.crop(foot)))


def test_the_grid_of_an_elastic_container_is_coloured_by_its_stress(run):
    assert run.grid(0.5).point_data["von_mises_Pa"] == pytest.approx(run.frame(0.5).von_mises)
    assert run.frame(0.5).von_mises.max() > 1.37e7  # its weight on two of its four posts, 98.1 kN on 7168 mm2


def test_the_default_instant_is_that_of_the_largest_rotation(run, renders):
    rotation = np.interp(run.fields.times, run.history["time_s"], np.abs(run.history["rotation_rad"]))
    instant = run.fields.times[np.argmax(rotation)]
    assert time_of_largest_rotation(run) == instant
    path = write_picture(run)
    assert path == run.folder / "figures" / f"picture_{instant:.3f}s.png"
    with Image.open(path) as image:
        assert image.format == "PNG"


def test_the_caption_gives_time_rotation_and_ratio(run):
    frame = run.frame(0.8)
    sample = np.searchsorted(run.history["time_s"], 0.8 - 1e-9)
    rotation = run.history["rotation_rad"][sample]
    title, lines = caption(run, frame)
    when, turned = lines.split("\n")
    assert title == "Rocking stack"
    assert when.startswith("t = 0.800 s") and run.history.modes[sample] in when
    assert f"{abs(math.degrees(rotation)):.2f}°" in turned
    assert turned.endswith(f"{abs(rotation) / run.slenderness_angle:.3f}")


def test_a_gif_is_in_real_time(run, renders, tmp_path):
    path, shown, duration = tmp_path / "film.gif", 4, 200
    write_movie(run, path, begin=0.2, until=0.8, rate=5.0)
    with Image.open(path) as film:
        assert (film.format, film.n_frames, film.info["duration"]) == ("GIF", shown, duration)
        assert film.size == Scene(run).view.size
        film.seek(0)
        first = np.asarray(film.convert("RGB"), dtype=float)
        film.seek(shown - 1)
        assert np.abs(np.asarray(film.convert("RGB"), dtype=float) - first).max() > 100.0
    assert [entry.name for entry in tmp_path.iterdir()] == ["film.gif"]


def test_without_the_encoder_an_mp4_is_refused_with_the_way_out(run, tmp_path, monkeypatch):
    monkeypatch.setattr(fem.render.picture, "find_spec", lambda name: None)
    with pytest.raises(FolderError, match=r"pip install 'imageio\[ffmpeg\]'"):
        write_movie(run, tmp_path / "film.mp4", begin=0.0, until=9.0, rate=25.0)


def test_a_damaged_frame_leaves_no_half_written_movie(run, renders, tmp_path):
    shutil.copytree(run.folder, tmp_path / "copy")
    (tmp_path / "copy" / "fields" / "frame_00007.vtu").write_text("<VTKFile")
    with pytest.raises(FieldError, match="frame_00007"):
        write_movie(fem.open_run(tmp_path / "copy"), tmp_path / "film.gif", begin=0.0, until=9.0, rate=25.0)
    assert not list(tmp_path.glob("*film*"))


def test_the_file_of_a_picture_is_named(run, renders, capsys, tmp_path):
    target = ["--to", str(tmp_path / "a.png")]
    assert command_line.main(["picture", str(run.folder), "--time", "0.5", *target]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "a.png")
    assert (tmp_path / "a.png").is_file()
