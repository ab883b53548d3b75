"""The rigid-limit check of a run: what it compares, and when it says that the comparison is not fair."""

import json
import math

import numpy as np
import pytest
from interrupted_runs import stored_run
from runs import STACK
from small_sweep import rows_of

from fem.case.case import Case, load_case
from fem.model.model import Model, build_model
from fem.results.history import read_history
from fem.run.compute import wants_rigid_check
from fem.run.recorder import Recorder
from fem.run.rigid_check import RigidCheck, block_of, check_against_rigid_block, first_peaks, floor_of
from fem.run.simulation import simulate
from fem.run.verdict import verdict_of

ANGLE = math.atan(1.1 / 4.0)


def checked(name: str, *overrides: str) -> tuple[Model, RigidCheck]:
    return checked_case(load_case(name, ["output.fields_s=0", *overrides]))


def checked_case(case: Case) -> tuple[Model, RigidCheck]:
    model = build_model(case)
    recorder = Recorder(model)
    ending = simulate(model, recorder)
    assert ending.error is None, ending.error
    history = recorder.history()
    return model, check_against_rigid_block(model, history, verdict_of(model, history, None))


def reasons(name: str, *overrides: str) -> str:
    return " | ".join(checked(name, "solver.model=rigid", *overrides)[1].result.reasons)


@pytest.mark.parametrize(
    ("name", "overrides", "asked", "expected"),
    [
        ("free_rocking", [], False, True),
        ("rocking", [], False, False),
        ("rocking", [], True, True),
        ("free_rocking", ["initial.rotation_rad=0"], False, False),
    ],
)
def test_free_rocking_is_always_checked(name, overrides, asked, expected):
    assert wants_rigid_check(asked, load_case(name, overrides)) is expected


def test_the_block_has_the_mass_of_the_mesh():
    # Homogeneous: p^2 = 3g/(4R), e = 1 - 1.5 sin^2(slenderness angle) = 0.89454 (benchmark of the stack).
    block = block_of(build_model(load_case("free_rocking")))
    assert block.inertia_ratio == pytest.approx(4.0 / 3.0, rel=1e-9)
    assert block.frequency_parameter == pytest.approx(1.88337, abs=1e-5)
    assert block.housner_restitution == pytest.approx(0.89454, abs=1e-5)
    shell = build_model(load_case("rocking"))
    assert block_of(shell).frequency_parameter == pytest.approx(shell.static.frequency_parameter, rel=1e-12)
    assert block_of(shell).housner_restitution == pytest.approx(shell.static.housner_restitution, rel=1e-12)


class TestFreeRocking:
    def test_the_rigid_model_is_the_block(self):
        # Analytic: first impact 0.700737 s, velocity ratio 0.89454, first peak after it 0.098783 rad.
        _, check = checked("free_rocking", "solver.model=rigid", "solver.duration_s=5")
        found = check.result
        assert found.meaningful is True
        assert found.reference == "rigid block that does not slide"
        assert found.first_impact_s.block == pytest.approx(0.700737, abs=1e-6)
        assert found.first_impact_s.run == pytest.approx(0.700737, rel=3e-3)
        assert found.velocity_ratio.block == pytest.approx(0.89454, abs=1e-5)
        assert found.velocity_ratio.run == pytest.approx(0.89454, abs=5e-3)
        first = found.peaks[0]
        assert first.block_rad == pytest.approx(-0.098783, abs=1e-6)
        assert first.run_rad == pytest.approx(-0.098783, rel=5e-3)
        assert len(found.peaks) >= 4
        assert found.largest_difference_before_impact < 1e-3

    def test_the_table_holds_both_rotations_at_every_sample(self, tmp_path):
        keys = ("solver.model=rigid", "output.fields_s=0", "output.figures=false", "solver.duration_s=2")
        stored_run(load_case("free_rocking", keys), tmp_path / "r", band=False)
        rows = rows_of(tmp_path / "r" / "rigid_check.csv")
        assert len(rows) == 401
        columns = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
        assert columns["time_s"] == pytest.approx(0.005 * np.arange(401))
        apart = np.abs(columns["rotation_rad"] - columns["analytic_rotation_rad"])
        assert apart.max() < 5e-3 * ANGLE
        history = read_history(tmp_path / "r" / "history.csv")
        assert np.array_equal(history["analytic_rotation_rad"], columns["analytic_rotation_rad"])
        kept = json.loads((tmp_path / "r" / "run.json").read_text())["rigid_check"]
        assert kept["meaningful"] is True


