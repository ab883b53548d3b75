"""Runs that are interrupted and resumed, and the comparison of two folders of results."""

from pathlib import Path

from fem.case.case import Case, to_toml
from fem.results.fields import open_fields
from fem.results.history import read_history
from fem.results.kinds import read_result
from fem.results.reader import OpenedRun
from fem.run.run import RunOptions, run_case

FLAT_SHELL = ("support.kind=flat", "container.wall_m=0.02", "solver.elastic_modes=4")
COARSE = ("solver.model=full", "solver.element_size_m=0.5")
TIMES = ("wall_s", "cpu_s", "compile_s")


def run_command(name: str, folder: Path, *overrides: str) -> list[str]:
    """The words of `python -m fem` that run a case into a folder."""
    changes = [word for override in overrides for word in ("--set", override)]
    return ["run", name, "--out", str(folder), "-q", *changes]


def stored_run(case: Case, folder: Path, **options) -> OpenedRun:
    """The run of a case in a folder, with these `RunOptions`."""
    return run_case(case, case_text=to_toml(case), folder=folder, options=RunOptions(**options))


def one_slice(stepping, *arguments, **options):
    """Step as asked, but stop after the first slice."""
    answers = iter([False])
    return stepping(*arguments, **options | {"stop": lambda: next(answers, True)})


def files_of(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def without_times(result: dict) -> dict:
    kept = {key: value for key, value in result.items() if key not in TIMES}
    kept["numerics"] = {k: v for k, v in kept["numerics"].items() if k != "stepping_cpu_s"}
    return kept


def require_same(one: Path, other: Path) -> None:
    """The same files with the same bytes, but for the times that the runs took."""
    found, wanted = files_of(one), files_of(other)
    assert set(found) == set(wanted)
    for name in set(wanted) - {"run.json", "summary.txt"}:
        assert found[name] == wanted[name], name
    assert without_times(read_result(one / "run.json")) == without_times(read_result(other / "run.json"))


def require_readable(folder: Path) -> None:
    """No file is half written, but for a last line of the history without its end."""
    read_result(folder / "run.json")
    if (folder / "history.csv").exists():
        whole_lines = (folder / "history.csv").read_bytes().count(b"\n")
        assert len(read_history(folder / "history.csv").modes) == whole_lines - 1
    if (folder / "fields" / "run.pvd").exists():
        assert all(frame.points.size for frame in open_fields(folder / "fields"))
