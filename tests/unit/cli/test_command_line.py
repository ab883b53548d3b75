"""The command line: exit codes, one message without a traceback, nothing written on bad input."""

import errno
import json
import os
import re
import resource
import subprocess
import sys
import time
import tomllib

import pytest
from interrupted_runs import run_command

from fem import __main__ as command_line
from fem.case.case import load_case, read_case
from fem.case.files import CASES, COLLECTIONS
from fem.cli.check import text_with_overrides
from fem.model.floor import corner_patch
from fem.render import opengl as rendering
from fem.runtime.threads import cores


def run_in_shell(command):
    words = ["bash", "-c", command.format(python=sys.executable)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def test_a_process_with_bad_input_ends_with_2_and_no_traceback(tmp_path):
    (tmp_path / "broken.toml").write_text("[container]\nwidth_m = 1100\nwall_m = '8'\n", encoding="utf-8")
    code, out, err = run_in_shell(f"cd '{tmp_path}'; {{python}} -m fem run broken.toml")
    assert (code, out) == (2, "") and err.strip() and "Traceback" not in err
    assert [path.name for path in tmp_path.iterdir()] == ["broken.toml"]


def test_a_fault_of_the_program_is_not_dressed_up_as_a_fault_of_the_user(monkeypatch):
    def broken():
        raise ZeroDivisionError("a fault of the program")

    monkeypatch.setattr(command_line, "build_app", lambda: lambda *_, **__: broken())
    with pytest.raises(ZeroDivisionError):
        command_line.main(["list"])


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (KeyboardInterrupt(), 4, "interrupted"),
        (OSError(errno.ENOSPC, "No space left", "history.csv"), 3, "history.csv: No space left"),
        (OSError(errno.ENOENT, "No such file", "a.csv"), 2, "a.csv: No such file"),
    ],
)
def test_an_interrupt_a_full_disk_or_a_missing_file_is_reported_in_a_line(
    monkeypatch, capsys, error, code, words
):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(command_line, "build_app", lambda: fail)
    assert command_line.main(["list"]) == code
    assert capsys.readouterr().err == f"{words}\n"


@pytest.mark.slow
@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-"])
def test_streams_that_are_closed_are_no_error(closed):
    code, _, err = run_in_shell(f"{{python}} -m fem list {closed}")
    assert (code, err) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize("words", ["list", "--help", "run --help"])
def test_a_reader_that_has_seen_enough_is_no_error(words):
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "wb") as broken:
        command = [sys.executable, "-m", "fem", *words.split()]
        done = subprocess.run(command, stdout=broken, stderr=subprocess.PIPE, check=False)
    assert (done.returncode, done.stderr) == (0, b"")


def test_an_interrupt_of_which_a_module_in_c_makes_another_error_is_told_as_one():
    said = """
import os, signal
signal.signal(signal.SIGINT, signal.default_int_handler)
from fem import __main__ as command_line
def importing(*_, **__):
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        raise ImportError('initialization failed') from None
command_line.build_app = lambda: importing
command_line.program()
"""
    assert run_in_shell(f'{{python}} -c "{said}" list') == (4, "", "interrupted\n")


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
@pytest.mark.parametrize(
    ("kilobytes", "command", "needed"),
    [
        (500_000, "run rocking", 700 + 150 * cores()),
        pytest.param(800_000, "report d", 700 + 150 * cores(), marks=pytest.mark.slow),
        pytest.param(800_000, "sweep outcome_map -j 1", 850, marks=pytest.mark.slow),
        (800_000, "assess site --jobs=1", 850),
        pytest.param(60_000, "list", 250, marks=pytest.mark.slow),
    ],
)
def test_a_limit_on_memory_that_is_too_low_is_told_at_once(kilobytes, command, needed):
    """With 500 MB, or 800 MB in two threads, OpenBLAS asks for ever for a buffer; with less, a module fails to load."""
    code, out, err = run_in_shell(f"ulimit -v {kilobytes}; {{python}} -m fem {command}")
    words = rf"memory is limited to \d+ MB, and this needs {needed} MB or more"
    assert (code, out) == (3, "") and re.fullmatch(rf"{words}; raise the limit \(ulimit -v\)\n", err)


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
@pytest.mark.parametrize(
    "command",
    [
        *("report .", "verify --quick", "sweep outcome_map", "ensemble fragility", "assess site"),
        *("size site --over container.boxes", "batch hall.csv --case seed_box"),
        "response --from 1 --to 2",
    ],
)
def test_a_place_that_cannot_be_written_is_refused_before_anything_is_computed(
    tmp_path, monkeypatch, capsys, command
):
    (tmp_path / "hall.csv").write_text("name,boxes\na,1\n")
    monkeypatch.chdir(tmp_path)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
    try:
        code = command_line.main(command.split())
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    said = capsys.readouterr()
    assert (code, said.out) == (3, "")
    assert re.search(r"^\S+: cannot be written \(File too large\); .*--(out DIR|to FILE)\n\Z", said.err, re.M)
    assert [path.name for path in tmp_path.iterdir()] == ["hall.csv"]