DRIVEN = ("solver.model=rigid", "solver.duration_s=8", "container.section=solid")


class TestMovingFloor:
    def test_a_driven_block_is_followed_from_rest(self):
        # The homogeneous stack at 4.0 m/s2, exact: rocks without slip to 0.399 of its slenderness angle.
        model, check = checked("seed_stack_plateau", *DRIVEN)
        assert check.result.reference == "rigid block that does not slide"
        assert check.result.meaningful is True
        analytic = np.nanmax(np.abs(check.rows[:, 2]))
        assert analytic / model.static.slenderness_angle == pytest.approx(0.399, abs=1e-3)
        assert len(check.result.peaks) == 6

    def test_a_floor_that_jerks_away_gives_the_block_a_slip_velocity(self):
        # 50 mm at 6.93 rad/s, floor moving off at 0.35 m/s under the stack, mu 0.4: exact 0.2505 of the angle.
        jerked = ("motion.start=rest", "contact.mu_kinetic=0.4", "motion.angular_frequency_rad_s=6.93")
        model, check = checked("seed_stack", *DRIVEN, *jerked)
        assert check.result.reference == "rigid block with friction"
        analytic = np.nanmax(np.abs(check.rows[:, 2]))
        assert analytic / model.static.slenderness_angle == pytest.approx(0.2505, abs=5e-4)

    def test_a_floor_from_a_table_bends_at_every_sample(self):
        times = np.linspace(0.0, 2.0, 41)
        case = STACK.with_values({"solver.duration_s": 3.0}).with_motion(times, 3.5 * np.sin(7.0 * times))
        model, check = checked_case(case)
        floor = floor_of(model.motion, driven_until=3.0)
        assert set(np.round(times[1:], 6)) <= set(np.round(floor.break_times, 6))
        assert floor.function(0.025) == pytest.approx(0.5 * 3.5 * math.sin(7.0 * 0.05), rel=1e-6)
        assert floor.just_after(2.5).x == 0.0
        assert check.result.meaningful is True
        assert check.result.first_impact_s.run == pytest.approx(check.result.first_impact_s.block, rel=3e-3)


STEEL = "container.youngs_modulus_Pa=2.1e11"
FULL = ("solver.model=full", "solver.element_size_m=0.55", "solver.duration_s=0.05", STEEL)


class TestFairness:
    @pytest.mark.parametrize(
        ("overrides", "reason"),
        [
            ((), ""),
            (("support.kind=flat",), "support 'flat'"),
            (("support.kind=feet",), "support 'feet'"),
            # Housner's impact of the stack needs mu >= 3 tan al/(4 + tan^2 al) = 0.2024.
            (("contact.mu_static=0.19",), "slides at the first impact"),
            (("contact.mu_static=0.25",), ""),
            (("solver.model=reduced", STEEL), "it deforms"),
            (("solver.model=reduced", "container.youngs_modulus_Pa=5e12"), ""),
            (FULL, "it deforms"),
            (("contact.damping_ratio=0.5",), "the contact bounces"),
            (("contact.normal_penalty_Pa_m=1e8",), "soft floor"),
        ],
    )
    def test_the_stiff_slender_stack_on_corners_is_fair_and_each_difference_is_named(self, overrides, reason):
        found = reasons("free_rocking", "solver.duration_s=2", *overrides)
        assert reason in found if reason else found == ""

    def test_a_squat_container(self):
        strong = ("motion.peak_acceleration_m_s2=14", "contact.mu_static=2")
        assert "squat container" in reasons("seed_box", "solver.duration_s=1", *strong)


class TestPeaks:
    def test_the_largest_of_each_swing_is_found_between_the_samples(self):
        time = np.arange(0.0, 3.0, 0.01)
        peaks = first_peaks(time, 0.2 * np.cos(2.0 * np.pi * time / 1.7), 0.01)
        assert [instant for instant, _ in peaks] == pytest.approx([0.85, 1.7, 2.55], abs=1e-5)
        assert [rotation for _, rotation in peaks] == pytest.approx([-0.2, 0.2, -0.2], abs=1e-6)
