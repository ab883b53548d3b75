"""What a case file may not say: each is refused with its place, its value and a way out; extremes are not."""

import re

import pytest
from cases import named_case

from fem.case.case import CaseError
from fem.case.overrides import parse_override


def case_of(name, changes):
    """A named case with changes as `--set` takes them, separated by ` & `."""
    return named_case(name, dict(parse_override(change) for change in changes.split(" & ") if change))


def reasons(name, changes):
    with pytest.raises(CaseError) as refused:
        case_of(name, changes)
    return str(refused.value)


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


UNIT_SLIPS = """
least    | container.width_m=1100 |
           [container] width_m must be between 0.001 and 100 m, got 1100 m; looks like millimetres: 1.1 m?
least    | container.height_m=110.0 |
           [container] height_m must be between 0.001 and 100 m, got 110 m; looks like centimetres: 1.1 m?
least    | container.centroid_m=50.0 |
           [container] centroid_m must be less than height_m = 1 m, got 50 m; looks like centimetres: 0.5 m?
least    | container.wall_m=8 | got 8 m; looks like millimetres: 0.008 m?
least    | container.wall_m=0.8 | got 0.8 m; looks like centimetres: 0.008 m?
least    | container.youngs_modulus_Pa=210 | got 210 Pa; looks like GPa (kN/mm2): 2.1e+11 Pa?
least    | container.youngs_modulus_Pa=2.1e5 | got 210000 Pa; looks like MPa (N/mm2): 2.1e+11 Pa?
least    | container.youngs_modulus_Pa=21000 | got 21000 Pa; looks like kN/cm2: 2.1e+11 Pa?
least    | container.weight_N=25 |
           [container] weight_N = 25 N on 1.1 x 1.1 x 1 m is a mean density of 2.11 kg/m3, it must be
least    | container.weight_N=25 | looks like kilonewtons: 25000 N?
least    | container.weight_N=2.5 | looks like tonnes: 24525 N?
least    | container.weight_N=235 & container.width_m=2.44 & container.height_m=2.59 & container.depth_m=6.06 |
           looks like kilonewtons: 235000 N?
least    | container.height_m=2.59 & container.centroid_m=3 | got 3 m; it is measured from the bottom of one box
least    | container.centroid_m=1.2 | got 1.2 m; it is measured from the bottom of one box
least    | floor.kind=rigid & floor.preset=asphalt | belongs to kind = "slab"
least    | container.mass_kg=2.5 |
           [container] mass_kg = 2.5 kg on 1.1 x 1.1 x 1 m is a mean density of 2.07 kg/m3, it must be between 5
least    | container.mass_kg=2.5 | looks like tonnes: 2500 kg?
least    | container.mass_kg=0 | [container] mass_kg must be positive kg, got 0 kg
least    | container.density_kg_m3=2.066 | got 2.066 kg/m3; looks like t/m3 (g/cm3): 2066 kg/m3?
least    | container.damping_ratio=2.0 |
           [container] damping_ratio must be at least 0 and less than 1, got 2; looks like per cent: 0.02?
least    | contact.mu_static=40 | got 40; looks like per cent: 0.4?
least    | support.kind=feet & support.foot_m=150 | got 150 m; looks like millimetres: 0.15 m?
harmonic | motion.amplitude_m=50 | got 50 m; looks like millimetres: 0.05 m?
harmonic | motion.phase_rad=90.0 | got 90 rad; looks like degrees: 1.570796 rad?
pulse    | motion.peak_acceleration_m_s2=400.0 | got 400 m/s2; looks like gal (cm/s2): 4 m/s2?
least    | initial.rotation_rad=7.7 | got 7.7 rad; looks like degrees: 0.1343904 rad?
least    | static.ground_acceleration_m_s2=160 | got 160 m/s2; looks like gal (cm/s2): 1.6 m/s2?
least    | solver.duration_s=20000.0 | got 20000 s; looks like milliseconds: 20 s?
least    | solver.element_size_m=100 | got 100 m; looks like millimetres: 0.1 m?
least    | floor.preset=concrete C25/30 & floor.bearing_strength_Pa=25 | got 25 Pa; looks like MPa (N/mm2): 2.5e+07 Pa?
least    | floor.preset=concrete C25/30 & floor.corner_patch_m=[100, 200] | got 200 m; looks like millimetres: 0.2 m?
least    | floor.preset=concrete C25/30 & floor.corner_patch_m=[8.0, 1.0] |
           along x at most half of width_m = 0.55 m, got 8 m; looks like millimetres: 0.008 m?
least    | gravity_m_s2=981.0 |
           gravity_m_s2 must be between 0.01 and 100 m/s2, got 981 m/s2; looks like cm/s2: 9.81 m/s2?
"""
REFUSED = """
least    | container.heigth_m=1.0 | [container] unknown key 'heigth_m'; did you mean 'height_m'? (known: width_m,
least    | contact.width_m=1.0 | [contact] unknown key 'width_m'; it belongs into [container]
least    | solver.gravity_m_s2=1.0 | [solver] unknown key 'gravity_m_s2'; it belongs before the first table
least    | contact.mu=0.4 | [contact] unknown key 'mu'; did you mean 'mu_static'?
least    | contac.mu=0.4 | unknown table [contac]; did you mean 'contact'?
least    | gravity=9.81 | unknown key 'gravity'; did you mean 'gravity_m_s2'?
least    | schema=2 | schema must be 1, got 2; this program reads schema 1
least    | schema=true | schema must be a whole number, got true
least    | title=3 | title must be text in quotes, got 3
least    | title=2024-01-01 | title must be text in quotes, got the date or time 2024-01-01
least    | document.author=3 | [document] author must be text in quotes, got 3
least    | document.autor=me | [document] unknown key 'autor'; did you mean 'author'?
least    | container.width_m=true | [container] width_m must be a number, got true
least    | container.width_m=1.1 m | width_m must be a number, got the text '1.1 m'; give the bare number in m
least    | container.width_m="1.1" | width_m must be a number, got the text '1.1'; write 1.1
least    | container.width_m=[1.1] | [container] width_m must be a number, got a list
least    | container.width_m=nan | [container] width_m must be a finite number, got nan
least    | container.width_m=-1.1 | [container] width_m must be between 0.001 and 100 m, got -1.1 m
least    | container.width_m=30.0 | [container] width_m over height_m must lie between 0.02 and 20, got 30 m / 1 m
least    | container.boxes=4.0 | [container] boxes must be a whole number, got 4.0
least    | container.boxes=51 | [container] boxes must be between 1 and 50, got 51
least    | container.weight_N=24525 & container.density_kg_m3=2066 |
           [container] weight_N, mass_kg, density_kg_m3: exactly one of the three must be given, got weight_N = 24525 N,
           density_kg_m3 = 2066 kg/m3; keep one of them
least    | container.weight_N=1e9 | [container] weight_N = 1e+09 N on 1.1 x 1.1 x 1 m is a mean density of
least    | container.section=shell | [container] wall_m is missing: section = "shell" needs
least    | container.section=box | [container] section must be "shell" or "solid", got the text 'box'
least    | container.wall_m=0.5 | must be less than half the smallest outer dimension, 1 m, got 0.5 m
least    | container.centroid_m=1.0 | [container] centroid_m must be less than height_m = 1 m, got 1 m
least    | container.mesh_file=../a.msh | [container] mesh_file must name a file in the folder of the case
least    | support.kind=feet & support.foot_m=0.6 | [support] foot_m must be less than half of width_m = 1.1 m
least    | contact.mu_kinetic=0.5 | [contact] mu_kinetic must be at most mu_static = 0.4, got 0.5
least    | contact.restitution_over_housner=97 |
           restitution_over_housner must be between 0.5 and 2, got 97; looks like per cent: 0.97?
least    | contact.restitution_over_housner=0.2 | got 0.2; measured on concrete: 0.93 to 1.05
least    | contact.normal_penalty_Pa_m=automatic | must be a number or "auto", got the text 'automatic'
least    | contact.normal_penalty_Pa_m=0.0 | normal_penalty_Pa_m must be between 1 and 1e+20 Pa/m, got 0 Pa/m
least    | contact.regularisation_velocity_m_s=0.0 | about 1e-3 of the largest slip velocity is usual
least    | motion.kind=harmonic | exactly two of the three must be given, got none; add what is missing
least    | motion.kind=harmonic & motion.frequency_Hz=1 | got frequency_Hz; add what is missing
harmonic | motion.frequency_Hz=1 & motion.angular_frequency_rad_s=6 |
           got amplitude_m, angular_frequency_rad_s, frequency_Hz; leave one out
harmonic | motion.amplitude_m=10.0 & motion.frequency_Hz=100 |
           amplitude_m = 10 m at 628.319 rad/s is a peak acceleration of 3.948e+06 m/s2; it must be at most
harmonic | motion.angular_frequency_rad_s=0 | must be between 0.0628 and 628.4 rad/s, got 0 rad/s
harmonic | motion.amplitude_m=0 & motion.peak_acceleration_m_s2=1 |
           angular_frequency_rad_s does not follow from amplitude_m = 0 m
harmonic | motion.amplitude_m=1e-9 & motion.peak_acceleration_m_s2=90 | angular_frequency_rad_s would be 300000 rad/s
harmonic | motion.frequency_Hz=0.01 & motion.peak_acceleration_m_s2=90 |
           is an amplitude of 22797.3 m; it must be between 0 and 10 m
harmonic | motion.frequency_Hz=1 & motion.peak_acceleration_m_s2=-4 |
           peak_acceleration_m_s2 must be at least 0 for a harmonic motion, got -4 m/s2
harmonic | motion.cycles=2 & motion.ramp_cycles=1.5 | ramp_cycles must be at most half of cycles = 2
harmonic | motion.ramp_cycles=1e-162 | [motion] ramp_cycles must be 0 or at least 0.01, got 1e-162
harmonic | motion.ramp_cycles=20 | [motion] ramp_cycles = 20 tapers 36.2771 s in all, more than
least    | motion.kind=pulse & motion.peak_acceleration_m_s2=1 | [motion] shape and pulse_s are missing: kind =
pulse    | motion.delay_s=20 & solver.duration_s=20 | [motion] delay_s must be less than duration_s = 20 s, got 20 s
pulse    | motion.delay_s=5 & output.history_s=1e-6 | samples of duration_s = "auto", up to 65.5 s
least    | motion.kind=table | [motion] file is missing: kind = "table" needs file
table    | motion.scale=2.0 & motion.scale_to_m_s2=3.0 | [motion] scale_to_m_s2 and scale are alternatives
table    | motion.scale_to_m_s2=0.0 | [motion] scale_to_m_s2 must not be 0
table    | motion.start_s=5.0 & motion.end_s=4.0 | [motion] end_s must be later than start_s = 5 s, got 4 s
table    | motion.sample_interval_s=5e-7 | [motion] sample_interval_s must be between 1e-06 and 10 s
table    | motion.unit=m | unit must be g or m/s2 or cm/s2 or gal or mm/s2 for quantity = "acceleration"
table    | motion.scale=0.0 | [motion] scale must not be 0
table    | motion.file="" | [motion] file must name a file in the folder of the case file
table    | motion.quantity=displacement & motion.unit=m & motion.baseline=mean |
           baseline must be "none" for quantity = "displacement", got "mean"
least    | vertical.kind=harmonic & vertical.frequency_Hz=1 | [vertical] amplitude_m, peak_acceleration_m_s2, frequency
least    | vertical.start=rest | [vertical] unknown key 'start'; it belongs into [motion]
least    | vertical.kind=table | [vertical] file is missing: kind = "table" needs file
least    | vertical.kind=pulse & vertical.scale=0.0 | [vertical] scale must not be 0
least    | vertical.kind=harmonic & vertical.frequency_Hz=1 & vertical.peak_acceleration_m_s2=9 & vertical.scale=1e3 |
           [vertical] scale = 1000 makes a peak acceleration of 9000 m/s2; it must be at most 1000
least    | vertical.file=../floor.csv | [vertical] file must name a file in the folder of the case file
least    | motion.amplitude_m=-1.0 | [motion] amplitude_m must be between 0 and 10 m
least    | motion.kind=quake | [motion] kind must be "none" or "harmonic" or "pulse" or "table"
least    | initial.rotation_rad=1.6 | [initial] rotation_rad must be more than -1.5708 and less than 1.5708 rad
least    | floor.preset=concrete C30 | got the text 'concrete C30'; did you mean 'concrete C25/30'?
least    | floor.preset=grass | "rubber mat" or "concrete" or "C25/30" or "steel", got the text 'grass'
least    | floor.kind=rigid & floor.preset=asphalt | [floor] preset belongs to kind = "slab", this floor is "rigid"; set
least    | floor.bearing_strength_Pa=25e6 | [floor] bearing_strength_Pa belongs to kind = "slab", this floor is "rigid"
least    | floor.kind=slab | [floor] youngs_modulus_Pa is missing: kind = "slab" needs it, or a preset (
least    | floor.preset=asphalt | [floor] corner_patch_m is missing: a solid block has no wall that would say how much
least    | floor.preset=asphalt & floor.corner_patch_m=[0.6, 0.2] |
           [floor] corner_patch_m = [0.6, 0.2] does not fit under the base: along x at most half of width_m = 0.55 m
least    | floor.preset=asphalt & floor.corner_patch_m=[0.1, 1.2] | out of plane at most depth_m = 1.1 m, got 1.2 m
least    | floor.preset=asphalt & floor.corner_patch_m=[0.1] | [floor] corner_patch_m must have 2 items, got a list
least    | floor.preset=asphalt & floor.poisson_ratio=0.5 | poisson_ratio must be at least 0 and less than 0.5, got 0.5
least    | floor.preset=asphalt & contact.normal_penalty_Pa_m=1e9 |
           [contact] normal_penalty_Pa_m belongs to floor.kind = "rigid": the stiffness of a slab follows its
least    | floor.preset=asphalt & contact.tangential_ratio=0.5 | [contact] tangential_ratio belongs to floor.kind =
least    | floor.slope_percent=65.0 | slope_percent must be between -60 and 60 per cent, got 65 per cent; 1 to 2 is
least    | solver.model=rigit | got the text 'rigit'; did you mean 'rigid'?
least    | solver.order=3 | [solver] order must be between 1 and 2, got 3
least    | solver.scheme=newmark & solver.newmark_beta=0.1 | newmark_beta must be at least newmark_gamma/2
least    | solver.duration_s=Auto | [solver] duration_s must be a number or "auto", got the text 'Auto'
least    | solver.duration_s=0 | [solver] duration_s must be between 0.001 and 10000 s, got 0 s
least    | solver.duration_s=5 & output.history_s=1e-7 | makes 5e+07 samples of duration_s = 5 s
least    | solver.step_s=1e-9 | [solver] step_s = 1e-09 s makes 2e+10 steps
least    | output.contents_filter_Hz=0.5 | contents_filter_Hz must be between 1 and 1000 Hz, got 0.5 Hz; 33 is usual
least    | output.history_s=1e-7 | [output] history_s = 1e-07 s makes 2e+08 samples of duration_s = "auto", up to 20 s
least    | output.fields_s=1e-6 | [output] fields_s = 1e-06 s makes 2e+07 frames
least    | output.fields_s=-1.0 | [output] fields_s must be between 0 and 10000 s, got -1 s; 0 writes no fields
least    | output.stop_when_overturned=1 | [output] stop_when_overturned must be true or false, got 1
"""


@pytest.mark.parametrize(("name", "changes", "expected"), rows(UNIT_SLIPS) + rows(REFUSED))
def test_what_cannot_be_is_refused_with_place_value_and_way_out(name, changes, expected):
    assert expected in reasons(name, changes)


def test_rules_are_judged_although_other_keys_are_wrong():
    # mu_kinetic cannot be compared with a mu_static that is no number; the other rules can.
    said = reasons(
        "least",
        "contact.mu_static=rough & contact.mu_kinetic=0.5 & container.wall_m=8 & container.poisson_ratio=9 & "
        "solver.scheme=newmark & solver.newmark_beta=0.1 & solver.order=7",
    )
    assert "wall_m must be less than half" in said
    assert "newmark_beta must be at least" in said
    assert "mu_kinetic must" not in said


def test_a_default_that_follows_a_wrong_key_is_not_blamed():
    assert reasons("least", "container.width_m=-1.0").splitlines() == [
        "case: [container] width_m must be between 0.001 and 100 m, got -1 m (--set container.width_m=-1.0)"
    ]
