"""Slip is where the base is: an upright container has slipped as far as its mass centre has moved, flights included.

What is left between the two is the elastic stick of the contact, the sway of an elastic container, and the linear
interpolation of a sample within a step.
"""

import math

import numpy as np
import pytest
from random_cases import random_case

import fem
from fem.case.files import CASES

UPRIGHT = 1e-3  #: rotation over the slenderness angle below which a container counts as upright
NO_FRAMES = {"output.fields_s": 0.0}
ALONE = {"band": False, "margin": False}
STOP = {"side": "right", "height_m": 2.0, "gap_m": 0.05, "stiffness_N_m": 1e7, "damping_ratio": 0.26}


def moved(x, z, rotation, half, centre):
    """How far the base of a body has moved along x, from its mass centre: of its lower corner (n,) [m].

    half: half of the width [m]; centre: height of the mass centre over the base [m].
    """
    side = np.where(rotation > 0.0, half, -half)
    return x + side * (np.cos(rotation) - 1.0) - centre * np.sin(rotation)


def difference(run):
    """Largest difference between slip and displacement of an upright body [m]; None where it never is upright."""
    history, static = run.history, run.result["static"]
    height = static["centroid_m"]
    angle = static["slenderness_angle_rad"]
    names = ("rotation_rad", "slip_m", "centre_x_m", "centre_z_m")
    rotation, slip, x, z = (np.asarray(history[name]) for name in names)
    place = moved(x, z, rotation, height * math.tan(angle), height)
    upright = np.abs(rotation) < UPRIGHT * angle
    if not upright.any():
        return None
    return float(np.abs((slip - slip[0]) - (place - place[0]))[upright].max())


def allowed(run):
    """Elastic stick, whose normal force has a dashpot, and sway, and the interpolation within the largest step [m]."""
    numerics, contact = run.result["numerics"], run.case.contact
    peak = run.result["motion"]["peak_acceleration_m_s2"]
    peak += max(contact.mu_static, 1.0) * run.case.gravity_m_s2
    stick = 10.0 * contact.mu_static * numerics["max_penetration_m"] / contact.tangential_ratio
    frequencies = numerics["elastic_frequencies_Hz"]
    sway = 4.0 * peak / (2.0 * math.pi * frequencies[0]) ** 2 if frequencies else 0.0
    width = 2.0 * run.result["static"]["centroid_m"] * math.tan(run.result["static"]["slenderness_angle_rad"])
    return stick + sway + peak * numerics["largest_step_s"] ** 2 / 8.0 + 1e-5 * width


@pytest.mark.parametrize("name", CASES.names)
def test_the_slip_of_an_upright_shipped_case_is_what_it_has_moved(name):
    run = fem.compute(fem.load_case(name).replace(NO_FRAMES), **ALONE)
    assert difference(run) <= allowed(run)


@pytest.mark.parametrize(
    ("model", "seconds", "count", "least"),
    [("rigid", 5.0, 100, 50), pytest.param("reduced", 2.0, 12, 4, marks=pytest.mark.slow)],
)
def test_the_slip_of_random_containers_is_what_they_have_moved(model, seconds, count, least):
    cases = [random_case(number, model, seconds).replace(NO_FRAMES) for number in range(count)]
    followed = 0
    for number, run in enumerate(fem.compute_many(cases, jobs=1, **ALONE, errors="return")):
        apart = None if isinstance(run, Exception) or len(run.history.modes) == 0 else difference(run)
        if apart is not None:
            followed += 1
            assert apart <= allowed(run), number
    assert followed >= least


