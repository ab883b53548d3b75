"""Boxes that differ, and boxes without bolts: what the keys mean, and what is refused."""

import pytest
from cases import LEAST

from fem.case.case import Case, CaseError, case_hash, read_case, to_toml
from fem.case.tables.unknown_inputs import ranges_of
from fem.case.template import case_template

BOX = "[[container.box]]\n"
LIGHT = f"{BOX}width_m = 0.8\nheight_m = 0.6\nmass_kg = 800.0\noffset_m = 0.1\n"


def stack(boxes: str = f"{BOX}{LIGHT}", *, container: str = "", more: str = "") -> Case:
    """The least case with these tables of boxes, with further keys in [container] and further tables."""
    text = LEAST.replace("[contact]", f"{container}\n{boxes}\n[contact]") + more
    return read_case(text)


def refused(*args: str, **kwargs: str) -> str:
    with pytest.raises(CaseError) as error:
        stack(*args, **kwargs)
    return str(error.value)


def test_a_box_takes_what_it_leaves_out_from_the_container():
    lower, upper = stack(f"{BOX}mass_kg = 4000.0\n{LIGHT}").stack
    assert (lower.width, lower.height, lower.mass, lower.centroid, lower.axis, lower.bottom) == (
        1.1,
        1.0,
        4000.0,
        0.5,
        0.0,
        0.0,
    )
    # half its own height, since the container has half of its own
    assert (upper.width, upper.height, upper.mass, upper.centroid) == (0.8, 0.6, 800.0, 0.3)
    assert (upper.axis, upper.bottom, upper.top) == (0.1, 1.0, 1.6)
    assert stack(BOX + LIGHT, container="centroid_m = 0.4").stack[1].centroid == 0.4


def test_offsets_count_from_the_box_below():
    assert [box.axis for box in stack(BOX + 2 * f"{BOX}offset_m = 0.1\n").stack] == [0.0, 0.1, 0.2]


def test_mass_and_height_are_those_of_all_boxes():
    case = stack(f"{BOX}mass_kg = 4000.0\n{LIGHT}")
    assert (case.mass, case.container.boxes, case.container.total_height) == (4800.0, 2, pytest.approx(1.6))
    assert case.weight == pytest.approx(4800.0 * 9.81)


def test_a_density_gives_each_box_the_mass_of_its_volume():
    case = read_case(
        LEAST.replace("weight_N = 24525.0", f"density_kg_m3 = 1000.0\n{BOX}{BOX}height_m = 0.5\n")
    )
    assert [box.mass for box in case.stack] == pytest.approx([1210.0, 605.0])


def test_a_wall_of_one_box_makes_a_shell_that_needs_all_of_them():
    assert "box 1: wall_m is missing" in refused(f"{BOX}{BOX}wall_m = 0.01\n")
    walls = stack(2 * f"{BOX}wall_m = 0.01\n")
    assert walls.container.section == "shell"
    assert [box.wall for box in walls.stack] == [0.01, 0.01]


def test_friction_between_loose_boxes_is_that_of_the_floor_unless_given():
    case = stack("boxes = 2\njoints = 'loose'")
    assert case.joint_friction == {"mu_static": 0.4, "mu_kinetic": 0.4, "weakening_m": 0.0}
    slippery = case.with_values({"joints.mu_static": 0.2, "contact.weakening_m": 1e-3})
    assert slippery.joint_friction == {"mu_static": 0.2, "mu_kinetic": 0.2, "weakening_m": 1e-3}
    assert case.with_values({"contact.mu_static": 0.3}).joint_friction["mu_static"] == 0.3


def test_friction_that_is_left_out_stays_so_in_the_resolved_case():
    case = stack("boxes = 2\njoints = 'loose'")
    assert "joints" not in case.resolved()
    assert "joints.mu_static" in {one.key for one in ranges_of(read_case(to_toml(case)), 1e9)}
    stated = case.with_values({"joints.mu_static": 0.4})
    assert stated.resolved()["joints"] == {"mu_static": 0.4}
    assert case_hash(stated) != case_hash(case)  # its band is another one


@pytest.mark.parametrize(
    "boxes", ["boxes = 3\njoints = 'loose'", f"joints = 'loose'\n{BOX}{LIGHT}", f"{BOX}{LIGHT}"]
)
def test_a_resolved_stack_and_its_template_are_the_same_case(boxes):
    case = stack(boxes, more="[joints]\nmu_static = 0.3\n")
    for text in (to_toml(case), case_template(case)):
        again = read_case(text)
        assert case_hash(again) == case_hash(case)
        assert (again.stack, again.resolved()) == (case.stack, case.resolved())


def test_joints_of_a_bolted_stack_play_no_part():
    given = stack("boxes = 2\njoints = 'bolted'", more="[joints]\nmu_static = 0.3\n")
    assert case_hash(given) == case_hash(stack("boxes = 2"))
    assert "joints" not in given.resolved()


def test_a_number_of_boxes_replaces_tables_of_boxes():
    case = stack().with_values({"container.boxes": 3})
    assert (case.container.box, len(case.stack)) == (None, 3)
