"""The band of a run: which runs have one, its members, what does not fit the time, failed members."""

from dataclasses import replace
from itertools import chain
from pathlib import Path

import pytest
from interrupted_runs import run_command, stored_run

from fem.__main__ import main
from fem.case.case import Case, load_case
from fem.case.uncertainty import all_changes, as_changed
from fem.model.model import build_model
from fem.model.recovery import recovery_of
from fem.results.kinds import read_result
from fem.results.reader import open_run
from fem.results.run_result import ActionResult, Numerics, RunResult, StaticResult, Verdict
from fem.run import band
from fem.run.band import DRAWN_TOLERANCE, plan_of, run_changes, wants_band
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.run.verdict import joint_demands, verdict_of

COARSE = "solver.element_size_m=0.5"
BARE = [COARSE, "output.fields_s=0", "output.figures=false"]
SHORT = ["solver.model=rigid", "solver.duration_s=3.0", *BARE]
FEW = ["uncertainty.draws=2", "uncertainty.weakening_m=known", "uncertainty.stribeck_velocity_m_s=known"]


def verdict_with_band(folder: Path, case: Case) -> Verdict:
    found = stored_run(case, folder, band=True, margin=False)
    return found.typed_result.verdict


def result(outcome: str, used: float = 1.2, numerics: Numerics | None = None) -> RunResult:
    """A finished run whose static rule is used so far."""
    own = ActionResult(utilisation_sliding=used, utilisation_overturning=used)
    return RunResult(
        status="completed",
        verdict=Verdict(outcome=outcome),
        static=StaticResult(own_motion=own),
        numerics=numerics,
    )


@pytest.mark.parametrize(
    ("model", "outcome", "used", "expected"),
    [
        ("reduced", "rock", 1.2, True),
        ("rigid", "overturned", 1.2, True),
        ("reduced", "slide", 1.2, True),
        ("reduced", "rest", 0.71, True),
        ("reduced", "rest", 0.69, False),
        ("full", "rock", 1.2, False),
    ],
)
def test_every_run_but_a_plain_rest_and_a_dear_one_has_a_band(model, outcome, used, expected):
    case = load_case("rocking", [f"solver.model={model}"])
    for asked, wanted in ((None, expected), (True, True), (False, False)):
        assert wants_band(asked, case, result(outcome, used)) is wanted


def test_members_are_the_run_itself_and_every_change_of_its_case(tmp_path):
    case = load_case("rocking", SHORT)
    verdict = verdict_with_band(tmp_path, case)
    given, *others = verdict.band.members
    penalty = given.normal_penalty_Pa_m
    wanted = list(chain(*all_changes(case, penalty)))
    assert sorted(one.change for one in others) == sorted(one.label for one in wanted)
    assert given.change == "" and given.outcome == verdict.outcome
    assert given.rotation_ratio == verdict.rotation_ratio
    assert verdict.band.left_out == () and verdict.band.draws == 32


@pytest.mark.parametrize("model", ["rigid", pytest.param("reduced", marks=pytest.mark.slow)])
def test_members_side_by_side_are_the_runs_one_by_one(tmp_path, model):
    # Threads share the container; each member must be to the bit what the case alone gives, whatever runs beside it.
    case = load_case("rocking", [*FEW, *BARE, f"solver.model={model}", "solver.duration_s=1"])
    members = verdict_with_band(tmp_path, case).band.members
    case = open_run(tmp_path).case  # with the step and penalty chosen for the run
    assert len(members) >= 10
    for one in members[1:]:
        coarse = one.kind == "draw" or "support.kind" in one.values
        coarser = {"solver.energy_tolerance": DRAWN_TOLERANCE} if coarse else {}
        alone = build_model(case.with_values(as_changed(case, one.values) | coarser))
        recorder = Recorder(alone, recovery_of(alone) if model == "reduced" else None)
        simulate(alone, recorder)
        verdict = verdict_of(alone, recorder.history(), recorder.largest_von_mises)
        if model == "reduced" and {"container.centroid_m", "container.eccentricity_m"} & {*one.values}:
            # Its modes are those of the run, whose mass lies elsewhere by a hundredth.
            assert one.rotation_ratio == pytest.approx(verdict.rotation_ratio, rel=0.03), one.change
            continue
        stress = verdict.max_von_mises_Pa  # summed in another order
        assert one.max_von_mises_Pa == (None if stress is None else pytest.approx(stress, rel=1e-12))
        for name in ("outcome", "rotation_ratio", "max_slip_m", "max_corner_force_N"):
            assert getattr(one, name) == getattr(verdict, name), (one.change, name)
        joints = joint_demands(alone, recorder.history())
        bolts = max(max(joint.bolt_tension_left_N, joint.bolt_tension_right_N) for joint in joints)
        assert one.bolt_tension_N == (bolts if one.kind == "one" else None)


