"""What the file of a study may hold: axes, the case beside it, derived keys that are arithmetic and no code."""

import math
import warnings

import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_sweep import sweep_in

from fem.__main__ import main
from fem.case.case import case_hash
from fem.case.files import CASES, SWEEPS
from fem.case.validation import CaseError
from fem.study.derived import ExpressionError, parse_expression
from fem.study.file import load_ensemble, load_sweep
from fem.study.sweep_table import open_sweep

HEAD = 'case = "seed_stack_plateau"\n[set]\n"solver.model" = "rigid"\n'
FREQUENCY = '"motion.angular_frequency_rad_s" = { from = 2.0, to = 4.0, count = 3 }\n'


@pytest.fixture
def sweep_of(tmp_path):
    return lambda body: sweep_in(tmp_path, HEAD + body)


def test_the_last_axis_is_the_fastest(sweep_of):
    sweep = sweep_of(f'[axes]\n{FREQUENCY}"contact.mu_static" = [0.2, 0.3]\n')
    assert (sweep.shape, sweep.count) == ((3, 2), 6)
    assert [sweep.point(cell)["contact.mu_static"] for cell in range(3)] == [0.2, 0.3, 0.2]
    assert sweep.point(5) == {"motion.angular_frequency_rad_s": 4.0, "contact.mu_static": 0.3}


def test_a_cell_is_the_base_with_its_keys_set(sweep_of):
    # The light way of making cases against the long one; an axis on a peak acceleration replaces the amplitude.
    sweep = sweep_of(
        f'[axes]\n{FREQUENCY}"motion.peak_acceleration_m_s2" = [3.0, 5.0]\n"container.boxes" = [2, 4]\n'
        '[derived]\n"contact.mu_kinetic" = "0.5 * contact.mu_static"\n'
    )
    for cell in range(sweep.count):
        case = sweep.case(cell)
        long_way = sweep.base.with_values(sweep.make.values(sweep.point(cell)) | {"output.fields_s": 0.0})
        assert case == long_way
        assert case.given() == long_way.given()
        assert case_hash(case) == case_hash(long_way)
        assert case.motion.amplitude_m is None


def test_derived_keys_follow_axes_defaults_and_one_another(sweep_of):
    sweep = sweep_of(
        '[axes]\n"contact.mu_static" = [0.2, 0.6]\n"container.height_m" = [1.0, 2.0]\n[derived]\n'
        '"container.centroid_m" = "0.4 * container.height_m"\n'
        '"initial.velocity_m_s" = "2 * container.centroid_m + contact.mu_kinetic"\n'
    )
    # mu_kinetic is given by neither: its default follows mu_static, cell by cell
    assert sweep.base.contact.mu_kinetic == 0.2
    values = sweep.make.values(sweep.point(3))
    assert values["container.centroid_m"] == pytest.approx(0.8)
    assert values["initial.velocity_m_s"] == pytest.approx(1.6 + 0.2)


@pytest.mark.parametrize("name", SWEEPS.names)
def test_shipped_sweeps_can_be_read(name):
    sweep = load_sweep(name)
    assert sweep.title
    assert sweep.count > 100
    assert sweep.case(0) != sweep.case(sweep.count - 1)


SWEEP = '[axes]\n"contact.mu_static" = [0.3, 0.4]\n'
ENSEMBLE = (
    'draws = 80\n[set]\n"solver.model" = "rigid"\n[axes]\n"contact.mu_static" = [0.3, 0.4]\n'
    '[random]\n"motion.phase_rad" = { distribution = "uniform", from = 0.0, to = 6.2832 }\n'
)
READERS = pytest.mark.parametrize("read, text", [(load_sweep, SWEEP), (load_ensemble, ENSEMBLE)])


def written(folder, text, case):
    folder.mkdir(exist_ok=True)
    path = folder / "many.toml"
    path.write_text(f'case = "{case}"\n{text}', encoding="utf-8")
    return path


