"""The unknown inputs of a case: ranges that follow it or are stated, changed cases, Sobol's points, bad ranges."""

from typing import get_args

import numpy as np
import pytest
from cases import named_case

from contact.stepping.modes import SLIDING
from fem.case.case import CaseError, load_case, read_case, to_toml
from fem.case.tables.all_tables import TABLES
from fem.case.tables.input_ranges import UnknownNumber
from fem.case.tables.links import ROWS
from fem.case.tables.unknown_inputs import INPUTS, UNKNOWN, ranges_of
from fem.case.uncertainty import all_changes, as_changed, latin_hypercube, stiff_floor
from fem.model.geometry import build_container

PENALTY = 1e9
FRICTION = {"contact.mu_kinetic": 0.2}


def changes(name="harmonic", values=None):
    """Labels of the changes of one input."""
    return [one.label for one in all_changes(named_case(name, values), PENALTY)[0]]


def ends(name="harmonic", values=None):
    return {one.key: one.ends for one in ranges_of(named_case(name, values), PENALTY)}


def test_defaults_follow_the_case():
    assert ends("harmonic", FRICTION) == {
        "contact.mu_kinetic": (0.4,),
        "contact.mu_static": (pytest.approx(0.36), pytest.approx(0.44)),
        "contact.weakening_m": (0.005,),
        "contact.stribeck_velocity_m_s": (0.3,),
        "support.kind": ("flat",),
        "container.centroid_m": (pytest.approx(0.49), pytest.approx(0.51)),
        "container.eccentricity_m": (pytest.approx(-0.011), pytest.approx(0.011)),
        "support.effective_width": (0.97,),
        "floor.slope_percent": (-0.5, 0.5),
        "motion.ramp_cycles": (2.0,),
        "contact.normal_penalty_Pa_m": (pytest.approx(PENALTY / 9.0), 3.0 * PENALTY),
        "contact.damping_ratio": (1.0, 4.0),
        "contact.restitution_over_housner": (0.95, 1.06),
        "container.damping_ratio": (0.01, 0.04),
    }


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


@pytest.mark.parametrize(
    ("name", "values", "missing"),
    [
        ("harmonic", {}, set()),
        (
            "harmonic",
            {"uncertainty.mu_kinetic": "held"},
            {"contact.mu_kinetic", "contact.weakening_m", "contact.stribeck_velocity_m_s"},
        ),
        ("pulse", FRICTION, {"motion.ramp_cycles"}),
        ("harmonic", FRICTION | {"solver.model": "rigid"}, {"container.damping_ratio"}),
        ("harmonic", FRICTION | {"contact.damping_ratio": 0.0}, {"contact.damping_ratio"}),
        ("harmonic", FRICTION | {"container.joints": "loose", "container.boxes": 2}, {"support.kind"}),
        (
            "harmonic",
            FRICTION | {"support.kind": "feet"},
            {"support.kind", "contact.restitution_over_housner"},
        ),
        (
            "harmonic",
            FRICTION | {"contact.friction": "regularised"},
            {"contact.weakening_m", "contact.stribeck_velocity_m_s"},
        ),
    ],
    ids=[
        "one friction",
        "one friction that is known",
        "a pulse",
        "rigid",
        "no dashpot",
        "loose",
        "feet",
        "regularised",
    ],
)
def test_what_makes_no_difference_is_not_varied(name, values, missing):
    given = ends("harmonic", FRICTION)
    assert set(given) - set(ends(name, values)) == missing


SLAB = FRICTION | {"floor.preset": "concrete C25/30", "floor.corner_patch_m": [0.1, 0.2]}


def test_a_slab_is_tried_at_half_and_twice_its_strength_and_stiffness_in_place_of_the_contact():
    slab, rigid = ends("harmonic", SLAB), ends("harmonic", FRICTION)
    assert slab["floor.bearing_strength_Pa"] == (25e6, 100e6)
    assert slab["floor.youngs_modulus_Pa"] == (15.5e9, 62e9)
    castings = {"support.kind"}  # of 0.2 m under a base 1.1 m deep
    assert set(rigid) - set(slab) == castings | {"contact.normal_penalty_Pa_m", "contact.damping_ratio"}
    assert len(slab) == len(rigid) - 1


