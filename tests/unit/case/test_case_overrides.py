"""`--set table.key=value`: what it changes, what it replaces, and what it says when it cannot."""

import math
from operator import attrgetter

import pytest

from fem.case.case import CaseError, load_case
from fem.case.tables.floors import PRESETS

ON_CONCRETE = "stack_on_concrete"
BASE = "seed_stack"  # amplitude and angular frequency, weight


def refused(*overrides):
    with pytest.raises(CaseError) as error:
        load_case(BASE, overrides)
    return str(error.value)


def test_values_are_read_as_toml_else_as_plain_text():
    case = load_case(
        BASE,
        [
            "contact.mu_kinetic=0.25",
            "container.boxes = 2",
            'support.kind="flat"',
            "solver.model=rigid",
            "output.stop_when_overturned=false",
            "title=a = b",
            "gravity_m_s2=10",
        ],
    )
    assert (case.contact.mu_kinetic, case.container.boxes, case.support.kind) == (0.25, 2, "flat")
    assert (case.solver.model, case.output.stop_when_overturned) == ("rigid", False)
    assert (case.title, case.gravity_m_s2) == ("a = b", 10.0)


ON_ASPHALT = "floor.preset=asphalt & floor.bearing_strength_Pa=4e6 & floor.corner_patch_m=[0.1, 0.2]"


@pytest.mark.parametrize(
    ("changes", "key", "value"),
    [
        ("contact.mu_static=0.7 & contact.mu_static=0.5", "contact.mu_static", 0.5),  # the last one counts
        ("motion.peak_acceleration_m_s2=4.0", "motion.amplitude_m", None),
        ("motion.peak_acceleration_m_s2=4.0", "motion.amplitude", 4.0 / 6.928**2),
        (
            "motion.peak_acceleration_m_s2=4.0 & motion.amplitude_m=0.05",
            "motion.angular_frequency",
            80.0**0.5,
        ),
        ("motion.frequency_Hz=1.0", "motion.angular_frequency_rad_s", None),
        ("motion.frequency_Hz=1.0", "motion.nominal_peak", 0.05 * (2.0 * math.pi) ** 2),
        ("motion.amplitude_m=0.04 & motion.peak_acceleration_m_s2=1.0", "motion.angular_frequency", 5.0),
        ("container.density_kg_m3=1000", "box_mass", 1210.0),
        ("container.mass_kg=2400", "box_mass", 2400.0),
        (f"{ON_ASPHALT} & support.kind=feet", "floor.corner_patch_m", [0.1, 0.2]),
    ],
)
def test_a_key_replaces_those_that_say_the_same(changes, key, value):
    assert attrgetter(key)(load_case(BASE, changes.split(" & "))) == pytest.approx(value)


def test_a_key_that_is_set_later_replaces_what_was_set_before():
    assert load_case("seed_stack_plateau", ["motion.amplitude_m=0.05"]).motion.nominal_peak == pytest.approx(
        0.05 * 6.928**2
    )
    dense = load_case(BASE, ["container.density_kg_m3=1000"])
    assert dense.with_values({"container.mass_kg": 2400.0}).box_mass == 2400.0
    assert dense.with_values({"container.weight_N": 24525.0}).box_mass == pytest.approx(2500.0)
    assert load_case(BASE, SLAB).with_values({"support.kind": "flat"}).floor.corner_patch_m is None


def test_amplitude_keeps_a_peak_acceleration_that_stands_in_for_the_frequency():
    first = load_case(BASE, ["motion.amplitude_m=0.04", "motion.peak_acceleration_m_s2=1.0"])
    assert first.with_values({"motion.amplitude_m": 0.25}).motion.angular_frequency == pytest.approx(2.0)


WALL = "floor.corner_patch_m=[0.008, 1.1]"
SLAB = ["floor.preset=asphalt", "floor.bearing_strength_Pa=4e6", "floor.corner_patch_m=[0.1, 0.2]"]


