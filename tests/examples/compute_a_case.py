"""Load a shipped case, change it, and compute it in memory."""

import fem

case = fem.load_case("free_rocking", ["solver.model=rigid", "solver.duration_s=4"])
run = fem.compute(case.replace({"contact.mu_static": 0.8}), band=False)
print(run)
print(f"largest rotation {run.verdict.rotation_ratio:.3f} of the slenderness angle")
print(f"ratio of the angular velocities at the first impact {run.verdict.restitution_first:.3f}")
