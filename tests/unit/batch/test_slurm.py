"""A study by jobs of Slurm: a fake `sbatch` runs them here; the cost is told before anything is submitted."""

import os

import pytest
from small_sweep import SMALL

from fem.__main__ import main

pytest.importorskip("dask_jobqueue", reason="the extra 'slurm' is not installed")

SBATCH = """#!/bin/sh
cat "$1" >> "$JOBS/scripts"
setsid sh "$1" > "$JOBS/log" 2>&1 &
echo $! >> "$JOBS/pids"
echo "Submitted batch job $!"
"""
SCANCEL = """#!/bin/sh
kill -TERM -- "-$1" 2> /dev/null
exit 0
"""
JOB = 'cores = 2\nmemory = "2GB"\nwalltime = "00:10:00"\nqueue = "compute"\ninterface = "lo"\n'


@pytest.fixture
def jobs(tmp_path, monkeypatch):
    """The folder in which the fake commands write."""
    for name, text in (("sbatch", SBATCH), ("scancel", SCANCEL)):
        (tmp_path / name).write_text(text, encoding="utf-8")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("JOBS", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "job.toml").write_text(JOB, encoding="utf-8")
    (tmp_path / "small.toml").write_text(SMALL, encoding="utf-8")
    return tmp_path


@pytest.mark.slow
def test_jobs_of_slurm_give_the_same_table(jobs, undrawn, capsys):
    assert main(["sweep", "small.toml", "--slurm", "job.toml", "--yes", "--out", "far", "-q"]) == 0
    assert "CPU hours" in capsys.readouterr().err
    script = (jobs / "scripts").read_text(encoding="utf-8")
    assert "#SBATCH -p compute" in script and "#SBATCH -t 00:10:00" in script
    assert "--cpus-per-task=2" in script
    assert main(["sweep", "small.toml", "--out", "here", "-q"]) == 0
    far, here = ((jobs / name / "members.csv").read_bytes() for name in ("far", "here"))
    assert far == here


def test_nothing_is_submitted_unasked(jobs, undrawn, capsys):
    assert main(["sweep", "small.toml", "--slurm", "job.toml", "-q"]) == 2
    said = capsys.readouterr().err
    assert "CPU hours" in said and "nothing was submitted; --yes submits" in said
    assert not (jobs / "scripts").exists()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (JOB.replace("queue", "partition"), "unknown key 'partition'"),
        (JOB.replace("cores = 2\n", ""), "cores"),
        ("cores = ", "cannot be read as TOML"),
    ],
)
def test_a_file_of_slurm_that_cannot_be_used_is_refused(jobs, capsys, text, words):
    (jobs / "job.toml").write_text(text, encoding="utf-8")
    assert main(["sweep", "small.toml", "--slurm", "job.toml", "--yes"]) == 2
    assert words in capsys.readouterr().err and not (jobs / "scripts").exists()
