"""The unknown inputs of a case: ranges that follow it or are stated, changed cases, Sobol's points, bad ranges."""

from typing import get_args

import numpy as np
import pytest
from cases import named_case

from contact.stepping.modes import SLIDING
from fem.case.tables.all_tables import TABLES
from fem.case.tables.boxes import MICROSLIP
from fem.case.tables.input_ranges import UnknownNumber
from fem.case.tables.links import ROWS
from fem.case.tables.unknown_inputs import INPUTS, UNKNOWN, ranges_of
from fem.case.uncertainty import all_changes, as_changed, latin_hypercube
from fem.model.geometry import build_container

PENALTY = 1e9
FRICTION = {"contact.mu_kinetic": 0.2}


def ends(name="harmonic", values=None):
    return {one.key: one.ends for one in ranges_of(named_case(name, values), PENALTY)}


def test_the_mass_centre_of_a_solid_box_stays_where_it_can_lie():
    for share, expected in ((0.5, (0.49, 0.51)), (0.66, (0.6468, 2.0 / 3.0)), (0.335, (1.0 / 3.0, 0.3417))):
        values = {"container.section": "solid", "container.centroid_m": share, "container.height_m": 1.0}
        assert ends("harmonic", values)["container.centroid_m"] == pytest.approx(expected)
        for end in ends("harmonic", values)["container.centroid_m"]:
            build_container(named_case("harmonic", values | {"container.centroid_m": end}))


def test_an_impact_never_gives_more_than_there_was():
    """Of a slender container, which loses next to nothing, and of a low one; not on a base without Housner's impact."""
    slender = ends("harmonic", FRICTION | {"container.width_m": 0.4, "container.boxes": 6})
    assert 1.0 < slender["contact.restitution_over_housner"][1] < 1.01
    flat = ends("harmonic", FRICTION | {"support.kind": "flat"})
    assert "contact.restitution_over_housner" not in flat


SLAB = FRICTION | {"floor.preset": "concrete C25/30", "floor.corner_patch_m": [0.1, 0.2]}


def test_draws_of_a_slab_make_cases_that_can_be_read():
    case = named_case("harmonic", SLAB | {"contact.damping_ratio": 0.1})
    drawn = [case.with_values(one.values) for one in all_changes(case, None)[2]]
    strengths = np.log([one.floor.bearing_strength_Pa for one in drawn])
    assert np.mean(strengths) == pytest.approx(np.log(50e6), abs=0.05)
    assert len(drawn) == 32


def test_changes_between_the_ends_are_smaller_than_those_to_an_end():
    shares = {one.label: one.share for one in all_changes(named_case("harmonic", FRICTION), None)[0]}
    assert shares["contact.weakening_m = 0.001"] == pytest.approx(0.2)
    assert shares["contact.weakening_m = 0.003"] == pytest.approx(0.6)
    assert shares["contact.mu_kinetic = 0.3"] == pytest.approx(0.5)
    assert shares["contact.mu_kinetic = 0.4"] == shares["contact.weakening_m = 0.005"] == 1.0


def test_pairs_join_a_smaller_fall_of_friction_with_a_slower_one():
    assert [one.label for one in all_changes(named_case("harmonic", FRICTION), None)[1]] == [
        "contact.mu_kinetic = 0.3, contact.weakening_m = 0.005",
        "contact.mu_kinetic = 0.3, contact.stribeck_velocity_m_s = 0.3",
    ]
    held = {"uncertainty.mu_kinetic": "held"}
    assert all_changes(named_case("harmonic", held), None)[1] == ()