@pytest.mark.parametrize("command", ["verify --quick", "validate", "study seed", "report ."])
def test_what_needs_the_clone_says_so_without_its_tests(tmp_path, monkeypatch, capsys, command):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("fem.cli.evidence.TESTS", tmp_path / "tests")
    (tmp_path / "study.json").write_text("{}")
    assert command_line.main(command.split()) == 2
    said = capsys.readouterr()
    assert said.out == "" and "the checks are in the folder tests of a clone" in said.err
    assert [path.name for path in tmp_path.iterdir()] == ["study.json"]


SLOW_PACKAGES = ("numba", "skfem", "scipy", "pyvista", "matplotlib", "meshio", "numpy")


@pytest.mark.parametrize(("command", "allowed"), [("list", ()), ("check", ("numpy",))])
def test_commands_that_solve_nothing_load_no_solver(command, allowed):
    program = (
        "import sys, fem.__main__ as m; m.main(sys.argv[1:]);"
        f"print(*[p for p in {SLOW_PACKAGES} if p in sys.modules], file=sys.stderr)"
    )
    code, _, err = run_in_shell(f'{{python}} -c "{program}" {command}')
    assert code == 0 and set(err.splitlines()[-1].split()) <= set(allowed)


def test_completion_knows_the_commands(capsys):
    assert command_line.main(["completion", "bash"]) == 0
    script = capsys.readouterr().out
    assert all(name in script for name in ("unanchored", *command_line.COMMANDS))


class TestInit:
    @pytest.mark.parametrize("name", CASES.names)
    def test_another_box_does_not_keep_the_patch_and_the_site_of_the_first(self, tmp_path, name):
        path = tmp_path / "mine.toml"
        assert command_line.main(["init", name, "--to", str(path)]) == 0
        lines, shipped = path.read_text(encoding="utf-8").splitlines(), CASES.text(name).splitlines()
        kept = [line for line in lines if line]
        assert [line for line in shipped if line in kept] == kept  # all else as it is
        mine, first = load_case(path), load_case(name)
        assert mine.floor.corner_patch_m is None and mine.static is None
        if first.container.corner_post_N is None:  # posts and castings of one box alone
            assert mine.container.post_m is mine.support.casting_m is None
        else:
            assert mine.support == first.support and corner_patch(mine) == corner_patch(first)

    def test_without_a_name_writes_a_file_with_every_key_that_can_be_run(self, tmp_path):
        path = tmp_path / "mine.toml"
        assert command_line.main(["init", "--to", str(path)]) == 0
        assert read_case(path.read_text(encoding="utf-8")).resolved() == load_case().resolved()


