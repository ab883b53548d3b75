"""Forces in the joints of a stack, against a rigid block in closed form and against the contact forces."""

import numpy as np
import pytest
from runs import SLENDERNESS, Finished, pulse, stack

import fem.model.model
from fem.case import columns
from fem.model.joints import joints_of
from fem.model.model import build_model
from fem.results.history import History
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

WIDTH, HEIGHT, BOXES = 1.1, 4.0, 4
WEIGHT = BOXES * 24525.0
JOINTS = np.array([1.0, 2.0, 3.0])
RUNS = {
    "rigid": {"solver__model": "rigid", "solver__duration_s": 1.2},
    "reduced": {"solver__model": "reduced", "solver__duration_s": 1.2},
    "full": {"solver__model": "full", "solver__duration_s": 0.5},
}


def run(heights: list[float] | None = None, **changes) -> Finished:
    """A run; with heights, the forces at other mesh lines than the joints, such as the base."""
    model = build_model(stack(**changes))
    recorder = Recorder(model)
    if heights is not None:
        recorder.take_joints(joints_of(model, np.array(heights)), model.run.old)
    ending = simulate(model, recorder)
    assert ending.error is None
    return Finished(model=model, history=recorder.history(), status=ending.status)


def forces(history: History, joint: int) -> np.ndarray:
    """Normal, shear, moment (n, 3)."""
    return np.column_stack([history[name] for name in columns.JOINTS.names((joint,))])


def section_of_a_rocking_block(finished: Finished, height: float) -> np.ndarray:
    """N, V, M (n, 3) in a section of a rigid block that turns about its fixed right corner.

    The part above, mass m, mass centre at (-a/2, z) from the corner in the block's axes, has the acceleration
    (theta'' z + theta'^2 a/2, theta'' a/2 - theta'^2 z) there; gravity is (g sin theta, -g cos theta). With theta'' =
    -p^2 sin(alpha - theta), F = m (a - g), and about the part's own mass centre I theta'' = M - (H - z_j)/2 V.
    """
    theta, rate = finished.history["rotation_rad"], finished.history["angular_velocity_rad_s"]
    p, g = finished.model.static.frequency_parameter, 9.81
    turning = -(p**2) * np.sin(SLENDERNESS - theta)
    above = HEIGHT - height
    mass = WEIGHT / g * above / HEIGHT
    inertia = mass * (WIDTH**2 + above**2) / 12.0
    z, half = 0.5 * (HEIGHT + height), 0.5 * WIDTH
    shear = mass * (turning * z + rate**2 * half - g * np.sin(theta))
    normal = mass * (turning * half - rate**2 * z + g * np.cos(theta))
    return np.column_stack([normal, shear, inertia * turning + 0.5 * above * shear])


def means(values: np.ndarray) -> np.ndarray:
    """Means of consecutive samples: the mean over an interval of a motion that is smooth there."""
    return 0.5 * (values[1:] + values[:-1])


@pytest.mark.parametrize("model", RUNS)
def test_a_stack_at_rest_carries_the_weight_above(model):
    # A step of the full model ends with up to 5e-6 of the weight unbalanced at each of its 45 nodes.
    tolerance = (45 * 5e-6 if model == "full" else 1e-8) * WEIGHT
    at_rest = run(solver__model=model, solver__duration_s=0.1, initial__rotation_rad=0.0)
    for joint in (1, 2, 3):
        expected = np.array([(BOXES - joint) * 24525.0, 0.0, 0.0])
        assert np.abs(forces(at_rest.history, joint) - expected).max() <= tolerance


@pytest.mark.parametrize("model", RUNS)
def test_sections_of_a_rocking_stack_carry_what_a_rigid_block_does(model):
    """Solid, f1 = 24 contact frequencies: rigid but for vibration below a thousandth of the weight."""
    rocking = run(**RUNS[model])
    before_impact = means(rocking.times) < 0.69
    for joint, height in enumerate(JOINTS, start=1):
        exact, found = section_of_a_rocking_block(rocking, height), forces(rocking.history, joint)
        assert found[0] == pytest.approx(exact[0], abs=1e-3 * WEIGHT), "from the initial acceleration"
        assert found[1:][before_impact] == pytest.approx(means(exact)[before_impact], abs=1e-3 * WEIGHT)


@pytest.mark.parametrize("model", RUNS)
def test_the_section_at_the_base_carries_the_contact_forces(model):
    rocking = run([0.0, 2.0], **RUNS[model])
    history = rocking.history
    cosine, sine = np.cos(history["rotation_rad"]), np.sin(history["rotation_rad"])
    normal, shear = history["normal_force_N"], history["shear_force_N"]
    contact = np.column_stack([sine * shear + cosine * normal, cosine * shear - sine * normal])
    before_impact = means(rocking.times) < 0.69
    base = forces(history, 1)[1:][before_impact]
    assert base[:, :2] == pytest.approx(means(contact)[before_impact], abs=1e-3 * WEIGHT)
    # All of it stands on the right corner: the resultant, -M/N from the middle, is half a width to the right.
    assert -base[:, 2] / base[:, 0] == pytest.approx(0.5 * WIDTH, rel=1e-3)


def test_an_impact_puts_its_whole_impulse_through_the_base():
    rocking = run([0.0], solver__model="rigid", solver__duration_s=0.8, output__history_s=2e-5)
    time, history = rocking.times, rocking.history
    window = (time > rocking.track.first_impact - 0.01) & (time < rocking.track.first_impact + 0.05)
    impulse = np.sum(forces(history, 1)[window, 0]) * 2e-5
    contact = np.trapezoid(history["normal_force_N"][window], time[window])
    assert contact > 1.5 * WEIGHT * 0.06  # the impact is as much again as the weight
    assert impulse == pytest.approx(contact, rel=0.01)


def test_joint_forces_do_not_depend_on_the_change_of_frame_after_the_end():
    """The floor keeps 0.1 m/s: beyond the end the motion continues in its frame."""
    moving = {key.replace(".", "__"): value for key, value in pulse(1.0, 0.1).items()}
    tilted = {"initial__rotation_rad": 1.4 * SLENDERNESS, "solver__duration_s": 0.3}
    falling = run(solver__model="rigid", **moving, **tilted)
    assert falling.status == "overturned"
    around = np.abs(means(falling.times) - 0.3) < 0.1
    for joint, height in enumerate(JOINTS, start=1):
        exact = means(section_of_a_rocking_block(falling, height))[around]
        assert forces(falling.history, joint)[1:][around] == pytest.approx(exact, abs=2e-3 * WEIGHT)


def test_joint_forces_do_not_depend_on_the_length_of_a_chunk_of_samples(monkeypatch):
    short = {"solver__model": "reduced", "solver__duration_s": 0.9}
    whole = run(**short).history.samples.tobytes()
    monkeypatch.setattr(fem.model.model, "HISTORY_CHUNK", 8)
    assert run(**short).history.samples.tobytes() == whole
