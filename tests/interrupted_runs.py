"""Runs that are cut off and resumed, and the comparison of two folders of results."""

from pathlib import Path

from fem.results.kinds import read_result

COARSE = ("solver.model=full", "solver.element_size_m=0.5")


def one_slice(stepping, *arguments, **options):
    """Step as asked, but stop after the first slice."""
    answers = iter([False])
    return stepping(*arguments, **options | {"stop": lambda: next(answers, True)})


def files_of(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def without_times(result: dict) -> dict:
    kept = {key: value for key, value in result.items() if key not in ("wall_s", "cpu_s", "compile_s")}
    kept["numerics"] = {k: v for k, v in kept["numerics"].items() if k != "stepping_cpu_s"}
    return kept


def same(one: Path, other: Path) -> None:
    found, wanted = files_of(one), files_of(other)
    assert set(found) == set(wanted)
    for name in set(wanted) - {"run.json", "summary.txt"}:
        assert found[name] == wanted[name], name
    assert without_times(read_result(one / "run.json")) == without_times(read_result(other / "run.json"))