@READERS
def test_a_file_beside_it_wins_over_a_shipped_case(tmp_path, read, text):
    pair = CASES.text("seed_box").replace("boxes = 1 ", "boxes = 2 ")
    (tmp_path / "seed_box").write_text(pair, encoding="utf-8")
    assert read(written(tmp_path, text, "seed_box")).base.container.boxes == 2
    (tmp_path / "seed_box").unlink()
    assert read(written(tmp_path, text, "seed_box")).base.container.boxes == 1


@READERS
@pytest.mark.parametrize("case", ["../outside.toml", "/etc/hostname"])
def test_a_path_out_of_the_folder_is_refused(tmp_path, read, text, case):
    (tmp_path / "outside.toml").write_text("", encoding="utf-8")
    with pytest.raises(CaseError, match="case"):
        read(written(tmp_path / "inner", text, case))


@READERS
def test_a_key_that_is_set_and_varies_is_refused(tmp_path, read, text):
    own = '"contact.mu_static" = 0.5\n'
    set_too = text.replace("[axes]", f"{own}[axes]") if "[set]" in text else f"{text}[set]\n{own}"
    path = written(tmp_path, set_too, "seed_box")
    with pytest.raises(CaseError, match=r"\[set\] 'contact\.mu_static' varies as well"):
        read(path)


VALUES = {"contact.mu_static": 0.4, "gravity_m_s2": 9.81, "free.lambda": 3.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.5 * contact.mu_static", 0.2),
        ("1 + 2 * 3 - 4 / 2", 5.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2 ** -1", 0.5),
        ("10 - 4 - 3", 3.0),
        ("(1 + 2) * 3", 9.0),
        ("max(1e-3, min(gravity_m_s2, 2.))", 2.0),
        ("sqrt(2) * sin(pi / 4)", 1.0),
        ("\n2 *\tfree.lambda ^ 2", 18.0),  # a key may be one of Python's words
    ],
)
def test_values(text, value):
    assert parse_expression(text).value(VALUES) == pytest.approx(value, rel=1e-15)


@given(st.text(alphabet="0123456789.eE+-*/^() ,abcdefg_pisqrtmuxn", max_size=60))
def test_any_text_is_an_expression_or_refused(text):
    try:
        parsed = parse_expression(text)
    except ExpressionError:
        return
    values = dict.fromkeys(parsed.keys, 0.7)
    try:
        assert math.isfinite(parsed.value(values))
    except ExpressionError:
        return


@pytest.mark.parametrize("text", ["1if", "0x1in", "1jor", "1or 2", "(1)(2)", "'a'(1)"])
def test_a_doubt_of_python_is_told_in_words_and_not_printed(text):
    with warnings.catch_warnings(record=True) as caught, pytest.raises(ExpressionError):
        warnings.simplefilter("always")
        parse_expression(text)
    assert not caught


def test_a_mass_centre_that_stays_where_the_height_is_varied_is_told_as_by_a_run(tmp_path, capsys):
    head = 'case = "seed_box"\n[set]\n"solver.model" = "rigid"\n"solver.duration_s" = 0.1\n'
    axis = '[axes]\n"container.height_m" = [1.0, 2.0]\n'
    path = tmp_path / "tall.toml"
    path.write_text(head + '"container.centroid_m" = 0.5\n' + axis, encoding="utf-8")
    assert main(["sweep", str(path), "--out", str(tmp_path / "out"), "-q"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    main(["check", "seed_box", "--set", "container.height_m=2"])
    own = sweep_in(tmp_path, head + axis).warnings
    assert open_sweep(tmp_path / "out").info.warnings == own != ()
    assert own[0] in told and own[0] in " ".join(capsys.readouterr().out.split())
    moved = '[derived]\n"container.centroid_m" = "0.5 * container.height_m"\n'
    assert sweep_in(tmp_path, head + axis + moved).warnings == ()
