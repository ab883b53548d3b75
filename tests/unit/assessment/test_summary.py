"""Summary and warnings: what is compared, what is never said, what is doubted."""

from dataclasses import replace
from pathlib import Path

import pytest

from fem.assessment.summary import (
    brief_summary,
    outcome_sentence,
    plain_summary,
    result_rows,
    run_lifted,
    run_slid,
    run_tilted,
)
from fem.assessment.warnings import warnings_for
from fem.case.case import Case, load_case
from fem.model.geometry import build_container
from fem.model.model import static_checks_of
from fem.report.comparison import compared_rows
from fem.results.run_result import ActionResult, Band, Energy, MotionResult, Numerics, RunResult, Verdict

# The stack of four under 4.0 m/s2: 40 kN against 39.24 kN, 80 kNm against 53.955 kNm (the paper, g = 9.81).
CASE = load_case("seed_stack_plateau")
RESULT = RunResult(
    status="completed",
    title="Stack",
    static=replace(static_checks_of(CASE, build_container(CASE), 4.0).to_result(), method_applicable=True),
    verdict=Verdict(
        outcome="rock",
        modes=("rest", "rock"),
        max_rotation_rad=0.1071,
        rotation_ratio=0.3989,
        max_slip_m=2.0e-5,
        residual_slip_m=-1.0e-5,
        slip_travel_m=3.0e-5,
        max_uplift_m=0.1176,
        impacts=17,
        first_opening_s=0.1,
        first_uplift_s=0.12,
        restored=True,
        restitution_first=0.895,
        max_corner_force_N=210.5e3,
        max_top_displacement_m=0.43,
        max_acceleration_m_s2=12.0,
        max_von_mises_Pa=9.0e7,
        yield_strength_Pa=235e6,
    ),
    energy=Energy(
        reference_J=7300.0,
        closure_error=1.0e-5,
        friction_J=1.0,
        contact_damping_J=900.0,
        material_damping_J=20.0,
        numerical_J=0.05,
        base_work_J=400.0,
    ),
    numerics=Numerics(
        unknowns=23,
        steps=12000,
        rejected=100,
        stepping_cpu_s=0.06,
        contact_frequency_Hz=20.0,
        max_penetration_m=2.0e-4,
        elastic_frequencies_Hz=(120.0, 300.0),
    ),
    wall_s=1.9,
)


def case(*overrides: str) -> Case:
    return load_case("seed_stack_plateau", overrides)


def changed(**paths) -> RunResult:
    """RESULT with `block__key=value` replaced."""
    result = RESULT
    for path, value in paths.items():
        result = with_value(result, path.split("__"), value)
    return result


def with_value(block, keys, value):
    first, *rest = keys
    return replace(block, **{first: with_value(getattr(block, first), rest, value) if rest else value})


def text_of(result: RunResult, folder: Path = Path("outputs/stack")) -> str:
    return plain_summary(result, folder=folder)


def words_of(**paths) -> str:
    return " ".join(text_of(changed(**paths)).split())


def test_results_come_first_and_numerics_last():
    text = text_of(RESULT)
    places = [
        text.index(words) for words in ("Result: ", "The run", "Static rules", "not a margin", "Numerics")
    ]
    assert places == sorted(places)


def test_lines_fit_a_terminal_of_80_columns():
    heavy = changed(static__own_motion__base_shear_N=1.234e7, static__sliding_limit_static_N=1.235e7)
    for result in (RESULT, heavy):
        assert max(map(len, text_of(result).splitlines())) <= 80


def test_the_static_rules_stand_beside_what_the_run_found():
    lines = [" ".join(line.split()) for line in text_of(RESULT).splitlines()]
    at = lines.index("own peak sliding 40 / 39.24 kN 1.019 slides held, slip 0.02 mm")
    assert lines[at + 1] == "overturning 80 / 53.95 kNm 1.483 overturns stood, ratio 0.399"
    assert "Static rules, own peak, 4 m/s2" in lines


def test_only_the_own_motion_is_compared_with_the_run():
    lines = [line.split() for line in text_of(RESULT).splitlines()]
    rules = [line[-1] for line in lines if {"sliding", "overturning"} & {*line[:4]} and "/" in line]
    assert rules[2:] == ["slides", "overturns", "slides", "overturns"]