def test_who_names_a_floor_stands_on_it_with_all_its_numbers():
    asphalt = load_case(BASE, SLAB)
    assert (asphalt.floor.kind, asphalt.floor.bearing_strength_Pa) == ("slab", 4e6)
    concrete = asphalt.with_values({"floor.preset": "concrete C25/30"})
    assert concrete.floor.bearing_strength_Pa == PRESETS["concrete C25/30"].bearing_strength
    assert concrete.floor.corner_patch_m == [0.1, 0.2]


def test_another_kind_of_floor_takes_nothing_of_the_former_one():
    rigid = load_case(BASE, ["floor.kind=rigid"])
    penalty = rigid.with_values({"contact.normal_penalty_Pa_m": 1e9})
    slab = penalty.with_values({"floor.preset": "asphalt"})
    assert slab.contact.normal_penalty_Pa_m == "auto"
    assert slab.with_values({"floor.kind": "rigid"}).resolved() == rigid.resolved()


def test_a_numerical_penalty_replaces_a_slab():
    edge = load_case(ON_CONCRETE, [WALL])
    rigid = edge.with_values({"floor.kind": "rigid", "contact.normal_penalty_Pa_m": 1e9})
    slab = load_case(ON_CONCRETE, SLAB)
    assert slab.with_values({"contact.normal_penalty_Pa_m": 1e9}).resolved() == rigid.resolved()
    assert load_case(BASE, [*SLAB, "contact.damping_ratio=1.0"]).floor.kind == "slab"


def test_a_patch_under_the_wall_follows_wall_and_depth():
    case = load_case(ON_CONCRETE, [WALL]).with_values({"container.depth_m": 0.8})
    assert case.floor.corner_patch_m == [0.008, 0.8]
    assert case.with_values({"container.wall_m": 0.01}).floor.corner_patch_m == [0.01, 0.8]
    castings = load_case(BASE, [*SLAB, "container.depth_m=0.8", "container.wall_m=0.01"])
    assert castings.floor.corner_patch_m == [0.1, 0.2]


def test_of_castings_and_a_patch_the_one_that_is_set_holds():
    edge = load_case(ON_CONCRETE, [WALL])
    assert (edge.support.casting_m, edge.container.corner_post_N) == (None, None)
    castings = edge.with_values({"support.casting_m": [0.1, 0.1, 0.0]})
    assert castings.floor.corner_patch_m is None
    flat = load_case(BASE, ["support.kind=flat"])
    assert (flat.support.casting_m, flat.container.corner_post_N) == (None, None)
    assert castings.with_values({"container.corner_post_N": 1e6}).support.casting_m is not None


def test_castings_become_smaller_with_a_base_that_has_no_room_for_them():
    case = load_case(BASE, ["support.casting_m=[0.2, 0.25, 0.05]"])
    assert case.with_values({"container.width_m": 0.6}).support.casting_m == [0.2, 0.25, 0.05]
    narrow = case.with_values({"container.width_m": 0.4, "container.depth_m": 0.4})
    assert narrow.support.casting_m == pytest.approx([0.15, 0.2, 0.05])
    with pytest.raises(CaseError, match="does not fit under the base"):
        case.with_values({"container.width_m": 0.4, "support.casting_m": [0.2, 0.2, 0.05]})


def test_with_values_leaves_the_case_as_it_was_and_says_what_changed():
    case = load_case(BASE)
    changed = case.with_values({"contact.mu_static": 0.5, "solver.model": "rigid"})
    assert (case.contact.mu_static, changed.contact.mu_static) == (0.4, 0.5)
    assert changed.overrides == ("contact.mu_static=0.5", "solver.model=rigid")
    assert changed.name == BASE


def test_a_number_of_numpy_is_a_number():
    numpy = pytest.importorskip("numpy")
    assert load_case(BASE).with_values({"contact.mu_static": numpy.float64(0.5)}).contact.mu_static == 0.5
