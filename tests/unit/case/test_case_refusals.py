"""What a case file may not say: each is refused with its place, its value and a way out; extremes are not."""

import re

import pytest
from cases import named_case

from contact.stepping.modes import SLIDING
from fem.case.overrides import parse_override
from fem.case.tables.boxes import MICROSLIP
from fem.case.validation import CaseError


def case_of(name, changes):
    """A named case with changes as `--set` takes them, separated by ` & `."""
    return named_case(name, dict(parse_override(change) for change in changes.split(" & ") if change))


def rows(table):
    """Rows of a table of named case, changes and what is expected; an indented line continues the one above."""
    lines = [line.split(" | ", 2) for line in re.sub(r"\n +", " ", table.strip()).splitlines()]
    return [pytest.param(*(cell.strip() for cell in line), id=f"{line[1].strip()[:50]}") for line in lines]


EXTREMES = """
least    | container.width_m=0.02 & container.weight_N=8
least    | container.width_m=20 & container.depth_m=1 & container.weight_N=4e5
least    | container.width_m=1 & container.height_m=50 & container.weight_N=1e6 & container.centroid_m=25
harmonic | motion.amplitude_m=2.5e-3 & motion.angular_frequency_rad_s=628.3
harmonic | motion.amplitude_m=0.1 & motion.angular_frequency_rad_s=0.06284
least    | container.boxes=50
least    | container.wall_m=5e-5
least    | container.wall_m=0.499
least    | solver.elastic_modes=0
least    | solver.spectral_radius=0.0
least    | solver.spectral_radius=1.0
least    | solver.scheme=newmark
least    | solver.scheme=newmark & solver.newmark_beta=0.3025 & solver.newmark_gamma=0.6
pulse    | motion.delay_s=1.0
"""


@pytest.mark.parametrize(("name", "changes"), rows(EXTREMES))
def test_extremes_that_the_program_can_compute_are_not_taken_for_slips(name, changes):
    assert case_of(name, changes).gravity_m_s2 == 9.81


LEAST_WEAKENING = 1.1e-4  #: [m], of boxes 1.1 m wide


@pytest.mark.parametrize("key", ["contact.weakening_m", "joints.weakening_m"])
def test_a_fall_of_friction_within_microslip_is_refused_with_what_to_give(key):
    loose = {"container.joints": "loose"} if key.startswith("joints") else {}
    unknown = key.replace("contact.", "uncertainty.").replace("joints.", "uncertainty.joints_")
    for value in (0.0, LEAST_WEAKENING, 1e-3):
        named_case("seed_stack", {key: value, unknown: [0.0, max(value, LEAST_WEAKENING)]} | loose)
    for changes in ({key: 0.99 * LEAST_WEAKENING}, {unknown: [0.0, 0.99 * LEAST_WEAKENING]}):
        with pytest.raises(
            CaseError, match=r"less than 0\.00011 m \(0\.0001 of the width\).* give 0\.00011 m or more"
        ):
            named_case("seed_stack", changes | loose)
    assert MICROSLIP == SLIDING


REFUSED = """
least | container.shape=cylinder & container.depth_m=2 | depth_m = width_m = 1.1 m, its diameter
least | container.shape=cylinder & support.kind=flat | ends of its diameter
least | container.shape=cylinder & support.casting_m=[0.1, 0.1, 0.0] | no castings
least | container.shape=cylinder & container.wall_m=0.008 & container.post_m=[0.1, 0.01] | no posts
least | container.shape=cylinder & container.mesh_file=a.msh | no mesh_file
least | container.shape=cylinder & container.wall_m=0.008 & floor.preset=concrete C25/30 |
  floor.corner_patch_m on a slab
uneven | container.shape=cylinder | boxes of one diameter on one axis
least | wind.terrain=II | basic_velocity_m_s and terrain belong together
least | wind.german_zone=2 & wind.terrain=II | exactly one of the three must be given
"""


@pytest.mark.parametrize(("name", "changes", "says"), rows(REFUSED))
def test_a_cylinder_and_a_wind_that_cannot_be_are_refused_with_a_sentence(name, changes, says):
    with pytest.raises(CaseError, match=re.escape(says)):
        case_of(name, changes)