@pytest.mark.parametrize(
    ("peak", "friction", "sure", "outcomes"),
    [
        ("1.0", [], "sure", None),
        # a range that the case states is tried: 1.7 m/s2 is 0.39 of the friction of its middle, 1.16 of its lower end
        ("1.7", ["contact.mu_static=[0.15, 0.75]"], "regime unsure", {"rest", "slide"}),
    ],
)
def test_a_rest_far_below_the_static_limits_is_sure_without_a_band_but_of_a_stated_range(
    tmp_path, peak, friction, sure, outcomes
):
    case = load_case("seed_stack", [f"motion.peak_acceleration_m_s2={peak}", *friction, *SHORT])
    found = stored_run(case, tmp_path, margin=False)
    verdict = found.typed_result.verdict
    assert (verdict.outcome, verdict.sure) == ("rest", sure)
    assert (verdict.band and {*verdict.band.outcomes}) == outcomes


class TestWhatDoesNotFitTheTime:
    """What is computed follows from the run's own steps and sizes; what is left out is said."""

    case = load_case("seed_stack_plateau", ["solver.model=rigid", COARSE])
    model = build_model(case)

    def numerics(self, steps):
        return Numerics(steps=steps, rejected=0, contact_nodes=27, unknowns=77)

    def plan(self, steps, **case):
        model = replace(self.model, case=self.case.with_values(case)) if case else self.model
        return plan_of(model, result("rock", numerics=self.numerics(steps)))

    def test_draws_are_left_out_before_changes_of_one_input(self):
        changes, left_out = self.plan(30_000)
        assert {one.kind for one in left_out} == {"draw"}
        assert {one.kind for one in changes} == {"one", "pair", "draw"}

    def test_of_a_dear_band_one_change_of_each_of_the_first_inputs_stays(self):
        changes, _ = self.plan(10_000_000)
        assert len(changes) == band.LEAST_MEMBERS
        inputs = [one.inputs for one in changes]
        assert len(set(inputs)) == len(inputs) and inputs[0] == ("contact.mu_kinetic",)
        assert changes[0].label == "contact.mu_kinetic = 0.4"

    def test_a_verdict_is_not_sure_where_changes_were_left_out(self, tmp_path, monkeypatch):
        monkeypatch.setattr(band, "BUDGET_S", 0.0)
        found = verdict_with_band(tmp_path, load_case("rocking", SHORT))
        assert found.sure == "unsure" and len(found.band.members) == 1 + band.LEAST_MEMBERS
        assert found.band.draws_left_out == 32


@pytest.mark.parametrize(("share", "members"), [(0.8, 0), (0.9, 1), (1.05, 0)])
def test_a_flat_base_near_uplift_is_tried_on_a_stiff_floor(share, members):
    case = load_case("seed_stack", ["solver.model=rigid", COARSE, "floor.kind=rigid", "support.kind=flat"])
    model = build_model(case)
    floors = [one for one in plan_of(model, result("rock", share))[0] if one.kind == "floor"]
    assert len(floors) == members
    for one in floors:
        assert one.values["contact.normal_penalty_Pa_m"] == pytest.approx(30.0 * model.penalty)


def test_a_member_that_fails_is_named_in_a_warning_and_in_the_summary(tmp_path):
    # Newmark without averaging gains energy on a contact beyond 3 E/h and refuses it: h k/E is 2 here, 6 at x 3.
    soft = ("container.youngs_modulus_Pa=1e9", "contact.normal_penalty_Pa_m=2e10", "uncertainty.draws=0")
    changes = (*SHORT, "solver.element_size_m=0.1", "solver.scheme=newmark", *soft)
    assert main([*run_command("rocking", tmp_path, *changes), "--band"]) == 0
    found = read_result(tmp_path / "run.json")
    failed = [one for one in found["verdict"]["band"]["members"] if one["outcome"] is None]
    named = [(one["change"], one["status"]) for one in failed]
    assert named == [("contact.normal_penalty_Pa_m = 6e+10", "failed")]
    assert all("gains energy" in one["error"] and one["rotation_ratio"] is None for one in failed)
    assert found["verdict"]["sure"] == "unsure" and found["verdict"]["band"]["unsure"] is True
    assert "6e+10 Pa/m" in found["warnings"][0]


def test_members_without_inner_forces_move_as_those_with_them():
    model = build_model(load_case("rocking", [COARSE, "solver.duration_s=1", "output.fields_s=0"]))
    singles = all_changes(model.case, model.penalty)[0]
    changes = [one for one in singles if "contact.mu_kinetic" in one.values][:1]
    with_them, without = (
        run_changes(model, changes, numerics=Numerics(), stop=lambda: False, inner_forces=wanted)[0]
        for wanted in (True, False)
    )
    assert with_them.bolt_tension_N > 0.0 and with_them.max_von_mises_Pa > 0.0
    assert without.bolt_tension_N is None and without.max_von_mises_Pa is None
    for name in ("outcome", "rotation_ratio", "max_slip_m", "max_uplift_m"):
        assert without[name] == with_them[name]
