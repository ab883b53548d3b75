"""How much memory a command needs."""

import resource
import subprocess
import sys

import pytest


@pytest.mark.parametrize(
    ("megabytes", "options", "code"), [(512, ("output.figures=false",), 0), (512, (), 3)]
)
def test_a_rigid_run_without_figures_needs_no_more_than_512_mb(tmp_path, megabytes, options, code):
    """Address space, as `ulimit -v` limits it."""
    given = [
        word
        for option in ("solver.model=rigid", "solver.duration_s=1", *options)
        for word in ("--set", option)
    ]
    command = [
        sys.executable,
        "-m",
        "fem",
        "run",
        "seed_box",
        "--no-band",
        "--no-margin",
        "--out",
        "out",
        "-q",
        *given,
    ]
    done = subprocess.run(
        command,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20,) * 2),
    )
    assert done.returncode == code, done.stderr
    assert code == 0 or "memory is limited to 512 MB, and this needs 620 MB or more" in done.stderr
