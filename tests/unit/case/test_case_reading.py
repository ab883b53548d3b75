"""Reading a case file: what it means, and that everything wrong with it is reported at once, in words."""

import re

import pytest
from cases import HARMONIC, LEAST, PULSE, TABLE, TEXTS, named_case

from fem.case.case import CaseError, case_hash, load_case, read_case
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


def test_least_case_has_the_documented_defaults():
    resolved = read_case(LEAST).resolved()
    assert resolved == {
        "schema": 1,
        "title": "",
        "gravity_m_s2": 9.81,
        "container": {
            "width_m": 1.1,
            "height_m": 1.0,
            "depth_m": 1.1,
            "boxes": 1,
            "weight_N": 24525.0,
            "centroid_m": 0.5,
            "section": "solid",
            "youngs_modulus_Pa": 2.1e11,
            "poisson_ratio": 0.3,
            "damping_ratio": 0.02,
        },
        "support": {"kind": "corners"},
        "contact": {
            "mu_static": 0.4,
            "mu_kinetic": 0.4,
            "friction": "elastic-stick",
            "normal_penalty_Pa_m": "auto",
            "tangential_ratio": 1.0,
            "weakening_m": 0.0,
            "stribeck_velocity_m_s": 0.0,
            "damping_ratio": 2.0,
        },
        "motion": {"kind": "none"},
        "initial": {"rotation_rad": 0.0, "angular_velocity_rad_s": 0.0, "velocity_m_s": 0.0},
        "solver": {
            "model": "reduced",
            "elastic_modes": 20,
            "scheme": "generalised-alpha",
            "spectral_radius": 0.5,
            "step_s": "auto",
            "energy_tolerance": 1.0,
            "duration_s": "auto",
            "element_size_m": 0.1,
            "order": 2,
        },
        "output": {
            "history_s": 0.005,
            "fields_s": 0.05,
            "contents_filter_Hz": 33.0,
            "figures": True,
            "stop_when_overturned": True,
        },
        "uncertainty": {"draws": 32},
    }


def test_a_wall_makes_a_shell_unless_told_otherwise():
    assert case_of("least", "container.wall_m=0.008").container.section == "shell"
    assert case_of("least", "container.wall_m=0.008 & container.section=solid").container.section == "solid"


def test_mass_follows_from_weight_or_density():
    from_weight = case_of("least", "container.boxes=3 & gravity_m_s2=10 & container.weight_N=25e3")
    from_density = case_of("least", "container.density_kg_m3=2000 & container.depth_m=2")
    assert from_weight.box_mass == pytest.approx(2500.0)
    assert from_weight.mass == pytest.approx(7500.0)
    assert from_weight.weight == pytest.approx(75e3)
    assert from_density.box_mass == pytest.approx(2000.0 * 1.1 * 1.0 * 2.0)
    from_mass = case_of("least", "container.boxes=3 & gravity_m_s2=10 & container.mass_kg=2500")
    assert (from_mass.container.weight_N, from_mass.box_mass) == (None, 2500.0)
    assert from_mass.weight == pytest.approx(75e3)


PEAK, HERTZ = 0.05 * 6.928**2, 6.928 / 6.283185307179586


@pytest.mark.parametrize(
    "pair",
    [
        "amplitude_m = 0.05\nangular_frequency_rad_s = 6.928",
        f"amplitude_m = 0.05\nfrequency_Hz = {HERTZ!r}",
        f"peak_acceleration_m_s2 = {PEAK!r}\nangular_frequency_rad_s = 6.928",
        f"peak_acceleration_m_s2 = {PEAK!r}\nfrequency_Hz = {HERTZ!r}",
        f"peak_acceleration_m_s2 = {PEAK!r}\namplitude_m = 0.05",
    ],
)
def test_harmonic_motion_follows_from_any_two(pair):
    case = read_case(LEAST.replace('"none"', f'"harmonic"\n{pair}'))
    assert case.amplitude == pytest.approx(0.05, rel=1e-12)
    assert case.angular_frequency == pytest.approx(6.928, rel=1e-12)
    assert case.nominal_peak_acceleration == pytest.approx(PEAK, rel=1e-12)