def test_ranges_of_a_slab_may_be_stated_and_its_damping_where_it_is_given():
    stated = SLAB | {
        "uncertainty.bearing_strength_Pa": [30e6, 50e6],
        "uncertainty.floor_youngs_modulus_Pa": "known",
    }
    found = ends("harmonic", stated | {"contact.damping_ratio": 0.1})
    assert found["floor.bearing_strength_Pa"] == (30e6,)
    assert "floor.youngs_modulus_Pa" not in found
    assert found["contact.damping_ratio"] == (0.05, 0.2)


def test_draws_of_a_slab_make_cases_that_can_be_read():
    case = named_case("harmonic", SLAB | {"contact.damping_ratio": 0.1})
    drawn = [case.with_values(one.values) for one in all_changes(case, None)[2]]
    strengths = np.log([one.floor.bearing_strength_Pa for one in drawn])
    assert np.mean(strengths) == pytest.approx(np.log(50e6), abs=0.05)
    assert len(drawn) == 32


def test_a_slab_thirty_times_as_stiff_has_thirty_times_the_modulus():
    assert stiff_floor(named_case("harmonic", SLAB), PENALTY).values == {
        "floor.youngs_modulus_Pa": 30.0 * 31e9
    }


def test_the_numerics_are_always_tried():
    for name in ("harmonic", "pulse", "least"):
        assert changes(name)[-1] == "solver.energy_tolerance = 0.1"


GEOMETRY = ["mu_static", "support", "centroid_m", "eccentricity_m", "effective_width", "slope_percent"]


def test_the_floor_jumps_only_where_it_is_asked_for():
    asked = {"uncertainty.start": True}
    assert "motion.start" not in ends("harmonic", FRICTION)
    assert ends("harmonic", FRICTION | asked)["motion.start"] == ("rest",)
    at_rest = {"motion.phase_rad": np.pi / 2}  # its velocity does not jump
    assert "motion.start" not in ends("harmonic", FRICTION | asked | at_rest)


def test_the_phase_of_a_vertical_harmonic_may_be_any():
    vertical = {
        "vertical.kind": "harmonic",
        "vertical.peak_acceleration_m_s2": 2.0,
        "vertical.frequency_Hz": 1.0,
    }
    case = named_case("harmonic", FRICTION | vertical | {"vertical.phase_rad": 0.5})
    (one,) = [one for one in ranges_of(case, PENALTY) if one.key == "vertical.phase_rad"]
    tried = sorted((*one.between, *one.ends))
    assert tried == pytest.approx([0.5 - np.pi, 0.5 - np.pi / 2, 0.5 + np.pi / 2])
    drawn = [case.with_values(one.values).vertical.phase_rad for one in all_changes(case, PENALTY)[2]]
    assert max(drawn) - min(drawn) > 0.9 * 2 * np.pi
    assert "vertical.phase_rad" not in ends("pulse", FRICTION | vertical)


def test_a_range_of_static_friction_stands_for_its_middle():
    case = named_case("harmonic", {"contact.mu_static": [0.3, 0.4]})
    assert case.contact.mu_static == 0.35 and case.contact.mu_kinetic == 0.35
    (one,) = [one for one in ranges_of(case, PENALTY) if one.key == "contact.mu_static"]
    assert one.ends == (0.3, 0.4)
    assert read_case(to_toml(case)).uncertainty.mu_static == [0.3, 0.4]


@pytest.mark.parametrize(
    ("given", "changed", "expected"),
    [
        (FRICTION, {"contact.mu_static": 0.36}, (0.36, 0.18)),
        ({}, {"contact.mu_static": 0.36}, (0.36, 0.36)),
        (FRICTION, {"contact.mu_kinetic": 0.3}, (0.4, 0.3)),
        (FRICTION, {"contact.mu_static": 0.36, "contact.mu_kinetic": 0.4}, (0.36, 0.36)),
    ],
)
def test_kinetic_friction_keeps_its_share_of_the_static_and_is_never_larger(given, changed, expected):
    case = named_case("harmonic", given)
    contact = case.with_values(as_changed(case, changed)).contact
    assert (contact.mu_static, contact.mu_kinetic) == pytest.approx(expected)


