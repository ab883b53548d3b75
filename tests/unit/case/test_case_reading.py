"""Reading a case file: what it means, and that everything wrong with it is said at once, in words."""

import tomllib

import pytest

from fem.case.case import CaseError, load_case, read_case

LEAST = """
[container]
width_m = 1.1
height_m = 1.0
weight_N = 24525.0
[contact]
mu_static = 0.4
[motion]
kind = "none"
"""


def case_with(**changes):
    """The least case with dotted keys set, `table__key`; None removes a key."""
    data = tomllib.loads(LEAST)
    for name, value in changes.items():
        table, _, key = name.rpartition("__")
        place = data.setdefault(table, {}) if table else data
        if value is None:
            place.pop(key, None)
        else:
            place[key] = value
    return read_case(as_toml(data))


def as_toml(data):
    lines = [f"{key} = {as_value(value)}" for key, value in data.items() if not isinstance(value, dict)]
    for name, table in data.items():
        if isinstance(table, dict):
            lines += [f"[{name}]", *(f"{key} = {as_value(value)}" for key, value in table.items())]
    return "\n".join(lines)


def as_value(value):
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)


def reasons(**changes):
    with pytest.raises(CaseError) as refused:
        case_with(**changes)
    return str(refused.value)


HARMONIC = {"motion__kind": "harmonic", "motion__amplitude_m": 0.05, "motion__angular_frequency_rad_s": 6.928}
PULSE = {
    "motion__kind": "pulse",
    "motion__shape": "sine",
    "motion__peak_acceleration_m_s2": -3.0,
    "motion__pulse_s": 0.5,
}
TABLE = {
    "motion__kind": "table",
    "motion__file": "floor.csv",
    "motion__quantity": "acceleration",
    "motion__unit": "g",
}


def test_least_case_has_the_documented_defaults():
    case = read_case(LEAST)
    container, contact, solver = case.container, case.contact, case.solver
    assert (container.depth_m, container.boxes, container.centroid_m, container.section) == (
        1.1,
        1,
        0.5,
        "solid",
    )
    assert (container.youngs_modulus_Pa, container.poisson_ratio, container.damping_ratio) == (
        2.1e11,
        0.3,
        0.02,
    )
    assert container.wall_density_kg_m3 == 7850.0
    assert (case.support.kind, case.support.foot_m, case.support.foot) == ("corners", 0.15, None)
    assert (contact.mu_kinetic, contact.friction, contact.normal_penalty_Pa_m) == (
        0.4,
        "elastic-stick",
        "auto",
    )
    assert (contact.tangential_ratio, contact.weakening_m, contact.damping_ratio) == (1.0, 0.0, 2.0)
    assert (solver.model, solver.elastic_modes, solver.scheme) == ("reduced", 20, "generalised-alpha")
    assert (solver.spectral_radius, solver.newmark_beta, solver.newmark_gamma) == (0.5, 0.25, 0.5)
    assert (solver.step_s, solver.duration_s, solver.element_size_m, solver.order) == ("auto", 20.0, 0.1, 2)
    assert (case.output.history_s, case.output.fields_s, case.output.stop_when_overturned) == (
        0.005,
        0.05,
        True,
    )
    assert (case.static.ground_acceleration_m_s2, case.static.soil_factor) == (1.6, 1.5)
    assert (case.static.behaviour_factor, case.static.importance_factor) == (1.5, 1.0)
    assert (case.gravity_m_s2, case.schema_version, case.motion.start) == (9.81, 1, "moving")


def test_a_wall_makes_a_shell_unless_told_otherwise():
    assert case_with(container__wall_m=0.008).container.section == "shell"
    assert case_with(container__wall_m=0.008, container__section="solid").container.section == "solid"


