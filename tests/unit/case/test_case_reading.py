"""Reading a case file: what it means, and that everything wrong with it is reported at once, in words."""

import pytest
from cases import HARMONIC, LEAST, PULSE, TABLE, named_case

from fem.case.case import CaseError, load_case, read_case


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
            "fields_s": "auto",
            "contents_filter_Hz": 33.0,
            "figures": True,
            "stop_when_overturned": True,
            "stop_when_still": False,
        },
        "uncertainty": {"draws": 32},
    }


def test_a_wall_makes_a_shell_unless_told_otherwise():
    assert named_case("least", {"container.wall_m": 0.008}).container.section == "shell"
    both = {"container.wall_m": 0.008, "container.section": "solid"}
    assert named_case("least", both).container.section == "solid"


def test_mass_follows_from_weight_or_density():
    three = {"container.boxes": 3, "gravity_m_s2": 10.0}
    from_weight = named_case("least", three | {"container.weight_N": 25e3})
    from_density = named_case("least", {"container.density_kg_m3": 2000.0, "container.depth_m": 2.0})
    assert from_weight.box_mass == pytest.approx(2500.0)
    assert from_weight.mass == pytest.approx(7500.0)
    assert from_weight.weight == pytest.approx(75e3)
    assert from_density.box_mass == pytest.approx(2000.0 * 1.1 * 1.0 * 2.0)
    from_mass = named_case("least", three | {"container.mass_kg": 2500.0})
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
    assert case.motion.amplitude == pytest.approx(0.05, rel=1e-12)
    assert case.motion.angular_frequency == pytest.approx(6.928, rel=1e-12)
    assert case.motion.nominal_peak == pytest.approx(PEAK, rel=1e-12)


def test_other_kinds_of_motion_have_no_amplitude():
    assert read_case(LEAST).motion.nominal_peak == 0.0
    assert read_case(PULSE).motion.nominal_peak == 3.0
    assert read_case(TABLE).motion.nominal_peak is None
    assert read_case(PULSE).motion.amplitude == 0.0


def test_keys_of_an_option_that_is_not_chosen_play_no_part():
    idle = {"motion.amplitude_m": 0.05, "motion.shape": "sine", "support.foot_m": 0.7}
    case = named_case("least", idle)
    assert case.motion.amplitude == 0.0
    assert case.foot is None


def test_mark_and_line_ends_of_windows_are_read(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + LEAST.replace("\n", "\r\n").encode())
    assert load_case(path).container.width_m == 1.1


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


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"a = " + b"[" * 5000, "nested too deep"),
        (b"a = " + b"9" * 5000, "not a TOML file"),
        (b"\xff\xfe[\x00c\x00", "not text in UTF-8"),
        (b"title = '\xe4'", "not text in UTF-8 (line 1)"),
        (b"# " + b"x" * 1_000_001, "larger than 1 MB"),
    ],
)
def test_bytes_that_are_no_case_file_are_refused_with_their_place(tmp_path, content, expected):
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    with pytest.raises(CaseError) as refused:
        load_case(path)
    assert expected in str(refused.value) and str(path) in str(refused.value)


@pytest.mark.parametrize("name", ["", "no\0name", "x" * 5000])
def test_a_case_that_cannot_be_there_is_refused_with_the_shipped_ones(name):
    with pytest.raises(CaseError, match="seed_stack"):
        load_case(name)
