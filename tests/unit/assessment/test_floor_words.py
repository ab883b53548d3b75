"""What is said of the floor: by `check`, behind the figures of an impact, where it is crushed or the shell yields."""

from dataclasses import replace

from fem.assessment.floor_words import floor_rows
from fem.assessment.ranges import UNTRIED, impact_note, largest_stress, plastic_corner
from fem.case.case import load_case
from fem.cli.check import check, preview_of
from fem.results.run_result import Band, Verdict

COARSE = ("solver.element_size_m=0.5", "solver.order=1")
SLAB = ("floor.preset=concrete C25/30", "floor.corner_patch_m=[0.008, 1.1]", *COARSE)
CRUSHED = Verdict(max_indentation_m=0.0, impacts=3)
#: 2 MN on a wall that yields at 1 MN over a floor of 1e9 N/m: (4 - 1) MN^2/2e9 N/m
YIELDED = Verdict(
    max_von_mises_Pa=300e6,
    yield_strength_Pa=235e6,
    max_corner_force_N=2e6,
    corner_capacity_N=1e6,
    plastic_work_J=1500.0,
)


def rows(*overrides):
    return dict(floor_rows(preview_of(load_case("rocking", [*SLAB, *overrides])).floor))


def test_check_says_what_a_slab_amounts_to(capsys):
    check("rocking", overrides=[*SLAB, "floor.slope_percent=2"])
    page = " ".join(capsys.readouterr().out.split())
    # 31 GPa under 8 mm x 1.1 m is 8.1e9 N/m by an estimate apart from the program, 10 t on two of them 203 Hz.
    for words in (
        "slab concrete C25/30: E = 31 GPa, nu = 0.2, strength 50 MPa",
        "corner 0.008 x 1.1 m: 8142 kN/mm, contact frequency 203.1 Hz, sinks in by 6.024 um at rest",
        "crushes at 440 kN a corner at its surface, 4.5 times the weight; the steel above it yields at 2068 kN",
        "slope 2 %, it falls to the right (+x)",
        "one impact back from 0.2 of the slenderness angle it would strike at 0.33 m/s and crush the corner",
        "contact frequency 203.1 Hz, static penetration 6.02 um",
    ):
        assert words in page
    assert "penalty" not in page


def test_the_side_that_gives_way_first_is_named():
    assert (
        "where the steel above it yields; the floor bears 1000 kN"
        in rows("floor.corner_patch_m=[0.1, 0.2]")["crushes at"]
    )
    hit = rows("floor.preset=rubber mat", "floor.corner_patch_m=[0.2, 1.1]")["one impact"]
    assert hit.endswith("and crush nothing")


def test_a_rigid_level_floor_has_no_rows():
    assert floor_rows(None) == []
    assert dict(floor_rows(preview_of(load_case("rocking", ["floor.kind=rigid"])).floor)) == {}


def test_a_floor_too_steep_is_noted():
    steep = ["floor.slope_percent=15", "contact.mu_static=0.1", "contact.mu_kinetic=0.1", "motion.kind=none"]
    notes = preview_of(load_case("rocking", [*SLAB, *steep])).notes
    assert any("steeper than static friction holds" in note for note in notes)


def test_an_impact_on_a_slab_is_for_design_with_its_band():
    assert impact_note(CRUSHED) == f"; {UNTRIED}"
    assert impact_note(replace(CRUSHED, band=Band())) == ""
    assert "not for design" in impact_note(replace(CRUSHED, max_indentation_m=None, band=Band()))
    assert impact_note(replace(CRUSHED, impacts=0)) == ""


def test_beyond_yield_the_shell_is_said_to_be_elastic_and_the_corner_to_yield_as_a_whole():
    words = largest_stress(YIELDED)
    assert "the shell stays elastic and has 300 MPa" in words
    assert words.endswith("1000 kN, less than the largest corner force: as a whole it would yield")


def test_a_corner_below_its_capacity_takes_no_work_and_one_without_a_wall_says_nothing():
    strong = replace(YIELDED, max_corner_force_N=0.9e6, plastic_work_J=0.0)
    assert plastic_corner(strong).endswith("so a rigid-plastic corner would take no work")
    assert plastic_corner(replace(YIELDED, corner_capacity_N=None, plastic_work_J=None)) == ""