def test_mass_follows_from_weight_or_density():
    from_weight = case_with(container__boxes=3, gravity_m_s2=10.0, container__weight_N=25e3)
    from_density = case_with(
        container__weight_N=None, container__density_kg_m3=2000.0, container__depth_m=2.0
    )
    assert from_weight.box_mass == pytest.approx(2500.0)
    assert from_weight.mass == pytest.approx(7500.0)
    assert from_weight.weight == pytest.approx(75e3)
    assert from_weight.mean_areal_density == pytest.approx(2500.0 / 1.1)
    assert from_density.box_mass == pytest.approx(2000.0 * 1.1 * 1.0 * 2.0)


def test_harmonic_motion_follows_from_any_two():
    amplitude, frequency = 0.05, 6.928
    peak = amplitude * frequency**2
    hertz = frequency / 6.283185307179586
    pairs = [
        {"amplitude_m": amplitude, "angular_frequency_rad_s": frequency},
        {"amplitude_m": amplitude, "frequency_Hz": hertz},
        {"peak_acceleration_m_s2": peak, "angular_frequency_rad_s": frequency},
        {"peak_acceleration_m_s2": peak, "frequency_Hz": hertz},
        {"peak_acceleration_m_s2": peak, "amplitude_m": amplitude},
    ]
    for pair in pairs:
        case = case_with(motion__kind="harmonic", **{f"motion__{key}": value for key, value in pair.items()})
        assert case.amplitude == pytest.approx(amplitude, rel=1e-12)
        assert case.angular_frequency == pytest.approx(frequency, rel=1e-12)
        assert case.nominal_peak_acceleration == pytest.approx(peak, rel=1e-12)


def test_other_kinds_of_motion_have_no_amplitude():
    assert case_with().nominal_peak_acceleration == 0.0
    assert case_with(**PULSE).nominal_peak_acceleration == 3.0
    assert case_with(**TABLE).nominal_peak_acceleration is None
    assert case_with(**PULSE).amplitude == 0.0


@pytest.mark.parametrize(
    "extreme",
    [
        {"container__youngs_modulus_Pa": 1e6},
        {"container__youngs_modulus_Pa": 1e13},
        {"container__width_m": 0.02, "container__weight_N": 8.0},
        {"container__width_m": 20.0, "container__depth_m": 1.0, "container__weight_N": 4e5},
        {"container__width_m": 1.0, "container__height_m": 50.0, "container__weight_N": 1e6},
        {"container__boxes": 1},
        {"container__boxes": 50},
        {"contact__mu_static": 0.0},
        {"contact__mu_static": 5.0},
        HARMONIC | {"motion__amplitude_m": 0.0},
        HARMONIC | {"motion__amplitude_m": 10.0},
        {"motion__kind": "harmonic", "motion__amplitude_m": 2.5e-3, "motion__frequency_Hz": 100.0},
        {"motion__kind": "harmonic", "motion__amplitude_m": 0.01, "motion__frequency_Hz": 0.01},
        {"motion__kind": "harmonic", "motion__amplitude_m": 2.5e-3, "motion__angular_frequency_rad_s": 628.3},
        {"motion__kind": "harmonic", "motion__amplitude_m": 0.1, "motion__angular_frequency_rad_s": 0.06284},
        {"solver__duration_s": 1e-3},
        {"solver__duration_s": 1e4},
        {"container__wall_m": 5e-5},
        {"container__wall_m": 0.499},
        {"output__fields_s": 0},
        {"solver__elastic_modes": 0},
        {"solver__spectral_radius": 0.0},
        {"solver__spectral_radius": 1.0},
        {"solver__scheme": "newmark"},  # average acceleration, 2 beta = gamma: on the edge of stability
        {"solver__scheme": "newmark", "solver__newmark_beta": 0.3025, "solver__newmark_gamma": 0.6},
        PULSE | {"motion__delay_s": 1.0},
        TABLE,
    ],
)
def test_extremes_that_the_program_can_compute_are_not_taken_for_slips(extreme):
    assert case_with(**extreme).gravity_m_s2 == 9.81


