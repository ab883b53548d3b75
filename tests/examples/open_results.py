"""Read a folder of results that `python -m fem run` has written."""

import subprocess
import sys

import fem

changed = ["solver.model=rigid", "solver.duration_s=2", "output.fields_s=0.5", "output.figures=false"]
options = [word for change in changed for word in ("--set", change)]
command = [sys.executable, "-m", "fem", "run", "free_rocking", "--no-band", "--quiet", "--out", "rocking"]
subprocess.run(command + options, check=True)

run = fem.open_run("rocking")
rotation = run.history["rotation_rad"]
largest = max(abs(rotation)) / run.slenderness_angle
print(f"{run.name}: {run.status}, {len(run.fields)} frames, largest rotation ratio {largest:.3f}")