def test_a_demand_without_capacity_is_infinite_and_the_rule_says_so():
    """The floor falls with more than gravity: nothing is left of the weight."""
    static = static_checks_of(CASE, build_container(CASE), 4.0, 12.0)
    lines = plain_summary(replace(RESULT, static=static.to_result()), folder=Path("outputs")).splitlines()
    own, below = (
        next(k for k, line in enumerate(lines) if name in line) for name in ("own, vertical", "code, q")
    )
    said = " ".join(lines[own:below]).split()
    assert said.count("inf") == 2 and {"slides", "overturns"} < set(said)
    rows = compared_rows(static, RESULT.verdict)[2:4]
    assert [(row.utilisation, row.rule) for row in rows] == [("∞", "slides"), ("∞", "overturns")]


def test_a_rule_without_a_demand_says_nothing_of_a_container_that_was_pushed():
    static = static_checks_of(CASE, build_container(CASE), 0.0)
    text = plain_summary(
        replace(RESULT, static=replace(static.to_result(), code=None, code_q1=None)), folder=Path("o")
    )
    assert text.count("no demand") == 2 and "stands " not in text
    assert [row.rule for row in compared_rows(static, RESULT.verdict)[:2]] == ["no demand"] * 2


@pytest.mark.parametrize("status", ["interrupted", "running", "failed"])
def test_a_run_that_has_not_ended_is_not_compared_with_a_rule_on_the_whole_motion(status):
    for make in (plain_summary, brief_summary):
        text = make(replace(RESULT, status=status), folder=Path("outputs"))
        assert "slides" in text and "held" not in text and "stood" not in text


def test_of_a_run_that_is_not_valid_nothing_is_said_to_have_held():
    verdict = replace(RESULT.verdict, outcome="invalid", invalid_reason="its floor is crushed")
    assert [words(verdict) for words in (run_slid, run_tilted, run_lifted)] == ["not valid"] * 3
    assert "held" not in plain_summary(replace(RESULT, verdict=verdict), folder=Path("outputs"))


def test_the_summary_holds_what_the_run_found_in_units_for_people():
    text = words_of()
    for words in (
        "6.14 degrees, 0.399 of the slenderness angle",
        "largest slip 0.02 mm slip at the end -0.01 mm path of slip 0.03 mm",
        "117.6 mm",
        "210.5 kN",
        "0.895 (Housner 0.895)",
        "1e-05 of the 7300 J that it takes to overturn; numerical loss 0.05 J",
        "12000, 100 rejected, 23 unknowns",
    ):
        assert words in text


@pytest.mark.parametrize(
    ("result", "sentence"),
    [
        (RESULT, "Result: rocked, returned upright and did not overturn under this motion."),
        (
            changed(verdict__outcome="rest", verdict__restored=False),
            "Result: rested and did not overturn under this motion.",
        ),
        (changed(motion=MotionResult(kind="none")), "Result: rocked, returned upright and did not overturn."),
        (
            changed(verdict__outcome="slide-rock", verdict__band=Band(unsure=True)),
            "Result: slid, rocked, returned upright and did not overturn under this motion. "
            "Unsure: see the band.",  # of a former version
        ),
        (
            changed(status="overturned", verdict__outcome="overturned", verdict__overturned_at_s=3.25),
            "Result: overturned at t = 3.250 s.",
        ),
        (
            changed(status="interrupted", numerics__simulated_s=0.1344),
            "Not finished (interrupted). So far: rocked, returned upright and did not overturn up to t = 0.1344 s.",
        ),
        (RunResult(status="interrupted"), "Not finished (interrupted). So far: no result yet."),
        (
            RunResult(status="failed", error="step 3: residual 4 N"),
            "No verdict: step 3: residual 4 N. Results up to there are kept.",
        ),
    ],
)
def test_the_outcome_is_one_sentence(result, sentence):
    assert outcome_sentence(result) == sentence


@pytest.mark.parametrize("outcome", ["rest", "slide", "rock", "slide-rock", "overturned"])
def test_a_run_is_never_called_safe_or_verified(outcome):
    result = changed(verdict__outcome=outcome)
    text = text_of(replace(result, warnings=tuple(warnings_for(result, CASE)))).lower()
    assert not any(word in text for word in ("safe", "verified", "stable"))


def test_overturning_is_what_the_run_found_when_it_overturned():
    text = words_of(status="overturned", verdict__outcome="overturned")
    assert "1.483 overturns overturned" in text and "ratio is not a margin" not in text


