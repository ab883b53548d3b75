"""A band interrupted within a member continues there and gives the undisturbed band."""

import json
import re
import signal
import subprocess
import sys
import zipfile
from functools import partial
from pathlib import Path

import pytest
from interrupted_runs import COARSE, one_slice, require_same, run_command

import fem.run.simulation
from fem.__main__ import main
from fem.case.case import case_hash
from fem.results.archive import write_archive
from fem.results.kinds import read_result
from fem.run import band
from fem.run.band_checkpoint import BandCheckpoint
from fem.runtime.identity import program_identity

SHORT = ("solver.duration_s=0.5", "output.fields_s=0", "output.figures=false", "uncertainty.draws=2")
MODELS = {"reduced, side by side": (), "full": (*COARSE, "solver.duration_s=0.06")}
#: the command line with a checkpoint after every slice, which waits for ever when its third member has had so many
KILLED = """
import sys, time
import fem.run.checkpoint, fem.run.simulation
from fem.run import band
fem.run.checkpoint.CHECKPOINT_S = 0.0
fem.run.simulation.SLICE_REDUCED = fem.run.simulation.SLICE_FULL = 0.02
band.cores = lambda: 1
band.SHORT_S = 0.0
write, count = fem.run.checkpoint.write_archive, [0]
def write_and_wait(path, about, arrays):
    write(path, about, arrays)
    count[0] += path.name == "member_3.npz"
    if count[0] == 3:
        print(flush=True)
        time.sleep(600.0)
fem.run.checkpoint.write_archive = write_and_wait
from fem.__main__ import main
main(sys.argv[1:])
"""


def command(folder: Path, *overrides: str) -> list[str]:
    return [*run_command("rocking", folder, *SHORT, *overrides), "--band"]


@pytest.fixture
def short_slices(monkeypatch):
    monkeypatch.setattr(fem.run.simulation, "SLICE_FULL", 0.02)
    monkeypatch.setattr(fem.run.simulation, "SLICE_REDUCED", 0.2)
    monkeypatch.setattr(fem.run.simulation, "FIRST_PAUSE", 400)
    monkeypatch.setattr(band, "SHORT_S", 0.0)  # each member has a history and a checkpoint


@pytest.mark.parametrize("model", MODELS)
def test_a_band_cut_off_after_every_slice_is_the_band_left_alone(tmp_path, monkeypatch, short_slices, model):
    assert main(command(tmp_path / "whole", *MODELS[model])) == 0
    stepping, cuts, reached = band.simulate, 0, {}

    def step(model, recorder, **options):
        case, clock = case_hash(model.case), model.run.clock[0]
        assert float(clock.time) == reached.get(case, 0.0)  # nothing is stepped twice
        ending = one_slice(stepping, model, recorder, **options)
        reached[case] = float(clock.time)
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
    require_same(tmp_path / "cut", tmp_path / "whole")


def test_a_band_killed_within_a_member_continues_from_its_last_checkpoint(
    tmp_path, monkeypatch, short_slices
):
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
    # Two members were finished; the third continues from its last checkpoint, the others begin.
    assert reached > 0.0
    assert sorted(beginnings) == [0.0, 0.0, 0.0, reached]
    require_same(tmp_path / "cut", tmp_path / "whole")


def test_checkpoints_of_a_band_that_cannot_be_trusted_are_reported_and_computed_again(
    tmp_path, monkeypatch, short_slices, capsys
):
    rigid = ("solver.model=rigid",)
    assert main(command(tmp_path / "whole", *rigid)) == 0
    monkeypatch.setattr(band, "cores", lambda: 1)
    with monkeypatch.context() as patch:
        patch.setattr(band, "simulate", partial(one_slice, band.simulate))
        assert main(command(tmp_path / "cut", *rigid)) == 4
    members = tmp_path / "cut" / "members"
    (members / "member_1.npz").write_bytes(b"PK\x03\x04")
    write_archive(members / "member_2.npz", {"case_hash": "theirs", "program": program_identity()}, {})
    write_archive(members / "member_3.npz", {"case_hash": "ours", "program": {"numpy": "1.0"}}, {})
    (tmp_path / "cut" / "band.json").write_text('{"case_hash": "theirs"}')
    capsys.readouterr()
    assert main(command(tmp_path / "cut", *rigid)) == 0  # and -q
    message = " ".join(capsys.readouterr().err.split())
    for name, reason in {
        "band.json": "another case",
        "member_1.npz": "damaged",
        "member_2.npz": "another case",
        "member_3.npz": "another version",
    }.items():
        assert re.search(rf"{name} is refused \([^)]*{reason}", message), message
    assert message.count("starts over at t = 0") == 3
    require_same(tmp_path / "cut", tmp_path / "whole")


def test_a_band_that_cannot_be_stored_ends_at_once(tmp_path, monkeypatch):
    def no_room(*_):
        raise OSError(28, "No space left on device", "band.json")

    monkeypatch.setattr(BandCheckpoint, "write_members", no_room)
    begun, stepping = [], band.simulate
    monkeypatch.setattr(
        band, "simulate", lambda *rest, **options: begun.append(1) or stepping(*rest, **options)
    )
    monkeypatch.setattr(band, "cores", lambda: 1)
    monkeypatch.setattr(band, "SHORT_S", 0.0)
    assert main(command(tmp_path / "r", "solver.model=rigid")) == 3
    assert len(begun) == 1
    assert read_result(tmp_path / "r" / "run.json")["status"] == "completed"