UNIT_SLIPS = [
    ({"container__width_m": 1100}, "[container] width_m", "1100 m", "looks like millimetres: 1.1 m?"),
    ({"container__height_m": 110.0}, "[container] height_m", "110 m", "looks like centimetres: 1.1 m?"),
    ({"container__depth_m": 1100.0}, "[container] depth_m", "1100 m", "looks like millimetres: 1.1 m?"),
    ({"container__centroid_m": 50.0}, "[container] centroid_m", "50 m", "looks like centimetres: 0.5 m?"),
    ({"container__wall_m": 8}, "[container] wall_m", "8 m", "looks like millimetres: 0.008 m?"),
    ({"container__wall_m": 0.8}, "[container] wall_m", "0.8 m", "looks like centimetres: 0.008 m?"),
    (
        {"container__youngs_modulus_Pa": 210},
        "youngs_modulus_Pa",
        "210 Pa",
        "looks like GPa (kN/mm2): 2.1e+11 Pa?",
    ),
    ({"container__youngs_modulus_Pa": 2.1e5}, "youngs_modulus_Pa", "210000 Pa", "MPa (N/mm2): 2.1e+11 Pa?"),
    ({"container__youngs_modulus_Pa": 21000}, "youngs_modulus_Pa", "21000 Pa", "kN/cm2: 2.1e+11 Pa?"),
    ({"container__weight_N": 25}, "[container] weight_N", "25 N", "looks like kilonewtons: 25000 N?"),
    ({"container__weight_N": 2.5}, "[container] weight_N", "2.5 N", "looks like tonnes: 24525 N?"),
    (
        {"container__weight_N": None, "container__density_kg_m3": 2.066},  # as the seed paper prints it
        "[container] density_kg_m3",
        "2.066 kg/m3",
        "looks like t/m3 (g/cm3): 2066 kg/m3?",
    ),
    ({"container__wall_density_kg_m3": 7.85}, "wall_density_kg_m3", "7.85 kg/m3", "7850 kg/m3?"),
    ({"container__damping_ratio": 2.0}, "[container] damping_ratio", "got 2;", "looks like per cent: 0.02?"),
    ({"contact__mu_static": 40}, "[contact] mu_static", "got 40;", "looks like per cent: 0.4?"),
    ({"support__kind": "feet", "support__foot_m": 150}, "[support] foot_m", "150 m", "millimetres: 0.15 m?"),
    ({"support__kind": "feet", "support__foot_m": 15.0}, "[support] foot_m", "15 m", "centimetres: 0.15 m?"),
    (
        HARMONIC | {"motion__amplitude_m": 50},
        "[motion] amplitude_m",
        "50 m",
        "looks like millimetres: 0.05 m?",
    ),
    (
        HARMONIC | {"motion__phase_rad": 90.0},
        "[motion] phase_rad",
        "90 rad",
        "looks like degrees: 1.570796 rad?",
    ),
    (
        PULSE | {"motion__peak_acceleration_m_s2": 400.0},
        "peak_acceleration_m_s2",
        "400 m/s2",
        "gal (cm/s2): 4 m/s2?",
    ),
    (
        {"initial__rotation_rad": 7.7},
        "[initial] rotation_rad",
        "7.7 rad",
        "looks like degrees: 0.1343904 rad?",
    ),
    ({"static__ground_acceleration_m_s2": 160}, "ground_acceleration_m_s2", "160 m/s2", "1.6 m/s2?"),
    ({"solver__duration_s": 20000.0}, "[solver] duration_s", "20000 s", "looks like milliseconds: 20 s?"),
    ({"solver__element_size_m": 100}, "[solver] element_size_m", "100 m", "looks like millimetres: 0.1 m?"),
    ({"gravity_m_s2": 981.0}, "gravity_m_s2", "981 m/s2", "looks like cm/s2: 9.81 m/s2?"),
]


@pytest.mark.parametrize(("changes", "place", "value", "guess"), UNIT_SLIPS)
def test_a_likely_slip_of_the_unit_is_refused_with_the_guess(changes, place, value, guess):
    said = reasons(**changes)
    assert place in said
    assert value in said
    assert guess in said
    assert "\n" not in said


