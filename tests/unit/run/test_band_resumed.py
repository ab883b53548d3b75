"""An interrupted band continues with its finished members and gives the undisturbed band."""

import re
from functools import partial
from pathlib import Path

import pytest
from interrupted_runs import one_slice, require_same, run_command

import fem.run.simulation
from fem.__main__ import main
from fem.case.case import case_hash
from fem.results.kinds import read_result
from fem.run import band

SHORT = (
    *("solver.duration_s=0.5", "solver.element_size_m=0.5", "output.fields_s=0", "output.figures=false"),
    "uncertainty.draws=2",
)
#: fewer members
HELD = (
    *("centroid_m", "eccentricity_m", "effective_width", "slope_percent", "mu_static"),
    *("ramp", "weakening_m", "stribeck_velocity_m_s", "support", "normal_penalty_Pa_m"),
    *("bearing_strength_Pa", "floor_youngs_modulus_Pa", "restitution_over_housner"),
)
FEW = tuple(f"uncertainty.{name}=held" for name in HELD)
RIGID = ("solver.model=rigid", "uncertainty.draws=0", *FEW)


def command(folder: Path, *overrides: str) -> list[str]:
    return [*run_command("rocking", folder, *SHORT, *overrides), "--band"]


@pytest.fixture(scope="module", autouse=True)
def one_by_one():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fem.run.simulation, "SLICE_REDUCED", 0.2)
        patch.setattr(fem.run.simulation, "FIRST_PAUSE", 400)
        patch.setattr(band, "cores", lambda: 1)
        patch.setattr(band, "SHORT_S", 0.0)  # each member is stepped in pauses and noted
        yield


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of the undisturbed run."""
    folder = tmp_path_factory.mktemp("whole") / "run"
    assert main(command(folder, *RIGID)) == 0
    return folder


def test_a_band_cut_off_after_every_member_is_the_band_left_alone(tmp_path, monkeypatch, whole):
    stepping, begun, cuts = band.simulate, [], 0

    def step(model, recorder, **options):
        begun.append(case_hash(model.case))
        if len(begun) > 1:  # the second member of this attempt is interrupted at its first pause
            return one_slice(stepping, model, recorder, **options)
        return stepping(model, recorder, **options)

    monkeypatch.setattr(band, "simulate", step)
    finished = []
    while main(command(tmp_path / "cut", *RIGID)) == 4:
        assert read_result(tmp_path / "cut" / "run.json")["verdict"]["band"] is None
        finished.append(begun[0])
        begun.clear()
        cuts += 1
    assert cuts >= 2 and len(set(finished)) == cuts  # nothing that is finished is stepped twice
    require_same(tmp_path / "cut", whole)


def test_members_that_cannot_be_trusted_are_reported_and_computed_again(tmp_path, monkeypatch, capsys, whole):
    with monkeypatch.context() as patch:
        patch.setattr(band, "simulate", partial(one_slice, band.simulate))
        assert main(command(tmp_path / "cut", *RIGID)) == 4
    (tmp_path / "cut" / "band.json").write_text('{"case_hash": "theirs"}')
    capsys.readouterr()
    assert main(command(tmp_path / "cut", *RIGID)) == 0  # and -q
    message = " ".join(capsys.readouterr().err.split())
    assert re.search(r"band.json is refused \([^)]*another case", message), message
    require_same(tmp_path / "cut", whole)
