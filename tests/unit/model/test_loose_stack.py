"""Models of loose stacks: boxes analysed once, exact at their corners, settled in every joint."""

import numpy as np
import pytest
from cases import LEAST

from fem.case.case import Case, CaseError, case_from, read_case
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
    exact = static_response(box.elements, box.corners).compliance
    shapes = box.basis.shapes[:, box.corners].reshape(box.basis.angular_frequencies.size, -1)
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
        assert contact.relaxation_time[2:] == pytest.approx(
            2.0 * ratio * np.sqrt(mass / contact.normal_stiffness[2])
        )


def test_joints_have_their_own_friction_and_the_springs_of_the_face_they_share():
    built = build_model(
        loose(
            UNEQUAL, model="rigid", more="[joints]\nmu_static = 0.3\nmu_kinetic = 0.2\nweakening_m = 1e-3\n"
        )
    )
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


def random_stack(rng: np.random.Generator) -> tuple[dict, bool]:
    """A symmetric or an offset stack of boxes from rubber to ten times steel, and whether its joints can carry it."""
    count, width, height = int(rng.integers(2, 6)), float(rng.uniform(0.6, 2.5)), float(rng.uniform(0.5, 4.0))
    masses, widths, offsets = np.full(count, 2500.0), np.full(count, width), np.zeros(count)
    if rng.random() < 0.5:
        masses, widths = masses * rng.uniform(0.3, 3.0, count), width * rng.uniform(0.6, 1.0, count)
        offsets[1:] = width * rng.uniform(-0.25, 0.25, count - 1)
    box = [
        {"width_m": w, "mass_kg": m, "offset_m": x} for w, m, x in zip(widths, masses, offsets, strict=True)
    ]
    container = {"width_m": width, "height_m": height, "depth_m": 1.1, "joints": "loose", "box": box}
    case = {
        "schema": 1,
        "container": container | {"youngs_modulus_Pa": 10.0 ** rng.uniform(8.0, 12.4)},
        "contact": {"mu_static": 0.4},
        "motion": {"kind": "none"},
        "solver": {"element_size_m": max(width, height) / 2.0},
    }
    axis = np.cumsum(offsets)
    stands = True
    for j in range(count):
        left, right = axis[j] - 0.5 * widths[j], axis[j] + 0.5 * widths[j]
        if j:
            left = max(left, axis[j - 1] - 0.5 * widths[j - 1])
            right = min(right, axis[j - 1] + 0.5 * widths[j - 1])
        stands &= bool(left < np.average(axis[j:], weights=masses[j:]) < right)
    return case, stands


@pytest.mark.parametrize("count", [20, pytest.param(300, marks=pytest.mark.slow)])
def test_a_stack_starts_where_what_each_joint_carries_acts_within_its_faces(count):
    # Stiff boxes were refused: the equations held forces and heights in SI units, and their condition, 1e13, decided.
    rng = np.random.default_rng(count)
    for _ in range(count):
        given, stands = random_stack(rng)
        if stands:
            case = case_from(given)
            on_floor = build_model(case).run.old.force[:2, 1].sum()
            assert on_floor == pytest.approx(9.81 * sum(box.mass for box in case.stack), rel=1e-9)
        else:
            with pytest.raises(CaseError, match=r"outside the face (that carries it|below)"):
                build_model(case_from(given))