class TestSchema:
    def schema(self, capsys, *kind):
        assert command_line.main(["schema", *kind]) == 0
        return json.loads(capsys.readouterr().out)

    def test_of_a_case_has_every_key_with_its_range(self, capsys):
        schema = self.schema(capsys)
        width = schema["$defs"]["ContainerTable"]["properties"]["width_m"]
        assert (width["minimum"], width["maximum"], width["x-unit"]) == (1e-3, 100.0, "m")
        number, two = schema["$defs"]["ContactTable"]["properties"]["mu_static"]["anyOf"]
        assert (number["type"], number["maximum"]) == ("number", 5.0) and number == two["items"]
        assert (two["type"], two["minItems"], two["maxItems"]) == ("array", 2, 2)
        assert "schema" in schema["properties"]
        assert schema["additionalProperties"] is False
        assert schema["$defs"]["MotionTable"]["required"] == ["kind"]

    @pytest.mark.parametrize("collection", COLLECTIONS, ids=lambda collection: collection.kind)
    def test_knows_every_table_and_key_of_the_shipped_files(self, capsys, collection):
        schema = self.schema(capsys, collection.kind)
        for name in collection.names:
            assert set(tomllib.loads(collection.text(name))) <= set(schema["properties"])


class TestCheck:
    def test_json_has_the_static_block_and_the_numerics(self, capsys):
        assert command_line.main(["check", "seed_box", "--json", "--set", "contact.mu_static=0.5"]) == 0
        document = json.loads(capsys.readouterr().out)
        assert document["static"]["sliding_limit_static_N"] == pytest.approx(0.5 * 24525.0)
        assert document["numerics"]["contact_nodes"] == 2
        assert document["numerics"]["history_samples"] == 4001
        assert document["derived"]["peak_floor_acceleration_m_s2"] == pytest.approx(0.05 * 6.928**2)
        assert any("not credible" in note for note in document["notes"])


class TestRun:
    def test_with_json_the_result_is_printed_and_nothing_else(self, tmp_path, capsys):
        changes = ("solver.model=rigid", "solver.duration_s=0.1", "output.figures=false")
        words = [*run_command("seed_box", tmp_path / "r", *changes), "--no-band", "--json", "-v"]
        assert command_line.main([word for word in words if word != "-q"]) == 0
        assert json.loads(capsys.readouterr().out)["status"] == "completed"

    def test_the_case_that_is_kept_tells_what_the_command_line_changed(self):
        case = load_case("seed_box", ["contact.mu_static=0.5", "title=two\nlines"])
        kept = text_with_overrides(case)
        assert kept.startswith(CASES.text("seed_box").rstrip())
        assert "#   --set 'contact.mu_static=0.5'" in kept
        assert read_case(kept).resolved() == load_case("seed_box").resolved()


class TestDoctor:
    def test_names_versions_and_the_line_that_mends_missing_pictures(self, monkeypatch, capsys):
        monkeypatch.setattr("fem.render.opengl.probe_rendering", lambda: "rendering ended with signal 11")
        assert command_line.main(["doctor", "--json"]) == 0
        report = json.loads(capsys.readouterr().out)
        assert report["rendering"] is False
        assert any("apt-get install -y libegl1 libgl1-mesa-dri" in remedy for remedy in report["remedies"])
        assert report["versions"]["numba"]
        assert report["threads"] >= 1

    def test_a_rendering_that_ends_its_process_is_told_and_does_not_end_this_one(self, monkeypatch):
        monkeypatch.setattr(rendering, "RENDER", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
        assert rendering.probe_rendering() == (
            "no working OpenGL library was found (the rendering test ended with signal 11)"
        )
        words = r"nothing else is affected.*Debian.*apt-get install"
        with pytest.raises(rendering.RenderingError, match=words):
            rendering.require_rendering()
        monkeypatch.setattr(rendering, "RENDER", "raise RuntimeError('no GL')")
        assert rendering.probe_rendering() == "the rendering test failed (RuntimeError: no GL)"
        monkeypatch.setattr(rendering, "RENDER", "pass")
        assert rendering.probe_rendering() is None

    def test_a_rendering_that_hangs_is_given_up(self, monkeypatch):
        monkeypatch.setattr(rendering, "RENDER", "import time; time.sleep(60)")
        monkeypatch.setattr(rendering, "PROBE_SECONDS", 0.5)
        began = time.monotonic()
        assert rendering.probe_rendering() == "the rendering test did not end within 0.5 s"
        assert time.monotonic() - began < 30.0