REFUSED = [
    (
        {"container__heigth_m": 1.0},
        "[container] unknown key 'heigth_m'; did you mean 'height_m'? (known: width_m,",
    ),
    (
        {"motion__kind": "harmonic", "motion__amplitude_m": 10.0, "motion__frequency_Hz": 100.0},
        "[motion] amplitude_m = 10 m at 628.319 rad/s is a peak acceleration of 3.948e+06 m/s2; it must be at most",
    ),
    ({"contact__width_m": 1.0}, "[contact] unknown key 'width_m'; it belongs into [container]"),
    ({"solver__gravity_m_s2": 1.0}, "[solver] unknown key 'gravity_m_s2'; it belongs before the first table"),
    ({"contact__mu": 0.4}, "[contact] unknown key 'mu'; did you mean 'mu_static'?"),
    ({"contac__mu": 0.4}, "[contac] unknown table; did you mean 'contact'?"),
    ({"gravity": 9.81}, "unknown key 'gravity'; did you mean 'gravity_m_s2'?"),
    ({"schema": 2}, "schema must be 1, got 2; this program reads schema 1"),
    ({"schema": True}, "schema must be a whole number, got true"),
    ({"container": 3}, "[container] must be one table, got 3"),
    ({"title": 3}, "title must be text in quotes, got 3"),
    (
        {"container__width_m": None},
        "[container] width_m is missing: outer width, along x, for instance 1.1 m",
    ),
    ({"contact__mu_static": None}, "[contact] mu_static is missing"),
    ({"motion__kind": None}, '[motion] kind is missing: "none" | "harmonic" | "pulse" | "table"'),
    ({"container__width_m": True}, "[container] width_m must be a number, got true"),
    (
        {"container__width_m": "1.1 m"},
        "width_m must be a number, got the text '1.1 m'; give the bare number in m",
    ),
    ({"container__width_m": "1.1"}, "width_m must be a number, got the text '1.1'; write 1.1"),
    ({"container__width_m": [1.1]}, "[container] width_m must be a number, got a list"),
    ({"container__width_m": float("nan")}, "[container] width_m must be a finite number, got nan"),
    ({"container__width_m": float("inf")}, "[container] width_m must be a finite number, got inf"),
    ({"container__width_m": -1.1}, "[container] width_m must be between 0.001 and 100 m, got -1.1 m"),
    ({"container__width_m": 0.0}, "[container] width_m must be between 0.001 and 100 m, got 0 m"),
    (
        {"container__width_m": 30.0},
        "[container] width_m over height_m must lie between 0.02 and 20, got 30 m / 1 m",
    ),
    ({"container__boxes": 4.0}, "[container] boxes must be a whole number, got 4.0"),
    ({"container__boxes": True}, "[container] boxes must be a whole number, got true"),
    ({"container__boxes": 0}, "[container] boxes must be between 1 and 50, got 0"),
    ({"container__boxes": 51}, "[container] boxes must be between 1 and 50, got 51"),
    ({"container__weight_N": None}, "exactly one of the two must be given, none is given"),
    ({"container__density_kg_m3": 2066.0}, "exactly one of the two must be given, both are given"),
    ({"container__weight_N": 1e9}, "[container] weight_N = 1e+09 N on 1.1 x 1.1 x 1 m is a mean density of"),
    ({"container__section": "shell"}, '[container] wall_m is missing: section = "shell" needs'),
    ({"container__section": "box"}, '[container] section must be "shell" or "solid", got the text \'box\''),
    ({"container__wall_m": 0.5}, "must be less than half the smallest outer dimension, 1 m, got 0.5 m"),
    ({"container__centroid_m": 1.0}, "[container] centroid_m must be less than height_m = 1 m, got 1 m"),
    ({"container__poisson_ratio": 0.6}, "[container] poisson_ratio must be between 0 and 0.5, got 0.6"),
    (
        {"container__damping_ratio": 1.0},
        "[container] damping_ratio must be at least 0 and less than 1, got 1",
    ),
    (
        {"container__mesh_file": "../a.msh"},
        "[container] mesh_file must name a file in the folder of the case",
    ),
    ({"container__mesh_file": "/a.msh"}, "[container] mesh_file must name a file in the folder of the case"),
    (
        {"container__mesh_file": "C:/a.msh"},
        "[container] mesh_file must name a file in the folder of the case",
    ),
    (
        {"support__kind": "foot"},
        '[support] kind must be "corners" or "feet" or "flat", got the text \'foot\'',
    ),
    (
        {"support__kind": "feet", "support__foot_m": 0.6},
        "[support] foot_m must be less than half of width_m = 1.1 m",
    ),
    ({"contact__mu_static": -0.1}, "[contact] mu_static must be between 0 and 5, got -0.1"),
    ({"contact__mu_kinetic": 0.5}, "[contact] mu_kinetic must be at most mu_static = 0.4, got 0.5"),
    ({"contact__friction": "coulomb"}, '[contact] friction must be "elastic-stick" or "regularised"'),
    ({"contact__normal_penalty_Pa_m": "automatic"}, "must be a number or \"auto\", got the text 'automatic'"),
    (
        {"contact__normal_penalty_Pa_m": 0.0},
        "normal_penalty_Pa_m must be between 1 and 1e+20 Pa/m, got 0 Pa/m",
    ),
    ({"contact__normal_penalty_Pa_m": True}, 'normal_penalty_Pa_m must be a number or "auto", got true'),
    ({"contact__regularisation_velocity_m_s": 0.0}, "about 1e-3 of the largest slip velocity is usual"),
    ({"contact__damping_ratio": -1.0}, "[contact] damping_ratio must be between 0 and 1000, got -1"),
    ({"motion__kind": "harmonic"}, "exactly two of the three must be given, got none; add what is missing"),
    (
        HARMONIC | {"motion__amplitude_m": None},
        "got angular_frequency_rad_s; add what is missing",
    ),
    (
        HARMONIC | {"motion__frequency_Hz": 1.0},
        "got amplitude_m, angular_frequency_rad_s, frequency_Hz; leave one out",
    ),
    (HARMONIC | {"motion__peak_acceleration_m_s2": 2.4}, "exactly two of the three must be given"),
    (
        HARMONIC | {"motion__angular_frequency_rad_s": 0.0},
        "must be between 0.0628 and 628.4 rad/s, got 0 rad/s",
    ),
    (
        {"motion__kind": "harmonic", "motion__amplitude_m": 0.0, "motion__peak_acceleration_m_s2": 1.0},
        "angular_frequency_rad_s does not follow from amplitude_m = 0 m",
    ),
    (
        {"motion__kind": "harmonic", "motion__amplitude_m": 1e-9, "motion__peak_acceleration_m_s2": 90.0},
        "angular_frequency_rad_s would be 300000 rad/s",
    ),
    (
        {"motion__kind": "harmonic", "motion__frequency_Hz": 0.01, "motion__peak_acceleration_m_s2": 90.0},
        "is an amplitude of 22797.3 m; it must be between 0 and 10 m",
    ),
    (
        {"motion__kind": "harmonic", "motion__frequency_Hz": 1.0, "motion__peak_acceleration_m_s2": -4.0},
        "peak_acceleration_m_s2 must be at least 0 for a harmonic motion, got -4 m/s2",
    ),
    (
        HARMONIC | {"motion__cycles": 2.0, "motion__ramp_cycles": 1.5},
        "ramp_cycles must be at most half of cycles = 2",
    ),
    (
        HARMONIC | {"motion__ramp_cycles": 1e-162},
        "[motion] ramp_cycles must be 0 or at least 0.01, got 1e-162",
    ),
    (HARMONIC | {"motion__ramp_cycles": 20}, "[motion] ramp_cycles = 20 tapers 36.2771 s in all, more than"),
    (
        PULSE | {"motion__shape": None, "motion__pulse_s": None},
        "[motion] shape and pulse_s are missing: kind =",
    ),
    (PULSE | {"motion__delay_s": 20.0}, "[motion] delay_s must be less than duration_s = 20 s, got 20 s"),
    (TABLE | {"motion__unit": None}, "[motion] unit is missing"),
    (TABLE | {"motion__unit": "m"}, 'unit must be m/s2 or g for quantity = "acceleration", got "m"'),
    (TABLE | {"motion__scale": 0.0}, "[motion] scale must not be 0"),
    (
        TABLE | {"motion__file": "../floor.csv"},
        "[motion] file must name a file in the folder of the case file",
    ),
    (TABLE | {"motion__file": ""}, "[motion] file must name a file in the folder of the case file"),
    (
        TABLE | {"motion__quantity": "displacement", "motion__unit": "m", "motion__baseline": "mean"},
        'baseline must be "none" for quantity = "displacement", got "mean"',
    ),
    (
        {"motion__kind": "none", "motion__amplitude_m": -1.0},
        "[motion] amplitude_m must be between 0 and 10 m",
    ),
    ({"motion__kind": "quake"}, '[motion] kind must be "none" or "harmonic" or "pulse" or "table"'),
    (
        {"initial__rotation_rad": 1.6},
        "[initial] rotation_rad must be more than -1.5708 and less than 1.5708 rad",
    ),
    ({"static__behaviour_factor": 0.5}, "[static] behaviour_factor must be between 1 and 10, got 0.5"),
    ({"solver__duration_s": 0.0}, "[solver] duration_s must be between 0.001 and 10000 s, got 0 s"),
    ({"solver__duration_s": -20.0}, "[solver] duration_s must be between 0.001 and 10000 s, got -20 s"),
    ({"solver__model": "rigit"}, "got the text 'rigit'; did you mean 'rigid'?"),
    ({"solver__order": 3}, "[solver] order must be between 1 and 2, got 3"),
    ({"solver__order": 2.0}, "[solver] order must be a whole number, got 2.0"),
    ({"solver__spectral_radius": 1.1}, "[solver] spectral_radius must be between 0 and 1, got 1.1"),
    (
        {"solver__scheme": "newmark", "solver__newmark_beta": 0.1},
        "newmark_beta must be at least newmark_gamma/2",
    ),
    ({"solver__newmark_gamma": 0.4}, "[solver] newmark_gamma must be between 0.5 and 1.5, got 0.4"),
    ({"solver__step_s": 0.0}, "[solver] step_s must be between 1e-09 and 10 s, got 0 s"),
    ({"solver__step_s": "fast"}, "[solver] step_s must be a number or \"auto\", got the text 'fast'"),
    ({"solver__step_s": 1e-9}, "[solver] step_s = 1e-09 s makes 2e+10 steps"),
    ({"solver__element_size_m": 10.0}, "looks like centimetres: 0.1 m?"),
    ({"output__history_s": 0.0}, "[output] history_s must be between 1e-07 and 10000 s, got 0 s"),
    ({"output__history_s": 1e-7}, "[output] history_s = 1e-07 s makes 2e+08 samples of duration_s = 20 s"),
    ({"output__fields_s": 1e-6}, "[output] fields_s = 1e-06 s makes 2e+07 frames"),
    (
        {"output__fields_s": -1.0},
        "[output] fields_s must be between 0 and 10000 s, got -1 s; 0 writes no fields",
    ),
    ({"output__stop_when_overturned": 1}, "[output] stop_when_overturned must be true or false, got 1"),
]