def test_other_kinds_of_motion_have_no_amplitude():
    assert read_case(LEAST).nominal_peak_acceleration == 0.0
    assert read_case(PULSE).nominal_peak_acceleration == 3.0
    assert read_case(TABLE).nominal_peak_acceleration is None
    assert read_case(PULSE).amplitude == 0.0


EXTREMES = """
least    | container.youngs_modulus_Pa=1e6
least    | container.youngs_modulus_Pa=1e13
least    | container.width_m=0.02 & container.weight_N=8
least    | container.width_m=20 & container.depth_m=1 & container.weight_N=4e5
least    | container.width_m=1 & container.height_m=50 & container.weight_N=1e6 & container.centroid_m=25
least    | container.boxes=50
least    | contact.mu_static=0 & contact.mu_kinetic=0
least    | contact.mu_static=5.0
harmonic | motion.amplitude_m=0.0
harmonic | motion.amplitude_m=2.5
harmonic | motion.amplitude_m=2.5e-3 & motion.frequency_Hz=100
harmonic | motion.amplitude_m=0.01 & motion.frequency_Hz=0.01
harmonic | motion.amplitude_m=2.5e-3 & motion.angular_frequency_rad_s=628.3
harmonic | motion.amplitude_m=0.1 & motion.angular_frequency_rad_s=0.06284
least    | solver.duration_s=1e-3
least    | solver.duration_s=1e4
least    | container.wall_m=5e-5
least    | container.wall_m=0.499
least    | output.fields_s=0
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
least    | container.depth_m=1100.0 | got 1100 m; looks like millimetres: 1.1 m?
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
least    | container.mass_kg=2.5 |
           [container] mass_kg = 2.5 kg on 1.1 x 1.1 x 1 m is a mean density of 2.07 kg/m3, it must be between 5
least    | container.mass_kg=2.5 | looks like tonnes: 2500 kg?
least    | container.mass_kg=0 | [container] mass_kg must be positive kg, got 0 kg
least    | container.density_kg_m3=2.066 | got 2.066 kg/m3; looks like t/m3 (g/cm3): 2066 kg/m3?
least    | container.wall_density_kg_m3=7.85 | got 7.85 kg/m3; looks like t/m3 (g/cm3): 7850 kg/m3?
least    | container.damping_ratio=2.0 |
           [container] damping_ratio must be at least 0 and less than 1, got 2; looks like per cent: 0.02?
least    | contact.mu_static=40 | got 40; looks like per cent: 0.4?
least    | support.kind=feet & support.foot_m=150 | got 150 m; looks like millimetres: 0.15 m?
least    | support.kind=feet & support.foot_m=15.0 |
           [support] foot_m must be less than half of width_m = 1.1 m, got 15 m; looks like centimetres: 0.15 m?
harmonic | motion.amplitude_m=50 | got 50 m; looks like millimetres: 0.05 m?
harmonic | motion.phase_rad=90.0 | got 90 rad; looks like degrees: 1.570796 rad?
pulse    | motion.peak_acceleration_m_s2=400.0 | got 400 m/s2; looks like gal (cm/s2): 4 m/s2?
least    | initial.rotation_rad=7.7 | got 7.7 rad; looks like degrees: 0.1343904 rad?
least    | static.ground_acceleration_m_s2=160 | got 160 m/s2; looks like gal (cm/s2): 1.6 m/s2?
least    | solver.duration_s=20000.0 | got 20000 s; looks like milliseconds: 20 s?
least    | solver.element_size_m=100 | got 100 m; looks like millimetres: 0.1 m?
least    | solver.element_size_m=10.0 | got 10 m; looks like centimetres: 0.1 m?
least    | floor.preset=concrete C25/30 & floor.bearing_strength_Pa=25 | got 25 Pa; looks like MPa (N/mm2): 2.5e+07 Pa?
least    | floor.preset=concrete C25/30 & floor.youngs_modulus_Pa=31 | got 31 Pa; looks like GPa (kN/mm2): 3.1e+10 Pa?
least    | floor.preset=concrete C25/30 & floor.youngs_modulus_Pa=31000 |
           got 31000 Pa; looks like MPa (N/mm2): 3.1e+10 Pa?
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
least    | container.width_m=inf | [container] width_m must be a finite number, got inf
least    | container.width_m=-1.1 | [container] width_m must be between 0.001 and 100 m, got -1.1 m
least    | container.width_m=30.0 | [container] width_m over height_m must lie between 0.02 and 20, got 30 m / 1 m
least    | container.boxes=4.0 | [container] boxes must be a whole number, got 4.0
least    | container.boxes=true | [container] boxes must be a whole number, got true
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
least    | container.mesh_file=/a.msh | [container] mesh_file must name a file in the folder of the case
least    | container.mesh_file=C:/a.msh | [container] mesh_file must name a file in the folder of the case
least    | support.kind=foot | [support] kind must be "corners" or "feet" or "flat", got the text 'foot'
least    | support.kind=feet & support.foot_m=0.6 | [support] foot_m must be less than half of width_m = 1.1 m
least    | contact.mu_kinetic=0.5 | [contact] mu_kinetic must be at most mu_static = 0.4, got 0.5
least    | contact.restitution_over_housner=97 |
           restitution_over_housner must be between 0.5 and 2, got 97; looks like per cent: 0.97?
least    | contact.restitution_over_housner=0.2 | got 0.2; measured on concrete: 0.93 to 1.05
least    | contact.restitution_over_housner=0.95 & contact.damping_ratio=2.0 | restitution_over_housner, damping_ratio:
           one of the two is given, got 0.95 and 2; keep one of them
least    | contact.restitution_over_housner=0.95 & contact.normal_penalty_Pa_m=1e9 |
           normal_penalty_Pa_m cannot be given as well, got 1e+09 Pa/m; leave that out
least    | contact.normal_penalty_Pa_m=automatic | must be a number or "auto", got the text 'automatic'
least    | contact.normal_penalty_Pa_m=0.0 | normal_penalty_Pa_m must be between 1 and 1e+20 Pa/m, got 0 Pa/m
least    | contact.normal_penalty_Pa_m=true | normal_penalty_Pa_m must be a number or "auto", got true
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
least    | floor.slope_percent=45.0 | slope_percent must be between -20 and 20 per cent, got 45 per cent; 1 to 2 is
least    | solver.model=rigit | got the text 'rigit'; did you mean 'rigid'?
least    | solver.order=3 | [solver] order must be between 1 and 2, got 3
least    | solver.scheme=newmark & solver.newmark_beta=0.1 | newmark_beta must be at least newmark_gamma/2
least    | solver.duration_s=Auto | [solver] duration_s must be a number or "auto", got the text 'Auto'
least    | solver.duration_s=0 | [solver] duration_s must be between 0.001 and 10000 s, got 0 s
least    | solver.duration_s=-5 | [solver] duration_s must be between 0.001 and 10000 s, got -5 s
least    | solver.duration_s=5 & output.history_s=1e-7 | makes 5e+07 samples of duration_s = 5 s
least    | solver.step_s=fast | [solver] step_s must be a number or "auto", got the text 'fast'
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


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("width_m = 1.1", "[container] width_m is missing: outer width, along x, for instance 1.1 m"),
        ("weight_N = 24525.0", "exactly one of the three must be given, none is given"),
        ("mu_static = 0.4", "[contact] mu_static is missing"),
        ('kind = "none"', '[motion] kind is missing: "none" | "harmonic" | "pulse" | "table"'),
    ],
)
def test_a_missing_key_is_named_with_its_meaning(line, expected):
    with pytest.raises(CaseError) as refused:
        read_case(LEAST.replace(line, ""))
    assert expected in str(refused.value)


def test_all_errors_of_a_file_are_reported_at_once_one_a_line():
    text = LEAST.replace("width_m = 1.1", "width_m = 1100").replace("0.4", '"rough"') + (
        "amplitud_m = 3\n[support]\nfeet = true\n[solver]\nduration_s = 0.0\n[output]\nhistory_s = -1\n"
    )
    with pytest.raises(CaseError) as refused:
        read_case(text)
    lines = str(refused.value).splitlines()
    keys = ["width_m", "feet", "mu_static", "amplitud_m", "duration_s", "history_s"]
    assert len(lines) == len(keys)
    assert all(key in line for key, line in zip(keys, lines, strict=True))


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


def test_keys_of_an_option_that_is_not_chosen_play_no_part():
    case = case_of("least", "motion.amplitude_m=0.05 & motion.shape=sine & support.foot_m=0.7")
    assert case.amplitude == 0.0
    assert case.support.foot is None


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"[container\nwidth_m = 1", "not a TOML file"),
        (b"[container]\nwidth_m = 1.1.1", "line 2"),
        (b"[container]\nwidth_m = 1,1", "write numbers with a decimal point, such as 1.1, not with a comma"),
        (b'[motion]\nfile = "C:\\data\\a.csv"', "write paths with forward slashes"),
        (b"[motion]\nkind = harmonic", "put text in quotes"),
        (b"[container]\nwidth_m = 1.1 m", "give the bare number; its unit stands in the key"),
        (b"a = " + b"[" * 5000, "nested too deep"),
        (b"a = " + b"9" * 5000, "not a TOML file"),
        (b"\xff\xfe[\x00c\x00", "not text in UTF-8"),
        (b"title = '\xe4'", "not text in UTF-8 (line 1)"),
        (b"# " + b"x" * 1_000_001, "larger than 1000000 bytes"),
        (b"", "[container] width_m is missing"),
        (b"container = 3", "[container] must be one table, got 3"),
        (b"[[container]]\nwidth_m = 1.1", "[container] must be one table, got a list"),
        (
            b"[container.box]\nwidth_m = 1.1",
            "[container] box must be 1 to 50 tables [[container.box]], one a box",
        ),
        (b"[container]\nbox = [1]", "[container] box must be 1 to 50 tables [[container.box]], one a box"),
        (b"[container]\nbox = []", "[container] box must be 1 to 50 tables [[container.box]]"),
        (b"[container.boxes]\nwidth_m = 1.1", "[container] boxes must be a whole number, got a table"),
        (b"[axes]\n'contact.mu_static' = [0.2]", "this is a sweep file: python -m fem sweep"),
        (b"draws = 128\n[axes]\n[random]", "this is an ensemble file: python -m fem ensemble"),
    ],
)
def test_a_file_that_is_no_case_file_is_refused(tmp_path, content, expected):
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    with pytest.raises(CaseError) as refused:
        load_case(path)
    assert expected in str(refused.value)
    assert str(path) in str(refused.value)


def test_mark_and_line_ends_of_windows_are_read(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + LEAST.replace("\n", "\r\n").encode())
    assert load_case(path).container.width_m == 1.1


@pytest.mark.parametrize("name", ["", "no\0name", "x" * 5000, "missing.toml", "seed_stak"])
def test_a_case_that_is_not_there_is_refused_with_the_shipped_ones(name):
    with pytest.raises(CaseError, match="did you mean 'seed_stack'" if name == "seed_stak" else "seed_stack"):
        load_case(name)


def test_what_is_no_case_is_refused_with_what_it_is(tmp_path):
    with pytest.raises(CaseError, match="is a folder"):
        load_case(tmp_path)
    with pytest.raises(CaseError, match="this is a sweep file: python -m fem sweep outcome_map"):
        load_case("outcome_map")


def test_a_file_wins_over_a_shipped_case_of_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "seed_box").write_text(LEAST, encoding="utf-8")
    assert load_case("seed_box").container.section == "solid"
    (tmp_path / "seed_box").unlink()
    (tmp_path / "seed_box").mkdir()
    assert load_case("seed_box").container.section == "shell"


def test_a_case_knows_where_it_comes_from(tmp_path):
    path = tmp_path / "drum.toml"
    path.write_text(LEAST, encoding="utf-8")
    case = load_case(path, ["contact.mu_static=0.3"])
    assert (case.name, case.folder, case.text) == ("drum", tmp_path, LEAST)
    assert case.overrides == ("contact.mu_static=0.3",)


def test_a_case_is_frozen():
    case = read_case(HARMONIC)
    with pytest.raises(ValueError, match="frozen"):
        case.contact.mu_static = 0.9
    with pytest.raises(ValueError, match="frozen"):
        case.gravity_m_s2 = 10.0


class TestDataFiles:
    """Mesh and motion files are looked for beside the case file; what its user names may lie anywhere."""

    def written(self, folder, name):
        folder.mkdir(exist_ok=True)
        path = folder / "case.toml"
        path.write_text(TEXTS["table"].replace("floor.csv", name), encoding="utf-8")
        return path

    def case(self, folder, name, **options):
        return load_case(self.written(folder, name), **options)

    def record(self, path):
        path.parent.mkdir(exist_ok=True)
        path.write_text("0,0\n1,0\n", encoding="utf-8")
        return path

    def test_found_beside_the_case_file(self, tmp_path):
        record = self.record(tmp_path / "sub" / "floor.csv")
        assert self.case(tmp_path, "sub/floor.csv").data_files == {"motion.file": record}

    def test_missing_is_refused_with_the_folder(self, tmp_path):
        with pytest.raises(CaseError, match=f"names no file: 'floor.csv', looked for in {tmp_path}"):
            assert self.case(tmp_path, "floor.csv").data_files

    def test_a_link_that_leads_out_of_the_folder_is_refused(self, tmp_path):
        folder = tmp_path / "case"
        folder.mkdir()
        (folder / "floor.csv").symlink_to(self.record(tmp_path / "secret.csv"))
        with pytest.raises(CaseError, match="must lie in the folder of the case file"):
            assert self.case(folder, "floor.csv").data_files
        assert self.case(folder, "floor.csv", allow_outside=True).data_files

    @pytest.mark.parametrize("name", ["../floor.csv", "/etc/passwd", "C:/a.csv"])
    def test_a_case_file_may_not_lead_out_of_its_folder(self, tmp_path, name):
        with pytest.raises(
            CaseError, match=r"\[motion\] file must name a file in the folder.*--allow-outside"
        ):
            self.case(tmp_path / "case", name)

    def test_allowed_outside_and_named_by_the_user(self, tmp_path):
        record = self.record(tmp_path / "floor.csv")
        allowed = self.case(tmp_path / "case", "../floor.csv", allow_outside=True)
        path = self.written(tmp_path / "case", "floor.csv")
        for case in (
            allowed,
            load_case(path, [f"motion.file={record}"]),
            load_case(path, ["motion.file=../floor.csv"]),
            load_case(path, motion=str(record)),
        ):
            assert case.data_files["motion.file"].resolve() == record
            assert case.resolved()["motion"]["file"] == "data/floor.csv"
            assert case_hash(case) == case_hash(allowed)

    def test_a_motion_is_named_relative_to_the_current_folder(self, tmp_path, monkeypatch):
        path = self.written(tmp_path / "case", "floor.csv")
        beside = self.record(tmp_path / "case" / "mine.csv")
        monkeypatch.chdir(tmp_path)
        case = load_case(path, motion="case/mine.csv")
        assert case.motion.file == "mine.csv" and case.data_files["motion.file"].resolve() == beside
        harmonic = load_case("seed_stack", motion="case/mine.csv")
        assert harmonic.motion.kind == "table" and harmonic.data_files["motion.file"].resolve() == beside

    def test_a_value_of_a_study_is_not_the_users(self, tmp_path):
        path = self.written(tmp_path / "case", "floor.csv")
        case = load_case(path, [f"motion.file={self.record(tmp_path / 'floor.csv')}"])
        with pytest.raises(CaseError, match="must name a file in the folder"):
            case.with_values({"motion.file": "../other.csv"})
        assert case.with_values({"contact.mu_static": 0.3}).data_files

    def test_a_channel_is_no_part_of_the_name(self, tmp_path):
        record = self.record(tmp_path / "floor.csv")
        (file,) = self.case(tmp_path, "floor.csv#HNE").files.values()
        assert (file.path, file.channel, str(file.copy)) == (record, "HNE", "floor.csv")
        whole = self.record(tmp_path / "a#2")
        (file,) = self.case(tmp_path, "a#2").files.values()
        assert (file.path, file.channel, str(file.copy)) == (whole, "", "a#2")

    def test_files_of_one_name_from_two_folders_are_refused(self, tmp_path):
        for folder in ("a", "b"):
            self.record(tmp_path / folder / "floor.csv")
        case = load_case(
            self.written(tmp_path / "case", "floor.csv"),
            ["motion.file=../a/floor.csv", "vertical.kind=table", "vertical.file=../b/floor.csv"],
        )
        with pytest.raises(
            CaseError, match=r"\[vertical\] file has the name of the file of motion.file, 'floor.csv'"
        ):
            assert case.files
