"""The band over contact stiffness and damping: which runs it holds, when it is unsure, failed members."""

import itertools
from pathlib import Path

import pytest
from interrupted_runs import run_command

from fem.__main__ import main
from fem.assessment.verdict import verdict_of
from fem.case.case import Case, load_case
from fem.model.model import build_model
from fem.results.kinds import read_result
from fem.results.run_result import BandMember, Verdict
from fem.run.band import summed_up, wants_band
from fem.run.recorder import Recorder
from fem.run.run import RunOptions, run_case
from fem.run.simulation import simulate

SHORT = ["solver.model=rigid", "solver.duration_s=3.0", "output.fields_s=0", "output.figures=false"]


def verdict_with_band(folder: Path, case: Case) -> Verdict:
    found = run_case(case, case_text=case.text, folder=folder, options=RunOptions(band=True))
    return found.typed_result.verdict


@pytest.mark.parametrize(
    ("model", "outcome", "expected"),
    [
        ("reduced", "rock", True),
        ("rigid", "overturned", True),
        ("reduced", "slide", False),
        ("full", "rock", False),
    ],
)
def test_a_band_is_added_where_impacts_decide_and_runs_are_cheap(model, outcome, expected):
    case = load_case("rocking", [f"solver.model={model}"])
    for asked, wanted in ((None, expected), (True, True), (False, False)):
        assert wants_band(asked, case, Verdict(outcome=outcome)) is wanted


@pytest.mark.parametrize(
    ("outcomes", "listed", "unsure"),
    [
        (("rock", "rock", "rock"), ("rock",), False),
        (("overturned", "slide-rock", "rock"), ("rock", "slide-rock", "overturned"), True),
        (("rock", None, "rock"), ("rock",), True),
    ],
    ids=["one outcome", "several, in the order of the states", "a failed member"],
)
def test_a_band_is_sure_of_one_outcome_of_all_members(outcomes, listed, unsure):
    members = [
        BandMember(
            normal_penalty_Pa_m=1e9,
            damping_ratio=2.0,
            status="completed" if outcome else "failed",
            outcome=outcome,
            rotation_ratio=0.2 + 0.1 * k if outcome else None,
        )
        for k, outcome in enumerate(outcomes)
    ]
    found = summed_up(members)
    assert (found.outcomes, found.unsure, found.members) == (listed, unsure, tuple(members))
    assert found.rotation_ratio == pytest.approx((0.2, 0.4))


@pytest.mark.parametrize("ratios", [(2.0, 0.5), (1.2, 0.5, 2.0)], ids=["default", "given"])
def test_members_span_penalty_and_damping_and_include_the_run_itself(tmp_path, ratios):
    case = load_case("rocking", [*SHORT, f"contact.damping_ratio={ratios[0]}"])
    verdict = verdict_with_band(tmp_path, case)
    given, *others = members = verdict.band.members
    floors = {
        (round(one.normal_penalty_Pa_m / given.normal_penalty_Pa_m, 6), one.damping_ratio) for one in members
    }
    assert floors == set(itertools.product((0.333333, 1.0, 3.0), ratios))
    assert len(others) == len(floors) - 1
    assert given.damping_ratio == ratios[0]
    assert (given.outcome, given.rotation_ratio) == (verdict.outcome, verdict.rotation_ratio)


def test_members_side_by_side_are_the_runs_one_by_one(tmp_path):
    # Threads share the container; each member must be to the bit what the case alone gives, whatever runs beside it.
    changes = {"solver.duration_s": 2.0, "output.fields_s": 0, "output.figures": False}
    case = load_case("rocking").with_values(changes)
    for one in verdict_with_band(tmp_path, case).band.members:
        contact = {
            "contact.normal_penalty_Pa_m": one.normal_penalty_Pa_m,
            "contact.damping_ratio": one.damping_ratio,
        }
        model = build_model(case.with_values(contact))
        recorder = Recorder(model)
        simulate(model, recorder)
        assert verdict_of(model, recorder.history(), None).rotation_ratio == one.rotation_ratio


def test_an_outcome_that_does_not_depend_on_the_contact_is_sure(tmp_path):
    case = load_case("overturning", ["solver.model=rigid", "output.fields_s=0", "output.figures=false"])
    found = verdict_with_band(tmp_path, case).band
    assert (found.outcomes, found.unsure) == (("overturned",), False)


def test_a_member_that_fails_is_named_in_a_warning_and_in_the_summary(tmp_path):
    # Newmark without averaging gains energy on a contact beyond 3 E/h and refuses it: h k/E is 2 here, 6 at x 3.
    soft = ("container.youngs_modulus_Pa=1e9", "contact.normal_penalty_Pa_m=2e10")
    changes = (*SHORT, "solver.scheme=newmark", *soft)
    assert main([*run_command("rocking", tmp_path, *changes), "--band"]) == 0
    result = read_result(tmp_path / "run.json")
    found = result["verdict"]["band"]
    failed = [one for one in found["members"] if one["outcome"] is None]
    assert [(one["damping_ratio"], one["status"]) for one in failed] == [(0.5, "failed"), (2.0, "failed")]
    assert all("gains energy" in one["error"] and one["rotation_ratio"] is None for one in failed)
    assert found["unsure"] is True
    first = result["warnings"][0]
    assert first.startswith("unsure:") and "6e+10 Pa/m with damping ratio 0.5" in first
    page = " ".join((tmp_path / "summary.txt").read_text().split())
    assert "2 of 6 failed; unsure" in page and "(unsure, see the band)" in page
