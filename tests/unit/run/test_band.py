"""The band over contact stiffness and damping: which runs it holds, when it is unsure, what it never hides."""

import threading
from dataclasses import replace

import pytest

from fem.assessment.summary import plain_summary
from fem.assessment.verdict import verdict_of
from fem.assessment.warnings import warnings_for
from fem.case.case import Case, load_case
from fem.model.model import Model, build_model
from fem.results.run_result import Band, BandMember, RunResult, Verdict
from fem.run import band
from fem.run.band import band_of, summed_up, wants_band
from fem.run.band_checkpoint import read_members, write_members
from fem.run.recorder import Recorder
from fem.run.simulation import Ending, simulate

SHORT = ["solver.model=rigid", "solver.duration_s=3.0", "output.fields_s=0"]


def finished(case: Case) -> tuple[Model, Verdict]:
    model = build_model(case)
    recorder = Recorder(model)
    assert simulate(model, recorder).error is None
    return model, verdict_of(model, recorder.history(), None)


def band_around(case: Case, **changes) -> Band:
    model, verdict = finished(case)
    found = band_of(case, model.container, penalty=model.penalty, verdict=verdict, **changes)
    assert found is not None
    return found


def member(outcome: str | None, ratio: float | None = 0.3, status: str = "completed") -> BandMember:
    return BandMember(
        normal_penalty_Pa_m=1e9, damping_ratio=2.0, status=status, outcome=outcome, rotation_ratio=ratio
    )


@pytest.mark.parametrize(
    ("model", "outcome", "expected"),
    [
        ("reduced", "rock", True),
        ("reduced", "slide-rock", True),
        ("rigid", "overturned", True),
        ("reduced", "rest", False),
        ("reduced", "slide", False),
        ("full", "rock", False),
    ],
)
def test_a_band_comes_by_itself_where_impacts_decide_and_runs_are_cheap(model, outcome, expected):
    case = load_case("rocking", [f"solver.model={model}"])
    assert wants_band(None, case, Verdict(outcome=outcome)) is expected
    assert wants_band(True, case, Verdict(outcome=outcome)) is True
    assert wants_band(False, case, Verdict(outcome=outcome)) is False


def test_one_outcome_throughout_is_sure():
    found = summed_up([member("rock", 0.2), member("rock", 0.4), member("rock", 0.3)])
    assert found.outcomes == ("rock",)
    assert found.rotation_ratio == (0.2, 0.4)
    assert found.unsure is False


def test_different_outcomes_are_unsure_and_listed_in_the_order_of_the_states():
    found = summed_up([member("overturned", 5.8), member("slide-rock", 0.3), member("rock", 0.4)])
    assert found.outcomes == (
        "rock",
        "slide-rock",
        "overturned",
    )
    assert found.unsure is True


def test_a_failed_member_is_unsure_and_no_outcome():
    found = summed_up([member("rock", 0.4), member(None, None, "failed")])
    assert found.outcomes == ("rock",)
    assert found.rotation_ratio == (0.4, 0.4)
    assert found.unsure is True


def test_members_span_penalty_and_damping_and_hold_the_run_itself():
    case = load_case("rocking", SHORT)
    model, verdict = finished(case)
    found = band_of(case, model.container, penalty=model.penalty, verdict=verdict)
    floors = {(round(one.normal_penalty_Pa_m / model.penalty, 6), one.damping_ratio) for one in found.members}
    assert floors == {(factor, ratio) for factor in (0.333333, 1.0, 3.0) for ratio in (0.5, 2.0)}
    assert len(found.members) == 6
    given = found.members[0]
    assert (given.normal_penalty_Pa_m, given.damping_ratio) == (model.penalty, 2.0)
    assert (given.outcome, given.rotation_ratio) == (verdict.outcome, verdict.rotation_ratio)


def test_a_damping_ratio_of_its_own_is_carried_through_the_penalties():
    found = band_around(load_case("rocking", [*SHORT, "contact.damping_ratio=1.2"]))
    assert len(found.members) == 9
    assert {one.damping_ratio for one in found.members} == {0.5, 1.2, 2.0}