@pytest.mark.parametrize(("changes", "expected"), REFUSED, ids=[expected[:40] for _, expected in REFUSED])
def test_what_cannot_be_is_refused_with_place_value_and_way_out(changes, expected):
    assert expected in reasons(**changes)


def test_all_errors_of_a_file_are_told_at_once_one_a_line():
    said = reasons(
        container__width_m=1100,
        contact__mu_static="rough",
        solver__duration_s=0.0,
        support__feet=True,
        output__history_s=-1,
        motion__amplitud_m=3,
    ).splitlines()
    keys = ["width_m", "feet", "mu_static", "amplitud_m", "duration_s", "history_s"]
    assert len(said) == len(keys)
    assert all(key in line for key, line in zip(keys, said, strict=True))


def test_rules_speak_although_other_keys_are_wrong():
    # mu_kinetic cannot be compared with a mu_static that is no number; the other rules can.
    said = reasons(
        contact__mu_static="rough",
        contact__mu_kinetic=0.5,
        container__wall_m=8,
        container__poisson_ratio=9.0,
        solver__scheme="newmark",
        solver__newmark_beta=0.1,
        solver__order=7,
    )
    assert "wall_m must be less than half" in said
    assert "newmark_beta must be at least" in said
    assert "mu_kinetic" not in said


