"""The largest stress of a run: of many coordinates without looking at all of them, and of all its steps."""

import numpy as np
import pytest

from fem.case.case import load_case
from fem.model.model import build_model
from fem.model.peaks import stressed_nodes
from fem.model.recovery import recovery_of
from fem.run.recorder import Recorder
from fem.run.simulation import run_without_history, simulate


@pytest.fixture(scope="module")
def recovery():
    case = load_case("seed_box", ["solver.elastic_modes=6", "solver.element_size_m=0.25", "solver.order=1"])
    return recovery_of(build_model(case)).bodies[0].body


@pytest.mark.parametrize("seed", range(4))
def test_the_largest_stress_is_that_of_all_nodes_in_all_samples(recovery, seed):
    # Amplitudes so spread that bounds leave out some samples, and not spread so much that they leave out all others.
    random = np.random.default_rng(seed)
    count, modes = 40, len(recovery.angular_frequencies)
    amplitudes = random.standard_normal((count, modes)) * random.uniform(0.5, 1.5, (count, 1))
    modal = amplitudes / recovery.angular_frequencies
    positions = np.column_stack([np.zeros((count, 3)), modal])
    each = [recovery.frame(row, np.zeros_like(row)).von_mises[recovery.counted] for row in positions]
    assert recovery.largest_von_mises(positions) == pytest.approx(np.max(each), rel=1e-12)


def test_of_a_symmetric_container_both_nodes_of_a_pair_are_watched():
    case = load_case("rocking", ["solver.element_size_m=0.25", "solver.order=1"])
    container = build_model(case).container
    stressed = stressed_nodes(case, container.elements, container.basis, container.nodes)
    nodes = container.elements.nodes[stressed]
    mirrored = nodes * (-1.0, 1.0)
    distance = np.linalg.norm(nodes[:, None] - mirrored[None], axis=2).min(axis=1)
    assert len(nodes) > 4 and distance.max() < 1e-9


@pytest.mark.parametrize("changes", [[], pytest.param(["container.joints=loose"], marks=pytest.mark.slow)])
def test_the_stress_of_a_run_is_that_of_its_steps_whatever_is_sampled(changes):
    # Reference: the largest over frames of 0.2 ms, interpolated in the steps of the same run.
    coarse = ["solver.element_size_m=0.25", "solver.order=1", "solver.duration_s=1.0"]
    found, frames = [], []
    for interval, fields in ((0.005, 0.0), (0.001, 2e-4)):
        kept = [f"output.history_s={interval}", f"output.fields_s={fields}"]
        case = load_case("rocking", [*changes, *coarse, *kept])
        model = build_model(case)
        recovery = recovery_of(model)
        recorder = Recorder(
            model,
            recovery,
            frame_sink=lambda frame, of=recovery: frames.append(of.largest_in(frame.von_mises)),
        )
        simulate(model, recorder)
        found.append(recorder.largest_von_mises)
    assert found[0] == found[1]
    assert 0.99 * max(frames) < found[0] < 1.1 * max(frames)  # a peak of 0.1 ms falls between frames
    assert run_without_history(build_model(case), recovery)[0].max_von_mises_Pa == found[0]