def test_what_a_container_moves_in_the_air_is_slip():
    # An independent block (explicit, penalty corners) stands 61.0 mm from where it was, its foot 71.9 mm.
    case = {
        "container": {"width_m": 1.0, "height_m": 2.0, "depth_m": 1.0, "mass_kg": 1000.0},
        "contact": {"mu_static": 0.9},
        "motion": {"kind": "pulse", "shape": "sine", "peak_acceleration_m_s2": 8.0, "pulse_s": 0.7},
        "solver": {"model": "rigid", "duration_s": 6.0},
    }
    run = fem.compute(fem.case_from(case | {"stop": [STOP]}), **ALONE)
    assert run.verdict.residual_slip_m == pytest.approx(0.0719, abs=4e-4)
    assert run.verdict.slip_in_air_m == pytest.approx(run.verdict.residual_slip_m, abs=1e-3)
    assert run.verdict.outcome == "slide-rock"
    # it rests there on its left edge, with its top on the stop
    assert run.verdict.tilt_rad == pytest.approx(-0.0108, abs=2e-4)


def test_the_boxes_of_a_loose_stack_slip_as_far_as_they_move_over_what_is_below():
    keys = {"container.joints": "loose", "solver.model": "rigid", "joints.mu_static": 0.1}
    case = fem.load_case("seed_stack_plateau").replace(keys | NO_FRAMES)
    history = fem.compute(case, **ALONE).history
    rotations = [history["rotation_rad"], *(history[f"box_{k}_rotation_rad"] for k in (2, 3, 4))]
    places = [history["centre_x_m"], *(history[f"box_{k}_x_m"] for k in (2, 3, 4))]
    upright = np.max(np.abs(rotations), axis=0) < 1e-4
    assert upright.sum() > 20
    for k in (2, 3, 4):
        half = case.container.centroid_m  # of both boxes, which lean by small angles
        lean = half * (np.sin(rotations[k - 1]) + np.sin(rotations[k - 2]))
        over = np.asarray(places[k - 1]) - np.asarray(places[k - 2]) - lean
        slip = np.asarray(history[f"box_{k}_slip_m"])
        assert np.abs(slip)[upright].max() > 1e-3
        assert np.abs(slip - (over - over[0]))[upright].max() < 5e-5


@pytest.mark.parametrize(("mu", "gap"), [(0.3, 0.05), (0.9, 0.02)])
def test_the_containers_of_a_row_slip_as_far_as_they_move(mu, gap):
    case = fem.case_from(
        {
            "container": {"width_m": 1.0, "height_m": 1.5, "mass_kg": 1000.0},
            "contact": {"mu_static": mu},
            "motion": {"kind": "harmonic", "amplitude_m": 0.1, "angular_frequency_rad_s": 8.0},
            "vertical": {"kind": "harmonic", "amplitude_m": 0.03, "angular_frequency_rad_s": 19.0},
            "solver": {"model": "rigid", "duration_s": 8.0},
            "neighbour": [
                {"side": "right", "gap_m": gap, "width_m": 0.8, "height_m": 1.2, "mass_kg": 700.0}
                | {"stiffness_N_m": 1e8}
            ],
        }
    )
    run = fem.compute(case.replace(NO_FRAMES), **ALONE)
    history = run.history
    for own, start, half, centre in (("", "centre_", 0.5, 0.75), ("neighbour_1_",) * 2 + (0.4, 0.6)):
        rotation, slip = history[f"{own}rotation_rad"], history[f"{own}slip_m"]
        place = moved(history[f"{start}x_m"], history[f"{start}z_m"], rotation, half, centre)
        upright = np.abs(rotation) < 1e-4
        assert upright.sum() > 10 and np.abs(slip).max() > 0.03
        assert np.abs((slip - slip[0]) - (place - place[0]))[upright].max() < allowed(run)


def test_every_node_of_a_box_that_is_thrown_up_slips_as_far_as_it_moves():
    keys = {"solver.model": "full", "solver.duration_s": 0.5, "vertical.kind": "harmonic"}
    keys |= {"vertical.amplitude_m": 0.03, "vertical.angular_frequency_rad_s": 25.0}
    keys |= {"motion.amplitude_m": 0.08, "motion.angular_frequency_rad_s": 9.0}
    run = fem.compute(fem.load_case("seed_box").replace(keys | NO_FRAMES), **ALONE)
    assert run.verdict.slip_in_air_m > 0.2
    assert difference(run) <= allowed(run)