def test_a_default_that_follows_a_wrong_key_is_not_blamed():
    assert reasons(container__width_m=-1.0).splitlines() == [
        "case: [container] width_m must be between 0.001 and 100 m, got -1 m"
    ]


def test_keys_of_an_option_that_is_not_chosen_play_no_part():
    case = case_with(motion__amplitude_m=0.05, motion__shape="sine", support__foot_m=0.7)
    assert case.amplitude == 0.0
    assert case.support.foot is None


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"[container\nwidth_m = 1", "not a TOML file"),
        (b"[container]\nwidth_m = 1.1.1", "line 2"),
        (b"a = " + b"[" * 5000, "nested too deep"),
        (b"a = " + b"9" * 5000, "not a TOML file"),
        (b"\xff\xfe[\x00c\x00", "not text in UTF-8"),
        (b"title = '\xe4'", "not text in UTF-8 (line 1)"),
        (b"# " + b"x" * 1_000_001, "larger than 1000000 bytes"),
        (b"", "[container] width_m is missing"),
        (b"[[container]]\nwidth_m = 1.1", "[container] must be one table, got a list"),
        (b"[container.box]\nwidth_m = 1.1", "[container] unknown key 'box'"),
        (b"title = 2024-01-01", "title must be text in quotes, got the date or time 2024-01-01"),
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
    with pytest.raises(CaseError, match="seed_stack"):
        load_case(name)