def test_sliding_is_what_the_run_found_when_it_slid():
    text = words_of(verdict__outcome="slide", verdict__modes=("rest", "slide"), verdict__max_slip_m=0.0791)
    assert "slid, slip 79.1 mm" in text


def test_unfinished_results_are_shown_as_far_as_they_go():
    for status in ("running", "interrupted", "failed"):
        assert "run.json" in text_of(RunResult(status=status))
    assert "own peak, 4 m/s2" in words_of(verdict=None, energy=None, numerics=None, wall_s=None)


def test_slip_and_rotation_of_rounding_are_shown_as_small():
    text = words_of(
        verdict__max_slip_m=4.5e-10,
        verdict__residual_slip_m=-9e-11,
        verdict__outcome="rest",
        verdict__max_rotation_rad=1e-5,
        verdict__rotation_ratio=3.7e-5,
    )
    assert "held, slip < 0.01 mm" in text and "slip at the end < 0.01 mm path of slip 0.03 mm" in text
    assert "< 0.01 degrees, < 0.001 of the slenderness angle" in text and "ratio < 0.001" in text


def test_compilation_is_shown_apart_from_stepping():
    assert "compilation" not in words_of(compile_s=0.0)
    first = words_of(wall_s=62.4, compile_s=57.12)
    assert "62.4 s, of which compilation 57.1 s (once after installation), stepping" in first


@pytest.mark.parametrize("name", ["short", "a folder with words", "long-" * 40])
def test_summary_says_what_to_open_with_unbroken_paths(tmp_path, name):
    folder = tmp_path / name
    assert "no fields were written" in text_of(RESULT, folder)
    (folder / "fields").mkdir(parents=True)
    (folder / "fields" / "run.pvd").write_text("")
    text = text_of(RESULT, folder)
    assert "Warp By Vector displacement_m" in text
    for file in ("fields/run.pvd", "history.csv", "run.json"):
        assert str(folder / file) in text


def test_the_terminal_shows_at_most_forty_lines_and_where_the_rest_is(tmp_path):
    text = brief_summary(changed(warnings=("a", "b")), folder=tmp_path)
    assert len(text.splitlines()) <= 40
    assert outcome_sentence(RESULT).split(".")[0][:30] in text
    assert "largest rotation" in text and "own peak" in text and "code, q" not in text
    assert f"Whole summary, with 2 warnings: {tmp_path / 'summary.txt'}" in text
    read = changed(motion=MotionResult(notes=("what was read",)))
    assert "Warning: what was read" in brief_summary(read, folder=tmp_path)


def test_titles_and_warnings_are_never_read_as_markup():
    text = text_of(changed(title="[red]x[/oops]", warnings=("[bold]w[/bold]",)))
    assert text.startswith("[red]x[/oops]\n") and "Warning: [bold]w[/bold]" in text


@pytest.mark.parametrize(
    ("result", "words"),
    [
        (
            changed(static__housner_credible=False, static__housner_restitution=0.17873),
            "Housner's restitution is 0.179",
        ),
        (changed(numerics__max_penetration_m=1.6e-3), "penetration reached 1.6 mm"),
        (changed(energy__numerical_J=-0.4), "energy gain 5.5e-05"),
        (changed(energy__closure_error=6.5e-4), "energy balance error 4.75 J (limit 9.21 J)"),
        (changed(energy__closure_error=5.5e-4, energy__contact_damping_J=0.0), "(limit 7.3 J)"),
        (changed(verdict__first_uplift_s=None), "a gap opened at the base at t = 0.1 s"),
        (changed(numerics__rejected=700), "6 % of the steps were rejected"),
        (changed(verdict__max_von_mises_Pa=2.4e8), "reached 240 MPa"),
        (
            changed(
                verdict__band=Band(outcomes=("rock", "slide-rock"), rotation_ratio=(0.2, 0.41), unsure=True)
            ),
            "unsure: see the band.",
        ),
        (
            changed(
                verdict__outcome="rest",
                static__own_motion=ActionResult(utilisation_sliding=0.61, utilisation_overturning=0.89),
            ),
            "decides nothing",
        ),
    ],
)
def test_each_doubt_raises_its_own_warning_and_no_other(result, words):
    (warning,) = warnings_for(result, CASE)
    assert words in warning


