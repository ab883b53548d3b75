"""Verdicts that must not be sure: where friction, its fall or the stiffness of the floor decides, the run says so.

The runs are those in which an independent review found verdicts that were sure and depended on unknown inputs.
"""

import pytest
from cases import named_case

from fem.run.run import RunOptions, run_case

QUICK = {"floor.kind": "rigid", "output.fields_s": 0.0, "output.figures": False, "uncertainty.draws": 4}
#: mass centre, base and floor are those of the case
SHAPE = ("support", "centroid_m", "eccentricity_m", "effective_width", "slope_percent")
GEOMETRY = {f"uncertainty.{name}": "held" for name in SHAPE}
FLAT = GEOMETRY | {"support.kind": "flat", "contact.mu_kinetic": 0.4, "solver.duration_s": 15.0}
FLAT |= {f"uncertainty.{name}": "held" for name in ("mu_kinetic", "mu_static", "ramp")}
KNOWN = ("normal_penalty_Pa_m", "damping_ratio", "material_damping_ratio")
FLAT |= {f"uncertainty.{name}": "known" for name in KNOWN}
UPLIFT = 2.698  # m/s2, of the stack as a rigid block: g a/h


def verdict_of(folder, name, values):
    case = named_case(name, QUICK | values)
    return run_case(case, case_text=case.text, folder=folder, options=RunOptions(margin=False)).typed_result


def pulse(model="reduced", **values):
    """A box of steel under a rectangular pulse of 0.80 of what breaks it loose."""
    given = {"motion.kind": "pulse", "motion.shape": "rectangular", "motion.pulse_s": 0.5}
    given |= {"motion.delay_s": 0.1, "motion.peak_acceleration_m_s2": 3.14}
    given |= {"solver.duration_s": 1.5, "solver.model": model}
    return given | {key.replace("__", "."): value for key, value in values.items()}


def test_a_pull_below_stiction_does_not_slide_a_shell_surely(tmp_path):
    # A block under 0.80 of mu_s g rests. A shell's overshoot of some milliseconds must not drop its support to
    # mu_kinetic for good (it slid 233 mm); where a law of friction of the band does, the verdict names it.
    verdict = verdict_of(tmp_path, "seed_box", pulse()).verdict
    assert verdict.outcome == "rest" and verdict.max_slip_m < 1e-4
    others = set(verdict.band.outcomes) - {"rest"}
    assert (verdict.sure == "sure") == (not others)
    assert not others or "contact.mu_kinetic" in verdict.decided_by


def test_a_pull_beyond_stiction_slides_and_friction_decides_how_far(tmp_path):
    found = verdict_of(tmp_path, "seed_box", pulse(motion__peak_acceleration_m_s2=4.2))
    verdict = found.verdict
    assert verdict.outcome == "slide" and verdict.sure == "regime unsure"
    assert verdict.decided_by[0] == "contact.mu_kinetic"
    low, high = verdict.band.max_slip_m
    assert high > 10.0 * low


@pytest.mark.parametrize("section", ["shell", pytest.param("solid", marks=pytest.mark.slow)])
def test_the_default_motion_hangs_on_the_fall_of_friction(tmp_path, section):
    values = {"container.section": section, "container.fill": "none", "solver.duration_s": 8.0}
    values["uncertainty.restitution_over_housner"] = "held"
    verdict = verdict_of(tmp_path, "seed_stack_plateau", values).verdict
    assert verdict.sure == "regime unsure"
    assert {"contact.mu_kinetic", "contact.weakening_m"} >= {*verdict.decided_by[:1]}
    low, high = verdict.band.rotation_ratio
    assert low < 0.25 and high == pytest.approx(0.399, abs=0.02)  # the block without slip
    assert not any("contact." in line for line in verdict.card)


@pytest.mark.parametrize(
    ("model", "share"), [("rigid", 0.98), pytest.param("reduced", 0.92, marks=pytest.mark.slow)]
)
def test_a_flat_base_that_rocks_below_uplift_is_not_sure(tmp_path, model, share):
    # Exact rigid block: rests below its uplift. A soft bed opens from the edge and is pulled into rocking.
    values = {"solver.model": model, "motion.peak_acceleration_m_s2": share * UPLIFT, "uncertainty.draws": 0}
    values["container.fill"] = "none"  # a fill that damps takes the resonance of the soft bed
    values["uncertainty.camber_m"] = "held"  # nothing opens at once on a base that rolls
    verdict = verdict_of(tmp_path, "seed_stack_plateau", FLAT | values).verdict
    assert verdict.rotation_ratio > 0.1
    assert verdict.sure == "unsure" and verdict.decided_by[0] == "contact.normal_penalty_Pa_m"
    (floor,) = (one for one in verdict.band.members if one.kind == "floor")
    assert floor.rotation_ratio < 0.01
    page = " ".join((tmp_path / "summary.txt").read_text().split())
    assert f"the static rule stands at {share:.3f} and the run rocked. The rule governs" in page


def test_corners_below_uplift_rest_and_are_sure(tmp_path):
    values = {"solver.model": "rigid", "contact.mu_kinetic": 0.4, "uncertainty.mu_kinetic": "held"}
    values |= {"motion.peak_acceleration_m_s2": 0.95 * UPLIFT}
    verdict = verdict_of(tmp_path, "seed_stack_plateau", GEOMETRY | values).verdict
    assert (verdict.outcome, verdict.sure, verdict.decided_by) == ("rest", "sure", ())
    assert verdict.band.draws_overturned == 0