def test_the_nearest_shipped_case_is_named():
    with pytest.raises(CaseError, match="did you mean 'seed_stack'"):
        load_case("seed_stak")


def test_a_folder_is_no_case(tmp_path):
    with pytest.raises(CaseError, match="is a folder"):
        load_case(tmp_path)


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
    assert (case.name, case.folder, case.text, case.overrides) == (
        "drum",
        tmp_path,
        LEAST,
        ("contact.mu_static=0.3",),
    )


def test_a_case_is_frozen():
    case = read_case(LEAST)
    with pytest.raises(ValueError, match="frozen"):
        case.contact.mu_static = 0.9
    with pytest.raises(ValueError, match="frozen"):
        case.gravity_m_s2 = 10.0


class TestDataFiles:
    """Mesh and motion files are looked for beside the case file, and nowhere else."""

    def case(self, folder, name):
        path = folder / "case.toml"
        path.write_text(
            LEAST.replace('"none"', f'"table"\nfile = "{name}"\nquantity = "acceleration"\nunit = "g"'),
            encoding="utf-8",
        )
        return load_case(path)

    def test_found_beside_the_case_file(self, tmp_path):
        (tmp_path / "sub").mkdir()
        (tmp_path / "sub" / "floor.csv").write_text("0,0\n1,0\n", encoding="utf-8")
        assert self.case(tmp_path, "sub/floor.csv").data_files == {
            "motion.file": tmp_path / "sub" / "floor.csv"
        }

    def test_missing_is_refused_with_the_folder(self, tmp_path):
        with pytest.raises(CaseError, match=f"names no file: 'floor.csv', looked for in {tmp_path}"):
            assert self.case(tmp_path, "floor.csv").data_files

    def test_a_link_that_leads_out_of_the_folder_is_refused(self, tmp_path):
        folder = tmp_path / "case"
        folder.mkdir()
        (tmp_path / "secret.csv").write_text("0,0\n1,0\n", encoding="utf-8")
        (folder / "floor.csv").symlink_to(tmp_path / "secret.csv")
        with pytest.raises(CaseError, match="must lie in the folder of the case file"):
            assert self.case(folder, "floor.csv").data_files