def test_a_base_that_touches_otherwise_has_another_patch_on_a_slab():
    walls = {"floor.preset": "concrete C25/30", "floor.corner_patch_m": [0.008, 1.1]}
    case = named_case("harmonic", FRICTION | walls)
    assert ends("harmonic", FRICTION | walls)["support.kind"] == ("flat",)
    flat = case.with_values(as_changed(case, {"support.kind": "flat"}))
    assert (flat.support.kind, flat.floor.corner_patch_m) == ("flat", [0.55, 1.1])


def test_a_stated_range_that_excludes_the_value_is_refused(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(to_toml(named_case("harmonic", FRICTION)), encoding="utf-8")
    with pytest.raises(CaseError, match=r"mu_kinetic = \[0.25, 0.3\] excludes the value of the case"):
        load_case(path, ["uncertainty.mu_kinetic=[0.25,0.3]"])


def test_a_stated_range_replaces_the_default_and_known_leaves_it_out():
    stated = FRICTION | {
        "uncertainty.mu_kinetic": [0.1, 0.3],
        "uncertainty.weakening_m": "known",
        "uncertainty.stribeck_velocity_m_s": "known",
        "uncertainty.normal_penalty_Pa_m": [1e8, PENALTY],
        "uncertainty.damping_ratio": "known",
        "uncertainty.material_damping_ratio": [0.02, 0.02],
        "uncertainty.ramp": False,
        "uncertainty.restitution_over_housner": "held",
        **dict.fromkeys([f"uncertainty.{name}" for name in GEOMETRY], "held"),
    }
    assert ends("harmonic", stated) == {
        "contact.mu_kinetic": (0.1, 0.3),
        "contact.normal_penalty_Pa_m": (1e8,),
    }
    assert all_changes(named_case("harmonic", stated), None)[1] == ()


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


LOOSE = FRICTION | {"container.boxes": 3, "container.joints": "loose"}
JOINTS = ("joints.mu_static", "joints.mu_kinetic", "joints.weakening_m")


def of_joints(values=None):
    return {key: some for key, some in ends("harmonic", LOOSE | (values or {})).items() if key in JOINTS}


def test_friction_between_loose_boxes_is_unknown_apart_from_that_of_the_floor():
    assert of_joints() == dict(zip(JOINTS, ((0.2, 0.8), (0.4,), (0.005,)), strict=True))
    assert of_joints({"joints.mu_static": 0.3}) == {
        "joints.mu_kinetic": (0.15, 0.3),
        "joints.weakening_m": (0.005,),
    }
    assert of_joints({"joints.mu_static": 0.2})["joints.mu_kinetic"] == (0.1,)
    known = dict.fromkeys(("uncertainty.joints_mu_static", "uncertainty.joints_mu_kinetic"), "known")
    assert of_joints(known) == {"joints.weakening_m": (0.005,)}
    stated = {"uncertainty.joints_mu_static": [0.3, 0.5], "uncertainty.joints_weakening_m": [0.0, 1e-3]}
    assert of_joints(stated)["joints.mu_static"] == (0.3, 0.5)
    assert of_joints(stated)["joints.weakening_m"] == (1e-3,)
    # where the floor's friction does not fall, that of the joints may, and with the slip velocity, too
    kept = {"contact.mu_kinetic": 0.4, "joints.mu_kinetic": 0.2, "uncertainty.mu_kinetic": "held"}
    assert "contact.stribeck_velocity_m_s" in ends("harmonic", LOOSE | kept)
    assert "contact.weakening_m" not in ends("harmonic", LOOSE | kept)


@pytest.mark.parametrize(
    ("given", "tried"),
    [({}, (0.1,)), ({"joints.damping_ratio": 0.5}, (0.1, 2.0)), ({"joints.damping_ratio": 4.0}, (0.1,))],
)
def test_the_dashpot_of_loose_joints_is_unknown_whatever_the_floor_is(given, tried):
    for floor in (
        {},
        {"contact.damping_ratio": 0.3},
        {"floor.preset": "asphalt", "floor.corner_patch_m": [0.1, 0.2]},
    ):
        assert ends("harmonic", LOOSE | given | floor)["joints.damping_ratio"] == tried
    assert "joints.damping_ratio" not in ends("harmonic", {})


@pytest.mark.parametrize(
    ("given", "changed", "expected"),
    [
        ({}, {"contact.mu_kinetic": 0.4, "contact.weakening_m": 1e-3}, (0.4, 0.2, 0.0)),
        ({}, {"contact.mu_static": 0.42, "contact.mu_kinetic": 0.22}, (0.4, 0.2, 0.0)),
        ({}, {"joints.mu_static": 0.8}, (0.8, 0.4, 0.0)),
        ({}, {"joints.mu_static": 0.8, "joints.mu_kinetic": 0.3}, (0.8, 0.3, 0.0)),
        ({}, {"joints.mu_kinetic": 0.4}, (0.4, 0.4, 0.0)),
        ({"joints.mu_static": 0.15}, {"contact.mu_kinetic": 0.1}, (0.15, 0.15, 0.0)),
    ],
)
def test_a_changed_case_keeps_the_friction_between_its_boxes(given, changed, expected):
    case = named_case("harmonic", LOOSE | given)
    found = case.with_values(as_changed(case, changed)).joint_friction
    assert tuple(found.values()) == pytest.approx(expected)


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


def test_one_body_has_no_friction_between_boxes():
    bolted = named_case("harmonic", LOOSE | {"container.joints": "bolted"})
    assert as_changed(bolted, {"contact.mu_kinetic": 0.3}) == {"contact.mu_kinetic": 0.3}
    assert not set(JOINTS) & {one.key for one in ranges_of(bolted, PENALTY)}


def test_a_ramp_fits_the_motion():
    short = {"motion.cycles": 3.0}
    assert ends("harmonic", short)["motion.ramp_cycles"] == (pytest.approx(1.5),)
    ramped = FRICTION | {"motion.ramp_cycles": 1.0}
    assert ends("harmonic", ramped)["motion.ramp_cycles"] == (0.0,)
    for values in (short, ramped, {"solver.duration_s": 0.5}):
        case = named_case("harmonic", values)
        for one in all_changes(case, PENALTY)[0]:
            case.with_values(one.values)


def test_a_stiff_floor_is_thirty_times_as_stiff():
    assert stiff_floor(named_case("harmonic"), PENALTY).values == {
        "contact.normal_penalty_Pa_m": 30.0 * PENALTY
    }


@pytest.mark.parametrize("width", [0.4, 1.1, 1.35, 1.41, 1.45, 1.6, 2.5])
@pytest.mark.parametrize("ratio", [None, 0.95])
def test_the_impacts_of_a_squat_box_make_cases_that_can_be_read(width, ratio):
    """Housner's restitution falls through zero at a width of 1.41 times the height."""
    values = {"container.boxes": 1, "container.width_m": width, "contact.restitution_over_housner": ratio}
    case = named_case("rocking", values)
    tried = [one.values for one in (*all_changes(case, None)[0], *all_changes(case, None)[2])]
    for one in tried:
        case.with_values(one)
    assert any("contact.restitution_over_housner" in one for one in tried) == (width < 2**0.5)


@pytest.mark.parametrize(
    ("keys", "tried"),
    [("motion.pulse_s=1", False), ("container.eccentricity_m=0.05", True), ("floor.slope_percent=1", True)],
)
def test_a_pulse_is_tried_from_the_other_side_where_left_and_right_differ(keys, tried):
    pulse = (
        "motion.kind=pulse",
        "motion.shape=sine",
        "motion.peak_acceleration_m_s2=3.8",
        "motion.pulse_s=1.0",
    )
    for held, expected in (([], {(-3.8,)} if tried else set()), (["uncertainty.sign=false"], set())):
        ranges = ranges_of(load_case("rocking", [*pulse, keys, *held]), 1e9)
        assert {one.ends for one in ranges if one.key.startswith("motion.")} == expected


def test_the_phase_of_a_harmonic_motion_is_tried_where_its_range_is_stated():
    stated = ranges_of(load_case("rocking", ["uncertainty.phase_rad=[0.0, 1.5]"]), 1e9)
    (phase,) = (one for one in stated if one.key == "motion.phase_rad")
    assert (phase.ends, phase.between) == ((1.5,), (0.375, 0.75, 1.125))
    assert "motion.phase_rad" not in {one.key for one in ranges_of(load_case("rocking"), 1e9)}