@pytest.mark.parametrize(
    "result",
    [
        RESULT,
        RunResult(status="failed"),
        RunResult(status="running"),
        changed(static__housner_credible=None),
        changed(numerics__contact_frequency_Hz=200.0),  # impacts keep their restitution
        changed(static__housner_credible=False, static__housner_restitution=0.17873, verdict__impacts=0),
        changed(numerics__max_penetration_m=1.4e-3),  # half of 0.01 x 0.26839 x 1.1 m is 1.476 mm
        changed(energy__numerical_J=-0.36),
        changed(energy__closure_error=6.2e-4),
        changed(numerics__rejected=600),
        changed(verdict__max_von_mises_Pa=2.3e8),
        changed(verdict__outcome="rest"),  # the static rule overturns: that is news, and no warning
    ],
)
def test_no_warning_on_the_good_side_of_a_limit_or_without_results(result):
    assert warnings_for(result, CASE) == []


def test_a_rest_that_a_variation_ends_confirms_no_rule():
    resting = changed(
        verdict__outcome="rest",
        static__own_motion=ActionResult(
            base_shear_N=3e4, tilting_moment_Nm=4e4, utilisation_sliding=0.9, utilisation_overturning=0.8
        ),
    )
    (warning,) = warnings_for(resting, CASE)
    assert "confirms it" in warning
    for sure in ("regime unsure", "unsure"):
        moved = replace(resting, verdict=replace(resting.verdict, sure=sure))
        assert not [words for words in warnings_for(moved, CASE) if "confirms it" in words]


def test_creep_of_regularised_friction_is_estimated():
    # v = v_reg artanh(s): 11 mm in 20 s at 1 mm/s and half the friction limit.
    result = changed(static__own_motion__utilisation_sliding=0.5)
    regularised = case("contact.friction=regularised")
    (warning,) = warnings_for(result, regularised)
    assert "by 11 mm in 20 s" in warning
    (beyond,) = warnings_for(RESULT, regularised)  # more than friction can carry: it slides
    assert "creeps; friction = 'elastic-stick' does not" in beyond


@pytest.mark.parametrize(
    ("result", "override"),
    [
        (changed(numerics__contact_frequency_Hz=900.0), "solver.model=rigid"),  # no elastic frequency
        # no steel that yields
        (
            changed(verdict__max_von_mises_Pa=2.4e8, verdict__yield_strength_Pa=None),
            "container.section=solid",
        ),
    ],
)
def test_no_warning_of_what_the_model_does_not_have(result, override):
    assert warnings_for(result, case(override)) == []


def test_a_container_too_soft_for_the_linear_model_raises_a_warning():
    soft = ("container.section=solid", "container.youngs_modulus_Pa=1e7")
    (warning,) = warnings_for(changed(verdict__max_von_mises_Pa=1.2e5), case(*soft))
    assert "strain reached 1.2 %" in warning and 'solver.model = "full"' in warning
    assert warnings_for(changed(verdict__max_von_mises_Pa=0.9e5), case(*soft)) == []
    full = case(*soft, "solver.model=full")
    assert warnings_for(changed(verdict__max_von_mises_Pa=1.2e5), full) == []


def test_a_contact_that_creeps_under_the_weight_raises_a_warning():
    """2 zeta sqrt(m/(k/2)) = 2 sqrt(2) zeta/(2 pi f_c), against 1/p."""
    result = changed(numerics__contact_frequency_Hz=50.0, static__frequency_parameter_1_s=2.0)
    assert not any("relaxes" in text for text in warnings_for(result, CASE))  # zeta = 2: 18 ms
    creeping = case("contact.damping_ratio=20")
    (warning,) = [text for text in warnings_for(result, creeping) if "relaxes" in text]
    assert "in 0.18 s" in warning and "1/p = 0.5 s" in warning


def test_an_acceleration_of_an_impact_has_its_filter_and_a_former_one_its_mean():
    new = text_of(changed(numerics__contents_filter="Butterworth", numerics__contents_filter_Hz=33.0))
    assert "12 m/s2, low-pass 33 Hz" in new and "contents: Butterworth, 33 Hz" in new
    former = text_of(changed(numerics__acceleration_window_s=0.005))
    assert "12 m/s2, mean over 5 ms" in former and "low-pass" not in former


def test_a_restitution_that_could_not_be_measured_has_no_row():
    assert "restitution, first impact" in dict(result_rows(changed(verdict__restitution_first=0.9)))
    assert "restitution, first impact" not in dict(result_rows(changed(verdict__restitution_first=None)))
