"""How much memory a command needs."""

import resource
import subprocess
import sys

import pytest


@pytest.mark.parametrize(
    ("megabytes", "options", "code"),
    [
        (512, ("--no-band", "--no-margin"), 0),
        (512, (), 0),
        (512, ("--band",), 3),
        pytest.param(620, (), 0, marks=pytest.mark.slow),
        pytest.param(720, (), 0, marks=pytest.mark.slow),
    ],
)
def test_a_rigid_run_needs_no_more_than_512_mb_and_its_band_and_figures_more(
    tmp_path, megabytes, options, code
):
    """Address space, as `ulimit -v` limits it."""
    command = "-m fem run seed_box --set solver.model=rigid --set solver.duration_s=1 --out out"
    done = subprocess.run(
        [sys.executable, *command.split(), *options],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20,) * 2),
    )
    assert done.returncode == code, done.stderr
    if code:
        assert "memory is limited to 512 MB, and this needs 620 MB or more" in done.stderr
    else:
        left_out = "band and margin are left out: memory is limited" in done.stderr
        assert left_out == (megabytes == 512 and not options)
        assert ("figures were not drawn: memory is limited" in done.stderr) == (megabytes < 720)
        assert any((tmp_path / "out/figures").glob("*.svg")) == (megabytes == 720)
