"""`contact.restitution_over_housner`: the contact found for it, what refuses it, and what repeats a run of it."""

import json

import pytest
from cases import named_case

from fem.__main__ import main
from fem.case.case import CaseError, load_case, read_case, to_toml
from fem.case.uncertainty import changes_of
from fem.case.unknown_inputs import ranges_of
from fem.model.geometry import build_container
from fem.model.model import build_model
from fem.model.motion import build_motions
from fem.run.compute import compute
from fem.run.solve import resolve

STATED = "contact.restitution_over_housner"
#: the stack of the paper as a rigid body: Housner's restitution 0.8945
STACK = {"solver.model": "rigid", "container.boxes": 4, "output.fields_s": 0.0, "solver.element_size_m": 0.5}


def stack(ratio, **changes):
    return named_case(
        "least", STACK | {STATED: ratio} | {key.replace("__", "."): v for key, v in changes.items()}
    )


def refused(ratio, **changes):
    with pytest.raises(CaseError) as error:
        build_model(stack(ratio, **changes))
    return str(error.value)


def test_more_than_the_usual_contact_leaves_is_had_by_less_damping():
    usual = build_model(named_case("least", STACK))
    for ratio in (1.0, 1.02, 1.05):
        model = build_model(stack(ratio))
        assert model.penalty == pytest.approx(usual.penalty)
        assert model.damping_ratio < usual.damping_ratio
    assert build_model(stack(1.02)).damping_ratio > build_model(stack(1.05)).damping_ratio


def test_less_is_had_by_a_softer_floor_under_the_usual_damping():
    usual = build_model(named_case("least", STACK))
    penalties = [build_model(stack(ratio)).penalty for ratio in (0.99, 0.95, 0.8)]
    assert usual.penalty > penalties[0] > penalties[1] > penalties[2]
    assert build_model(stack(0.8)).damping_ratio == usual.damping_ratio


# Free rocking from another angle than that of the search, 0.6 of the slenderness angle.
@pytest.mark.parametrize(("ratio", "within"), [(0.9, 0.02), (0.95, 0.01), (1.0, 0.001), (1.05, 0.005)])
def test_a_run_has_the_stated_restitution_at_its_first_impact(ratio, within):
    run = compute(
        stack(ratio, initial__rotation_rad=0.6 * 0.2684, contact__mu_static=1.0, solver__duration_s=3.0)
    )
    assert run.verdict.restitution_first == pytest.approx(ratio * 0.8945, abs=within)


def test_an_elastic_container_stands_on_the_contact_of_the_rigid_one():
    rigid, elastic = (build_model(stack(0.95, solver__model=model)) for model in ("rigid", "reduced"))
    assert elastic.penalty == pytest.approx(rigid.penalty, rel=1e-3)
    assert elastic.damping_ratio == pytest.approx(rigid.damping_ratio)


@pytest.mark.parametrize(
    ("changes", "ratio", "said"),
    [
        ({}, 1.2, "this container on corners can have 0.5 to 1.06"),
        (
            {"container__boxes": 1},
            0.95,
            "too squat: Housner's restitution is 0.179, below 0.5, and no measure",
        ),
        ({"support__kind": "flat", "solver__element_size_m": 0.1}, 0.67, "on flat can have 1.05"),
        ({"support__kind": "feet", "solver__element_size_m": 0.15}, 1.2, "on feet can have 0.9872 to 1.09"),
    ],
    ids=["bounces", "squat", "flat", "feet"],
)
def test_what_the_support_cannot_give_is_refused_with_the_range_that_it_can(changes, ratio, said):
    assert said in refused(ratio, **changes)


def test_it_excludes_a_slab_which_has_its_own():
    slab = {"floor__kind": "slab", "floor__preset": "concrete C25/30", "floor__corner_patch_m": [0.1, 0.1]}
    assert "restitution_over_housner belongs to floor.kind" in refused(0.95, **slab)


def test_the_resolved_case_states_it_and_gives_the_same_run():
    case = stack(0.97, initial__rotation_rad=0.1, solver__duration_s=1.5)
    resolved = read_case(to_toml(resolve(case, build_container(case), build_motions(case))))
    assert resolved.contact.restitution_over_housner == 0.97
    assert resolved.contact.damping_ratio is None
    runs = [compute(one, band=False) for one in (case, resolved)]
    assert runs[0].history["rotation_rad"].tolist() == runs[1].history["rotation_rad"].tolist()
    assert runs[0].typed_result.case_hash == runs[1].typed_result.case_hash


def test_the_band_varies_the_restitution_in_place_of_stiffness_and_damping():
    given = {one.key: one.ends for one in ranges_of(stack(0.95), 1e9)}
    low, high = given[STATED]
    # a loss of 1 - 0.95 x 0.8945, half more and a fifth less
    assert 1.0 - 0.8945 * low == pytest.approx(1.5 * (1.0 - 0.95 * 0.8945), abs=1e-4)
    assert 1.0 - 0.8945 * high == pytest.approx(0.8 * (1.0 - 0.95 * 0.8945), abs=1e-4)
    assert not given.keys() & {"contact.normal_penalty_Pa_m", "contact.damping_ratio"}
    stated = stack(0.95, uncertainty__restitution_over_housner=[0.9, 1.0])
    assert [one.values[STATED] for one in changes_of(stated, 1e9) if STATED in one.values] == [0.9, 1.0]


def test_check_prints_what_it_amounts_to(capsys):
    main(["check", "free_rocking", "--set", f"{STATED}=0.95", "--json"])
    document = json.loads(capsys.readouterr().out)
    model = build_model(load_case("free_rocking", [f"{STATED}=0.95"]))
    housner = document["static"]["housner_restitution"]
    assert document["contact_restitution"] == pytest.approx(0.95 * housner)
    assert document["numerics"]["normal_penalty_Pa_m"] == pytest.approx(model.penalty)
    assert document["numerics"]["contact_damping_ratio"] == pytest.approx(model.damping_ratio)
    main(["check", "free_rocking", "--set", f"{STATED}=0.95"])
    assert "0.95 of Housner's" in capsys.readouterr().out
