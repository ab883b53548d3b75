"""What the README tells a newcomer to type exists, works in the order it stands there, and says what it claims."""

import json
import re
import shlex
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest

import fem
from fem.__main__ import COMMANDS, main
from fem.case.case import load_case
from fem.case.files import CASES, DEFAULT_CASE
from fem.render.opengl import MEND_PICTURES, probe_rendering
from fem.response.lasting import PointRow
from fem.run.run import RunOptions, run_case
from fem.site.request import load_site
from fem.study.file import load_sweep

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted({*ROOT.glob("*/*.md"), *ROOT.glob("fem/**/*.md")})]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```sh\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)
LINES = [line for block in BLOCKS for line in block.splitlines()]
TOUR = [line for line in LINES if line.startswith("python -m fem ")]
#: a case that is computed at once, with frames
RIGID = ["solver.model=rigid", "solver.duration_s=2", "output.fields_s=0.5", "output.figures=false"]
#: appended to a command of the tour: the same command, less to compute
SHORT = {
    "run": ("--set", "solver.duration_s=0.1", "--set", "output.fields_s=0.05", "--no-band"),
    "verify": ("--topic", "statics"),
    "study": ("--only", "half-width"),
}
#: changed in the shipped site: three motions in place of 107, one weight, one friction
FEWER_RUNS = {
    "count = 7": "count = 3",
    "further = 100": "further = 0",
    "empty_mass_kg = 600.0": "",
    "mu_static = [0.3, 0.4]": "mu_static = [0.4, 0.4]",
    "mu_kinetic_over_static = [0.5, 1.0]": "mu_kinetic_over_static = [1.0, 1.0]",
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_pages_can_be_read_without_scrolling_sideways(page):
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    for line in text.splitlines():
        if line.startswith("|"):
            assert len(line) <= 190, line  # a longer row is a list
        elif not line.startswith(("<", "    ", "`python")):
            assert len(line) <= 110, line


def smaller_site(name: str, folder: Path) -> str:
    """A site file with the shipped site, less to compute."""
    text = load_site(name).origin.text
    for shown, short in FEWER_RUNS.items():
        assert shown in text
        text = text.replace(shown, short)
    (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    return f"{name}.toml"


def test_two_lines_set_up_run_and_test():
    setups = [line for line in LINES if "pip install" in line]
    assert len(setups) == 2
    run, tests = ([part.strip() for part in line.split("&&")] for line in setups)
    assert run[:2] == ["python3 -m venv .venv", ".venv/bin/python -m pip install -e ."]
    assert run[2:] == [".venv/bin/python -m fem run"]
    assert tests[0] == run[0]
    assert tests[1] == '.venv/bin/python -m pip install -e ".[dev]"'
    assert tests[2].startswith(".venv/bin/python -m pytest")


def test_the_server_runs_the_test_line_of_the_readme():
    pattern = re.search(r"grep -m1 -E '(.*?)' README.md", (ROOT / ".ci" / "run").read_text(encoding="utf-8"))
    assert pattern is not None
    found = [line for line in README.splitlines() if re.search(pattern[1], line)]
    assert found == [line for line in LINES if "pytest" in line]


def test_every_command_is_told_of_and_every_command_told_of_exists():
    told = set(re.findall(r"python -m fem ([a-z]+)", README)) | set(re.findall(r"`([a-z]+)`", README))
    assert set(COMMANDS) <= told
    assert set(re.findall(r"python -m fem ([a-z]+)", README)) <= set(COMMANDS)


def test_help_names_every_command_and_answers_without_the_solver():
    # numba, pyvista and scikit-fem take half a second to a second and a half each to import.
    script = (
        "import sys; from fem.__main__ import main; main(['--help']); "
        "print(*{'numba', 'pyvista', 'skfem', 'scipy'} & set(sys.modules))"
    )
    result = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True, timeout=60
    )
    *page, loaded = result.stdout.splitlines()
    assert loaded == ""
    assert all(re.search(rf"\b{name}\b", "\n".join(page)) for name in COMMANDS)


def test_the_tour_works_as_written(tmp_path, monkeypatch, capsys):
    assert len(TOUR) >= 10
    monkeypatch.chdir(tmp_path)
    renders = probe_rendering() is None
    for line in TOUR:
        arguments = shlex.split(line)[3:]
        short = () if "--dry-run" in arguments else SHORT.get(arguments[0], ())
        if arguments[0] == "assess":
            arguments[1] = smaller_site(arguments[1], tmp_path)
        code, (output, errors) = main([*arguments, *short]), capsys.readouterr()
        if arguments[0] in ("picture", "movie") and not renders:
            assert (code, MEND_PICTURES in errors) == (2, True), errors
            continue
        assert code == 0, f"{line}\n{output}\n{errors}"
        assert output.strip(), line
        if arguments[0] == "list":
            assert all(name in output for name in CASES.names)
        if arguments[0] == "schema":
            assert json.loads(output)["properties"]["container"]
    results = tmp_path / "outputs" / "my-stack"
    table = README.partition("| file in ")[2].partition("\n\n")[0]
    files = re.findall(r"`([a-z/]+\.(?:txt|json|csv|pvd|svg|toml))`", table)
    assert {"run.json", "fields/run.pvd", "resolved.toml"} <= set(files)
    assert [name for name in files if not (results / name).is_file()] == []
    assert json.loads((results / "run.json").read_text())["status"] == "completed"
    assert {path.name for path in (tmp_path / "outputs").iterdir()} >= {"my-stack", "slippery", "rigid"}


