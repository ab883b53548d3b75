"""Boxes that differ, and boxes without bolts: what the keys mean, and what is refused."""

import pytest
from cases import LEAST

from fem.case.case import Case, CaseError, case_hash, read_case, to_toml
from fem.case.tables.unknown_inputs import ranges_of
from fem.case.template import case_template

LOOSE = "joints = 'loose'"
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


@pytest.mark.parametrize(
    ("boxes", "more", "expected"),
    [
        (f"boxes = 2\n{BOX}{BOX}", "", "[container] boxes cannot stand beside [[container.box]], of which each"),
        ("joints = 'loose'", "", '[container] joints = "loose" needs two boxes or more: a stack of one has no joints'),
        ("", "[joints]\nmu_static = 0.3", "[joints] is friction between boxes, but a stack of one has no joints"),
        ("boxes = 2\njoints = 'glued'", "", '[container] joints must be "bolted" or "loose", got the text \'glued\''),
        (
            "boxes = 2\njoints = 'loose'",
            "[joints]\nmu_static = 0.3\nmu_kinetic = 0.4",
            "[joints] mu_kinetic must be at most mu_static = 0.3 of the joints, got 0.4",
        ),
        (f"boxes = 2\n{LOOSE}", "[support]\nkind = 'flat'", "[support] kind must be \"corners\" with container.joints"),
        (f"boxes = 2\n{LOOSE}", "[initial]\nrotation_rad = 0.1", "[initial] rotation_rad does not apply to container"),
        (f"boxes = 2\n{LOOSE}", "[initial]\nangular_velocity_rad_s = 0.1", "[initial] angular_velocity_rad_s does not"),
        (f"boxes = 2\n{LOOSE}", "[output]\nstop_when_overturned = false", "[output] stop_when_overturned must be true"),
        ("boxes = 2", "[joints]\nmu_static = 30.0", "[joints] mu_static must be between 0 and 5, got 30"),
        (
            f"{BOX}{BOX}offset_m = 0.6\n",
            "",
            "[container] box 2: the mass centre of what stands on box 1 is at x = 0.6 m, outside the face that "
            "carries it, which reaches from x = 0.05 to 0.55 m",
        ),
        (f"{BOX}{BOX}offset_m = 1.2\n", "", "outside the face that carries it, which has no width"),
        (
            f"{BOX}width_m = 0.4\n{BOX}offset_m = 0.15\n{BOX}offset_m = 0.4\nmass_kg = 3000.0\n",
            "",
            "[container] box 2: the mass centre of what stands on box 1 is at x = 0.368",
        ),
        (f"{BOX}offset_m = 0.1\n{BOX}", "", "[container] box 1: offset_m is measured from the axis of the box below"),
        (f"{BOX}{BOX}widht_m = 1.0", "", "[container] box 2: unknown key 'widht_m'; did you mean 'width_m'?"),
        (f"{BOX}{BOX}width_m = 1100.0", "", "box 2: width_m must be between 0.001 and 100 m, got 1100 m; looks like m"),
        (f"{BOX}{BOX}mass_kg = '3 t'", "", "[container] box 2: mass_kg must be a number"),
        (f"{BOX}{BOX}centroid_m = 1.2", "", "box 2: centroid_m must be less than its height_m = 1 m, got 1.2 m"),
        (f"{BOX}{BOX}mass_kg = 2.5", "", "box 2: 2.5 kg on 1.1 x 1.1 x 1 m is a mean density of 2.07 kg/m3"),
        (f"{BOX}{BOX}height_m = 0.05", "", "box 2: width_m over height_m must lie between 0.02 and 20"),
        (f"wall_m = 0.01\n{BOX}{BOX}wall_m = 0.5", "", "box 2: wall_m must be less than half its smallest outer"),
    ],
)  # fmt: skip
def test_a_stack_that_cannot_be_is_refused_in_words(boxes, more, expected):
    assert expected in refused(boxes, more=more)
