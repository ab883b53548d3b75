"""Pictures of recorded motions, and the spectrum of a run on one; its copy in the results."""

import json

import pytest
import record_files as files
from cases import BLOCK
from record_files import G, synthetic_motion

from fem.__main__ import main
from fem.case.case import case_hash, load_case
from fem.figures.motions import spectrum_figure
from fem.results.reader import open_run

FIRST, SECOND, THIRD = synthetic_motion(401)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    (tmp_path / "h.at2").write_text(files.peer(FIRST / G))
    (tmp_path / "one.txt").write_text("".join(f"{value:.6f}\n" for value in FIRST))
    channels = [(100.0 * FIRST, "90 Deg"), (100.0 * SECOND, "360 Deg"), (100.0 * THIRD, "Up")]
    (tmp_path / "station.v2").write_text(files.csmip_v2(channels))
    (tmp_path / "secret.txt").write_text("root:secret:0:0\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_motion_is_drawn_with_its_spectrum(folder, capsys):
    assert main(["picture", "h.at2"]) == 0
    assert capsys.readouterr().out.strip() == "h.png"
    assert (folder / "h.png").read_bytes().startswith(b"\x89PNG")
    assert main(["picture", "station.v2", "--baseline", "zero-end", "--to", "all.svg"]) == 0
    drawn = (folder / "all.svg").read_text()
    for words in ("acceleration [m/s²]", "velocity", "displacement", "period [s]", "90 Deg", "360 Deg", "Up"):
        assert words in drawn
    assert main(["picture", "station.v2#2", "--to", "one.svg"]) == 0
    assert "90 Deg" not in (folder / "one.svg").read_text()
    assert main(["picture", "one.txt", "--unit", "gal", "--sample-interval", "0.01", "--to", "two.svg"]) == 0


def test_a_run_on_a_record_from_elsewhere_holds_its_copy_and_its_spectrum(folder):
    inner = folder / "inner"
    inner.mkdir()
    (inner / "case.toml").write_text(BLOCK)
    command = ["run", "inner/case.toml", "--motion", "station.v2#1", "--out", "out", "-q", "--no-band"]
    assert main([*command, "--set", "vertical.kind=table"]) == 0
    out = folder / "out"
    assert (out / "data" / "station.v2").read_bytes() == (folder / "station.v2").read_bytes()
    resolved = load_case(out / "resolved.toml")
    assert resolved.motion.file == "data/station.v2#1" and resolved.vertical.file is None
    result = json.loads((out / "run.json").read_text())
    assert case_hash(resolved) == result["case_hash"]
    both = result["motion"].keys() & result["motion"]["vertical"]
    assert {"residual_velocity_m_s", "residual_displacement_m"} <= both
    figure = spectrum_figure(open_run(out))
    assert figure is not None and "Response spectrum of the floor's motion" in figure.texts[0].get_text()
    (out / "data" / "station.v2").unlink()
    assert spectrum_figure(open_run(out)) is None


def test_what_is_no_motion_is_neither_copied_nor_shown(folder, capsys):
    (folder / "case.toml").write_text(BLOCK)
    assert main(["run", "case.toml", "--motion", "secret.txt", "--out", "out", "-q", "--no-band"]) == 2
    assert "root" not in capsys.readouterr().err
    assert not list(folder.glob("out/**/secret.txt"))