def test_the_lines_in_python_work_as_in_a_notebook(tmp_path, monkeypatch):
    (lines,) = re.findall(r"^```python\n(import fem\n.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)
    for shown, short in (
        ('load_case("rocking")', f'load_case("rocking", {RIGID})'),  # the same, less to compute
        (".plot()", ".n_points"),  # no window
    ):
        assert shown in lines
        lines = lines.replace(shown, short)
    case = load_case("rocking", RIGID)
    kept, alone = tmp_path / "outputs" / "my-stack", RunOptions(band=False)
    run_case(case, case_text=case.text, folder=kept, options=alone)
    before = {path.name for path in tmp_path.rglob("*")}
    monkeypatch.chdir(tmp_path)
    cells = {}
    exec(lines, cells)
    run = cells["run"]
    assert run.case.contact.mu_static == 0.3
    assert run.history["base_acceleration_m_s2"].max() == pytest.approx(6.0)
    assert [run.case.container.boxes for run in cells["runs"]] == [2, 3, 4]
    assert {path.name for path in tmp_path.rglob("*")} == before  # no files
    # Kept in a folder, with its motion as a file, it is the same run.
    run_case(run.case, case_text=run.case.text, folder=tmp_path / "kept", options=alone)
    again = fem.compute(fem.load_case(tmp_path / "kept" / "resolved.toml"), band=False)
    assert (again.history.samples == run.history.samples).all()


def test_the_static_figures_of_the_default_case_are_those_of_check(capsys):
    assert main(["check", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["case"] == DEFAULT_CASE
    static, own = document["static"], document["static"]["own_motion"]
    moment = float(f"{static['restoring_moment_Nm'] / 1e3:.12g}")  # 53.955, give or take a rounding
    said = [
        f"{own['base_shear_N'] / 1e3:.1f} kN against {static['sliding_limit_static_N'] / 1e3:.2f} kN",
        f"utilisation {own['utilisation_sliding']:.3f}",
        f"{own['tilting_moment_Nm'] / 1e3:.1f} kNm against",
        f"{moment:.2f} kNm of restoring moment",
        f"utilisation {own['utilisation_overturning']:.3f}",
    ]
    flowing = " ".join(README.split())
    assert [words for words in said if words not in flowing] == []
    assert own["utilisation_sliding"] > 1.0 and own["utilisation_overturning"] > 1.0


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_within_the_repository_lead_somewhere(page):
    targets = re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8"))
    assert [target for target in targets if not (page.parent / target).exists()] == []


def test_files_and_scripts_named_in_the_readme_exist():
    named = re.findall(r"`(?:python )?((?:tests|\.ci)/[\w/.]+)`", README)
    assert {"tests/benchmarks/bench.py", ".ci/run"} <= set(named)
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_symbols_of_the_paper_lead_to_keys_and_columns_that_there_are():
    _, _, after = README.partition("| symbol | here |")
    rows = [line.strip("|").split("|") for line in after.partition("\n\n")[0].splitlines()[2:]]
    symbols = ", ".join(row[0] for row in rows)
    wanted = ("a, b, c", "c/a", "PGA", "η", "ω, T", "β, α", "φ", "μs, μk", "ρ", "Lyapunov")
    assert [symbol for symbol in wanted if symbol not in symbols] == []
    case, columns = load_case(), {field.name for field in fields(PointRow)}
    free = {axis.key for axis in load_sweep("friction_slenderness").axes}
    for name in re.findall(r"`([\w.]+)`", " ".join(row[2] for row in rows)):
        table, _, key = name.rpartition(".")
        assert name in columns | free | set(COMMANDS) or hasattr(getattr(case, table), key), name


def test_the_models_of_one_stack_do_what_the_table_says():
    names = ("rigid body, rigid ground", "shell, rigid ground", "shell, concrete")
    cases = ("seed_stack_plateau", "seed_stack_plateau", "stack_on_concrete")
    lines = [row for row in README.splitlines() if "|" in row]
    rows = {row.split(" | ")[0].strip("| "): row.strip("|").split("|") for row in lines}
    for name, case in zip(names, cases, strict=True):
        keys = {"output.fields_s": 0.0} | ({"solver.model": "rigid"} if name.startswith("rigid") else {})
        verdict = fem.compute(load_case(case).replace(keys), band=False, margin=True).verdict
        _, outcome, ratio, slip, first, air = (cell.strip() for cell in rows[name])
        assert outcome == verdict.outcome
        if (factor := verdict.margin.factor) is None:
            assert first == f"not up to {verdict.margin.largest_tried:g} times"
        else:
            assert float(first.removesuffix(" times")) == pytest.approx(factor, abs=0.006)
        assert float(ratio) == pytest.approx(verdict.rotation_ratio, abs=6e-4)
        assert float(slip.removesuffix(" mm")) == pytest.approx(1e3 * verdict.max_slip_m, abs=0.6)
        assert float(air.removesuffix(" %")) == pytest.approx(100.0 * verdict.flight_share, abs=0.6)
