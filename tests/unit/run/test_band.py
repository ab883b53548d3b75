"""The band over contact stiffness and damping: which runs it holds, when it is unsure, what it never hides."""

import threading

import pytest

from fem.__main__ import main
from fem.assessment.verdict import verdict_of
from fem.case.case import Case, load_case
from fem.model.model import Model, build_model
from fem.results.kinds import read_result
from fem.results.run_result import Band, BandMember, Verdict
from fem.run import band
from fem.run.band import band_of, summed_up, wants_band
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

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


@pytest.mark.parametrize(
    ("model", "outcome", "expected"),
    [
        ("reduced", "rock", True),
        ("rigid", "overturned", True),
        ("reduced", "slide", False),
        ("full", "rock", False),
    ],
)
def test_a_band_comes_by_itself_where_impacts_decide_and_runs_are_cheap(model, outcome, expected):
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


def test_an_outcome_that_does_not_depend_on_the_contact_is_sure():
    found = band_around(load_case("overturning", ["solver.model=rigid", "output.fields_s=0"]))
    assert (found.outcomes, found.unsure) == (("overturned",), False)


def test_a_member_that_fails_is_named_in_a_warning_and_in_the_summary(tmp_path):
    # Newmark without averaging gains energy on a contact beyond 3 E/h and refuses it: h k/E is 2 here, 6 at x 3.
    soft = ("container.youngs_modulus_Pa=1e9", "contact.normal_penalty_Pa_m=2e10")
    changes = (*SHORT, "solver.scheme=newmark", *soft, "output.figures=false")
    words = [word for change in changes for word in ("--set", change)]
    assert main(["run", "rocking", "--band", "-q", "--out", str(tmp_path), *words]) == 0
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


def test_a_band_that_is_stopped_is_none():
    case = load_case("rocking", SHORT)
    model, verdict = finished(case)
    assert band_of(case, model.container, penalty=model.penalty, verdict=verdict, stop=lambda: True) is None
