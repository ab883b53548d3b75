"""Models of loose stacks: boxes analysed once, exact at their corners, settled in every joint."""

import numpy as np
import pytest
from cases import LEAST

from fem.case.case import Case, read_case
from fem.model.container import discretise
from fem.model.model import build_model
from fem.solid.reduction import static_response

BOX = "[[container.box]]\n"
UNEQUAL = f"{BOX}mass_kg = 4000.0\n{BOX}width_m = 0.8\nheight_m = 0.6\nmass_kg = 800.0\noffset_m = 0.1\n"


def loose(boxes: str = "boxes = 3\n", *, model: str = "reduced", more: str = "") -> Case:
    container = f'joints = "loose"\nyoungs_modulus_Pa = 1e8\n{boxes}\n[contact]'
    text = LEAST.replace("[contact]", container)
    return read_case(f'{text}{more}\n[solver]\nmodel = "{model}"\nelement_size_m = 0.5\n')


@pytest.mark.parametrize("modes", [1, 20])
def test_a_reduced_box_answers_forces_at_its_corners_as_all_its_nodes_do(modes):
    # However few free modes are kept: the static response of the free box to forces at its corners, inertia relief.
    (box, *_) = discretise(loose().with_values({"solver.elastic_modes": modes})).boxes
    exact = static_response(box.elements, box.nodes).compliance
    shapes = box.basis.shapes[:, box.nodes].reshape(box.basis.angular_frequencies.size, -1)
    reduced = shapes.T @ (shapes / box.basis.angular_frequencies[:, None] ** 2)
    assert np.abs(reduced - exact).max() < 1e-9 * np.abs(exact).max()


@pytest.mark.parametrize("model", ["rigid", "reduced", "full"])
def test_each_joint_carries_the_weight_above_it_at_rest(model):
    built = build_model(loose(UNEQUAL, model=model))
    force, weight = built.run.old.force, 9.81 * np.array([4800.0, 800.0])
    assert force[:2, 1].sum() == pytest.approx(weight[0], rel=1e-9)
    assert force[2:, 1].sum() == pytest.approx(weight[1], rel=1e-7)  # along the tilted face
    assert np.abs(force[:, 0]).max() < 1e-4 * weight[1]  # the faces tilt by as much
    # The mass centre of the upper box is 0.1 m beside the axis of the lower one, that of both 0.1 x 800/4800 m.
    left, right = force[:2, 1]
    assert (right - left) / (right + left) * 0.55 == pytest.approx(0.1 * 800.0 / 4800.0, rel=1e-3)


@pytest.mark.parametrize("floor", ["", '\n[floor]\npreset = "asphalt"\ncorner_patch_m = [0.1, 0.2]'])
def test_joints_have_a_dashpot_of_their_own_on_any_floor(floor):
    # c/k = 2 zeta sqrt(m/k), the whole mass on the spring of a corner
    for values, ratio in (({}, 2.0), ({"joints.damping_ratio": 0.5, "contact.damping_ratio": 0.1}, 0.5)):
        contact = build_model(loose(model="rigid", more=floor).with_values(values)).equilibrium.contact
        mass = contact.force_scale / 9.81
        time = 2.0 * ratio * np.sqrt(mass / contact.normal_stiffness[2])
        assert contact.relaxation_time[2:] == pytest.approx(time)


def test_joints_have_their_own_friction_and_the_springs_of_the_face_they_share():
    rough = "[joints]\nmu_static = 0.3\nmu_kinetic = 0.2\nweakening_m = 1e-3\n"
    built = build_model(loose(UNEQUAL, model="rigid", more=rough))
    contact, penalty = built.equilibrium.contact, built.penalty
    assert contact.mu_static.tolist() == [0.4] * 2 + [0.3] * 4
    assert contact.mu_kinetic.tolist() == [0.4] * 2 + [0.2] * 4
    assert contact.weakening.tolist() == [0.0] * 2 + [1e-3] * 4
    corner = 0.5 * penalty * 1.1  # over the depth
    assert contact.normal_stiffness == pytest.approx([corner * 1.1] * 2 + [corner * 0.8] * 4)


@pytest.mark.parametrize("model", ["rigid", "reduced"])
def test_models_of_one_container_do_not_share_what_changes(model):
    case = loose(model=model)
    container = discretise(case)
    one = build_model(case, container)
    other = build_model(case, container, one.equilibrium)
    one.run.problem.contact.normal_stiffness[:] = 0.0
    assert other.run.problem.contact.normal_stiffness.min() > 0.0
    assert other.equilibrium.contact.normal_stiffness.min() > 0.0
