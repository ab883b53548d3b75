"""A band that is cut off amid a member goes on there, and comes to the band of the run left alone."""

import json
import signal
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from interrupted_runs import COARSE, one_slice, same

import fem.run.simulation
from fem.__main__ import main
from fem.case.case import case_hash, load_case
from fem.model.model import build_model
from fem.results.archive import write_archive
from fem.results.lock import locked_folder
from fem.results.run_folder import RunFolder, read_result
from fem.run import band
from fem.run import band_checkpoint as band_keeping
from fem.run.band_checkpoint import BandFolder
from fem.run.checkpoint import read_beginning
from fem.run.recorder import Recorder
from fem.run.simulation import Progress
from fem.runtime.identity import program_identity
from fem.runtime.progress import SilentReporter

SHORT = ("solver.duration_s=0.5", "output.fields_s=0", "output.figures=false")
MODELS = {"reduced, side by side": (), "full": (*COARSE, "solver.duration_s=0.06")}
#: the command line with a checkpoint after every slice, which waits for ever when its third member has had so many
KILLED = """
import sys, time
import fem.run.checkpoint, fem.run.simulation
from fem.run import band
fem.run.checkpoint.CHECKPOINT_S = 0.0
fem.run.simulation.SLICE_REDUCED = fem.run.simulation.SLICE_FULL = 0.02
band.cores = lambda: 1
keep, count = fem.run.checkpoint.CheckpointKeeper.keep, [0]
def keep_and_wait(self, progress, *, at_once=False):
    keep(self, progress, at_once=at_once)
    count[0] += self._path.name == "member_3.npz"
    if count[0] == 3:
        print(flush=True)
        time.sleep(600.0)
fem.run.checkpoint.CheckpointKeeper.keep = keep_and_wait
from fem.__main__ import main
main(sys.argv[1:])
"""


def command(folder: Path, *overrides: str) -> list[str]:
    changes = [word for override in (*SHORT, *overrides) for word in ("--set", override)]
    return ["run", "rocking", "--band", "-q", "--out", str(folder), *changes]


@pytest.fixture
def short_slices(monkeypatch):
    monkeypatch.setattr(fem.run.simulation, "SLICE_FULL", 0.02)
    monkeypatch.setattr(fem.run.simulation, "SLICE_REDUCED", 0.2)
    monkeypatch.setattr(fem.run.simulation, "FIRST_PAUSE", 400)


@pytest.mark.parametrize("model", MODELS)
def test_a_band_cut_off_after_every_slice_is_the_band_left_alone(tmp_path, monkeypatch, short_slices, model):
    assert main(command(tmp_path / "whole", *MODELS[model])) == 0
    stepping, cuts, reached = band.simulate, 0, {}

    def step(model, recorder, **options):
        floor, clock = (model.penalty, model.case.contact.damping_ratio), model.run.clock[0]
        assert float(clock.time) == reached.get(floor, 0.0)  # nothing is stepped twice
        ending = one_slice(stepping, model, recorder, **options)
        reached[floor] = float(clock.time)
        return ending

    monkeypatch.setattr(band, "simulate", step)
    while True:
        code = main(command(tmp_path / "cut", *MODELS[model]))
        if code == 0:
            break
        assert code == 4
        assert read_result(tmp_path / "cut" / "run.json")["verdict"]["band"] is None
        assert list((tmp_path / "cut" / "members").iterdir())
        cuts += 1
    assert cuts >= 2
    same(tmp_path / "cut", tmp_path / "whole")


def test_a_band_killed_amid_a_member_goes_on_from_its_last_checkpoint(tmp_path, monkeypatch, short_slices):
    assert main(command(tmp_path / "whole", *MODELS["full"])) == 0
    process = subprocess.Popen(
        [sys.executable, "-c", KILLED, *command(tmp_path / "cut", *MODELS["full"])], stdout=subprocess.PIPE
    )
    try:
        assert process.stdout.readline()
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
        process.stdout.close()
    assert len(json.loads((tmp_path / "cut" / "band.json").read_text())["members"]) == 2
    with zipfile.ZipFile(tmp_path / "cut" / "members" / "member_3.npz") as checkpoint:
        reached = json.loads(checkpoint.read("about.json"))["time_s"]
    stepping, beginnings = band.simulate, []

    def step(model, recorder, **options):
        beginnings.append(float(model.run.clock[0].time))
        return stepping(model, recorder, **options)

    monkeypatch.setattr(band, "simulate", step)
    assert main(command(tmp_path / "cut", *MODELS["full"])) == 0
    # Two members were finished; the third goes on from its last checkpoint, the others begin.
    assert reached > 0.0
    assert sorted(beginnings) == [0.0, 0.0, reached]
    same(tmp_path / "cut", tmp_path / "whole")


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", "another case"])
def test_a_members_checkpoint_that_cannot_be_trusted_is_named_and_begun_anew(tmp_path, content):
    model = build_model(load_case("rocking", [*SHORT, "solver.model=rigid"]))
    messages: list[str] = []
    reporter = SilentReporter()
    reporter.warning = messages.append
    place = RunFolder(path=tmp_path)
    path = place.member_checkpoint(2)
    path.parent.mkdir()
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        write_archive(path, {"case_hash": content, "program": program_identity()}, {})
    with locked_folder(tmp_path) as lock:
        keeping = BandFolder(place, lock, case_hash="ours", reporter=reporter)
        keeper, progress = keeping.begin(2, model, Recorder(model))
        assert (progress, float(model.run.clock[0].time)) == (Progress(), 0.0)
        keeper.keep(progress, at_once=True)  # in its place
    (message,) = messages
    assert str(path) in message
    assert "starts over" in message
    assert read_beginning(path, model, case_hash(model.case)).progress == Progress()


def test_a_band_that_cannot_be_kept_ends_at_once(tmp_path, monkeypatch):
    def no_room(*_):
        raise OSError(28, "No space left on device", "band.json")

    monkeypatch.setattr(band_keeping, "write_members", no_room)
    begun, stepping = [], band.simulate
    monkeypatch.setattr(
        band, "simulate", lambda *rest, **options: begun.append(1) or stepping(*rest, **options)
    )
    monkeypatch.setattr(band, "cores", lambda: 1)
    assert main(command(tmp_path / "r", "solver.model=rigid")) == 3
    assert len(begun) == 1
    assert read_result(tmp_path / "r" / "run.json")["status"] == "completed"
