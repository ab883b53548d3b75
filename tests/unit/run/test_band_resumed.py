"""An interrupted band continues with its finished members and gives the undisturbed band."""

import json
import re
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest
from interrupted_runs import COARSE, one_slice, require_same, run_command

import fem.run.simulation
from fem.__main__ import main
from fem.case.case import case_hash
from fem.results.kinds import read_result
from fem.results.run_result import ChangedRun
from fem.run import changed_runs
from fem.run.changed_runs import ChangedRunsFile

SHORT = (
    "solver.duration_s=0.5",
    "solver.element_size_m=0.5",
    "output.fields_s=0",
    "output.figures=false",
    "uncertainty.draws=2",
)
#: fewer members
HELD = (
    *("centroid_m", "eccentricity_m", "effective_width", "slope_percent", "mu_static"),
    *("ramp", "weakening_m", "stribeck_velocity_m_s", "support", "normal_penalty_Pa_m"),
    *("bearing_strength_Pa", "floor_youngs_modulus_Pa", "restitution_over_housner"),
)
FEW = tuple(f"uncertainty.{name}=held" for name in HELD)
MODELS = {
    "rigid": ("solver.model=rigid", "uncertainty.draws=0", *FEW),
    "full": (*COARSE, "solver.duration_s=0.06"),
}
#: the command line, which waits for ever when its third member begins
KILLED = """
import sys, time
from fem.run import changed_runs
changed_runs.cores = lambda: 1
stepping, count = changed_runs.simulate, [0]
def step_or_wait(*arguments, **options):
    count[0] += 1
    if count[0] == 3:
        print(flush=True)
        time.sleep(600.0)
    return stepping(*arguments, **options)
changed_runs.simulate = step_or_wait
from fem.__main__ import main
main(sys.argv[1:])
"""


def command(folder: Path, *overrides: str) -> list[str]:
    return [*run_command("rocking", folder, *SHORT, *overrides), "--band"]


@pytest.fixture
def one_by_one(monkeypatch):
    monkeypatch.setattr(fem.run.simulation, "SLICE_FULL", 0.02)
    monkeypatch.setattr(fem.run.simulation, "SLICE_REDUCED", 0.2)
    monkeypatch.setattr(fem.run.simulation, "FIRST_PAUSE", 400)
    monkeypatch.setattr(changed_runs, "cores", lambda: 1)
    monkeypatch.setattr(changed_runs, "SHORT_S", 0.0)  # each member is stepped in pauses and noted


@pytest.mark.parametrize("model", ["rigid", pytest.param("full", marks=pytest.mark.slow)])
def test_a_band_cut_off_after_every_member_is_the_band_left_alone(tmp_path, monkeypatch, one_by_one, model):
    assert main(command(tmp_path / "whole", *MODELS[model])) == 0
    stepping, begun, cuts = changed_runs.simulate, [], 0

    def step(model, recorder, **options):
        begun.append(case_hash(model.case))
        if len(begun) > 1:  # the second member of this attempt is interrupted at its first pause
            return one_slice(stepping, model, recorder, **options)
        return stepping(model, recorder, **options)

    monkeypatch.setattr(changed_runs, "simulate", step)
    finished = []
    while main(command(tmp_path / "cut", *MODELS[model])) == 4:
        assert read_result(tmp_path / "cut" / "run.json")["verdict"]["band"] is None
        finished.append(begun[0])
        begun.clear()
        cuts += 1
    assert cuts >= 2 and len(set(finished)) == cuts  # nothing that is finished is stepped twice
    require_same(tmp_path / "cut", tmp_path / "whole")


@pytest.mark.slow
def test_a_band_killed_within_a_member_continues_with_the_finished_ones(tmp_path, monkeypatch, one_by_one):
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
    stepping, begun = changed_runs.simulate, []

    def step(model, recorder, **options):
        begun.append(case_hash(model.case))
        return stepping(model, recorder, **options)

    monkeypatch.setattr(changed_runs, "simulate", step)
    assert main(command(tmp_path / "cut", *MODELS["full"])) == 0
    assert len(begun) == 4  # of six
    require_same(tmp_path / "cut", tmp_path / "whole")


def test_members_that_cannot_be_trusted_are_reported_and_computed_again(
    tmp_path, monkeypatch, one_by_one, capsys
):
    rigid = MODELS["rigid"]
    assert main(command(tmp_path / "whole", *rigid)) == 0
    with monkeypatch.context() as patch:
        patch.setattr(changed_runs, "simulate", partial(one_slice, changed_runs.simulate))
        assert main(command(tmp_path / "cut", *rigid)) == 4
    (tmp_path / "cut" / "band.json").write_text('{"case_hash": "theirs"}')
    capsys.readouterr()
    assert main(command(tmp_path / "cut", *rigid)) == 0  # and -q
    message = " ".join(capsys.readouterr().err.split())
    assert re.search(r"band.json is refused \([^)]*another case", message), message
    require_same(tmp_path / "cut", tmp_path / "whole")


def test_a_band_that_cannot_be_stored_ends_at_once(tmp_path, monkeypatch):
    def no_room(*_):
        raise OSError(28, "No space left on device", "band.json")

    monkeypatch.setattr(ChangedRunsFile, "store", no_room)
    begun, stepping = [], changed_runs.simulate
    monkeypatch.setattr(
        changed_runs, "simulate", lambda *rest, **options: begun.append(1) or stepping(*rest, **options)
    )
    monkeypatch.setattr(changed_runs, "cores", lambda: 1)
    monkeypatch.setattr(changed_runs, "SHORT_S", 0.0)
    assert main(command(tmp_path / "r", "solver.model=rigid")) == 3
    assert len(begun) == 1
    assert read_result(tmp_path / "r" / "run.json")["status"] == "completed"


def test_the_file_of_members_does_not_depend_on_which_were_finished_first(tmp_path):
    members = [
        ChangedRun(kind="one", values=values, status="completed", outcome="rock")
        for values in ({"contact.mu_static": 0.3}, {"support.kind": "flat"}, {"contact.mu_static": 0.44})
    ]
    texts = []
    for order in (members, members[::-1]):
        file = ChangedRunsFile(tmp_path / "m.json", case_hash="h", write=texts.append, message=print)
        file.store(order)
    assert texts[0] == texts[1]
    (tmp_path / "m.json").write_text(texts[0], encoding="utf-8")
    assert sorted(map(repr, file.read())) == sorted(map(repr, members))