def test_draws_fill_every_range_and_make_cases_that_can_be_read():
    case = named_case("harmonic", FRICTION)
    draws = all_changes(case, PENALTY)[2]
    assert len(draws) == 32
    assert draws == all_changes(case, PENALTY)[2]
    drawn = [case.with_values(one.values) for one in draws]
    friction = [one.contact.mu_kinetic for one in drawn]
    static = np.array([one.contact.mu_static for one in drawn])
    share = np.array(friction) / static
    assert 0.36 < static.min() < 0.365 and 0.435 < static.max() < 0.44
    assert 0.5 < share.min() < 0.52 and 0.98 < share.max() < 1.0
    stiffness = np.log([one.contact.normal_penalty_Pa_m for one in drawn])
    assert np.mean(stiffness) == pytest.approx(np.log(PENALTY / np.sqrt(3.0)), abs=0.1)
    weakenings = sorted(one.contact.weakening_m for one in drawn)
    assert weakenings[16] < 1e-3 and weakenings[0] >= SLIDING * case.container.width_m  # less falls at once
    assert sum(one.motion.ramp_cycles == 2.0 for one in drawn) == 16
    assert {one.support.kind for one in drawn} == {"corners"}
    assert len(all_changes(case, PENALTY, 5)[2]) == 5
    assert all_changes(named_case("harmonic", {"uncertainty.draws": 0}), PENALTY)[2] == ()


@pytest.mark.parametrize("count", [1, 2, 32])
def test_points_lie_in_the_middle_of_their_cells_one_in_each(count):
    points, middles = latin_hypercube(count, 12), (np.arange(count) + 0.5) / count
    np.testing.assert_array_equal(np.sort(points, axis=0), np.repeat(middles[:, None], 12, axis=1))


def test_no_two_of_many_inputs_are_drawn_as_one():
    correlation = np.corrcoef(latin_hypercube(32, 20), rowvar=False)
    assert np.abs(correlation - np.eye(20)).max() < 0.05


def test_every_key_of_the_table_is_an_unknown_input_and_every_input_a_key_of_the_case():
    assert {one.name for one in UNKNOWN} | {"draws"} == set(TABLES["uncertainty"].model_fields)
    assert len(INPUTS) == len(set(INPUTS)) == len(UNKNOWN) + 1
    for one in UNKNOWN:
        table, _, key = one.key.partition(".")
        field = (TABLES | ROWS)[table].model_fields[key]
        if isinstance(one, UnknownNumber):
            declared = [
                *field.metadata,
                *(part for arm in get_args(field.annotation) for part in get_args(arm)),
            ]
            assert one.quantity in declared, one.key


def test_what_slips_so_little_that_it_sticks_is_one_length_for_kernel_and_case():
    assert MICROSLIP == SLIDING


LOOSE = FRICTION | {"container.boxes": 3, "container.joints": "loose"}


def test_draws_of_a_loose_stack_draw_its_joints_and_its_floor_apart():
    case = named_case("harmonic", LOOSE)
    drawn = [case.with_values(as_changed(case, one.values)) for one in all_changes(case, PENALTY)[2]]
    static = np.array([one.joint_friction["mu_static"] for one in drawn])
    share = np.array([one.joint_friction["mu_kinetic"] for one in drawn]) / static
    assert 0.2 < static.min() < 0.21 and 0.76 < static.max() < 0.8
    assert 0.5 < share.min() < 0.52 and 0.98 < share.max() < 1.0
    floor = [one.contact.mu_kinetic for one in drawn]
    assert abs(np.corrcoef(floor, share)[0, 1]) < 0.2
    assert len({one.joint_friction["weakening_m"] / one.contact.weakening_m for one in drawn}) > 16


@pytest.mark.parametrize("width", [0.4, 1.41, 1.45, 2.5])
@pytest.mark.parametrize("ratio", [None, 0.95])
def test_the_impacts_of_a_squat_box_make_cases_that_can_be_read(width, ratio):
    """Housner's restitution falls through zero at a width of 1.41 times the height."""
    values = {"container.boxes": 1, "container.width_m": width, "contact.restitution_over_housner": ratio}
    case = named_case("rocking", values)
    tried = [one.values for one in (*all_changes(case, None)[0], *all_changes(case, None)[2])]
    for one in tried:
        case.with_values(one)
    assert any("contact.restitution_over_housner" in one for one in tried) == (width < 2**0.5)