def test_members_side_by_side_are_the_runs_one_by_one():
    # Threads share the container; each member must be to the bit what the case alone gives, whatever ran beside it.
    case = load_case("rocking", ["solver.duration_s=2.0", "output.fields_s=0"])
    found = band_around(case)
    for one in found.members:
        alone = case.with_values(
            {
                "contact.normal_penalty_Pa_m": one.normal_penalty_Pa_m,
                "contact.damping_ratio": one.damping_ratio,
            }
        )
        assert finished(alone)[1].rotation_ratio == one.rotation_ratio


def test_members_run_side_by_side(monkeypatch):
    # Every member waits until another one has begun: one after the other they would wait in vain.
    monkeypatch.setattr(band, "cores", lambda: 2)
    met = threading.Barrier(2, timeout=20.0)
    begun: list[int] = []
    lock = threading.Lock()

    def meet(model, recorder, **options):
        with lock:
            begun.append(1)
            paired = len(begun) <= 2
        if paired:
            met.wait()
        return simulate(model, recorder, **options)

    case = load_case("rocking", SHORT)
    model, verdict = finished(case)
    monkeypatch.setattr(band, "simulate", meet)
    assert band_of(case, model.container, penalty=model.penalty, verdict=verdict) is not None
    assert len(begun) == 5


def test_an_outcome_that_hangs_on_nothing_of_the_contact_is_sure():
    found = band_around(load_case("overturning", ["solver.model=rigid", "output.fields_s=0"]))
    assert found.outcomes == ("overturned",)
    assert found.unsure is False


def test_a_member_that_fails_is_named_in_a_warning_and_in_the_summary(monkeypatch, tmp_path):
    case = load_case("rocking", SHORT)
    model, verdict = finished(case)
    stiffest = 3.0 * model.penalty

    def fail_on_the_stiffest(model, recorder, **options):
        ending = simulate(model, recorder, **options)
        if model.penalty == pytest.approx(stiffest):
            return Ending(status="failed", stepping_cpu_s=0.0, error="made to fail")
        return ending

    monkeypatch.setattr(band, "simulate", fail_on_the_stiffest)
    found = band_of(case, model.container, penalty=model.penalty, verdict=verdict)
    assert found.unsure is True
    failed = [one for one in found.members if one.outcome is None]
    assert [one.status for one in failed] == ["failed", "failed"]
    assert failed[0].error == "made to fail"
    assert failed[0].rotation_ratio is None
    result = RunResult(status="completed", verdict=replace(verdict, band=found)).to_json()
    first = warnings_for(result, case)[0]
    assert first.startswith("unsure:")
    assert f"{stiffest:.3g} Pa/m with damping ratio 0.5" in first
    page = plain_summary(result, title="t", folder=tmp_path, warnings=[first])
    assert "2 of 6 failed; unsure" in " ".join(page.split())
    assert "(unsure, see the band)" in page


def test_a_floor_that_the_scheme_refuses_is_a_failed_member():
    # Newmark without averaging gains energy on a contact beyond 3 E/h and refuses it: h k/E is 2 here, 6 at x 3.
    case = load_case(
        "rocking",
        [
            *SHORT,
            "solver.scheme=newmark",
            "container.youngs_modulus_Pa=1e9",
            "contact.normal_penalty_Pa_m=2e10",
        ],
    )
    found = band_around(case)
    failed = [one for one in found.members if one.outcome is None]
    assert [one.damping_ratio for one in failed] == [0.5, 2.0]
    assert all("gains energy" in one.error for one in failed)
    assert found.unsure is True


def test_a_band_that_is_stopped_is_none():
    case = load_case("rocking", SHORT)
    model, verdict = finished(case)
    assert band_of(case, model.container, penalty=model.penalty, verdict=verdict, stop=lambda: True) is None


@pytest.mark.parametrize("content", ["", "{", "[]", '{"case_hash": "a"}', '{"members": [{"status": 1}]}'])
def test_kept_members_that_cannot_be_trusted_are_passed_over(tmp_path, content):
    (tmp_path / "band.json").write_text(content)
    assert read_members(tmp_path / "band.json", "a") == []
    write_members(tmp_path / "band.json", "a", [member("rock")])
    assert read_members(tmp_path / "band.json", "a") == [member("rock")]
    assert read_members(tmp_path / "band.json", "b") == []
