"""Put a container on a measured floor motion that is at hand as arrays."""

import numpy as np

import fem

time = np.linspace(0.0, 3.0, 3001)
acceleration = np.where((time > 0.0) & (time <= 0.25), 6.0, 0.0)  # a floor that jerks to the right
case = fem.load_case("sliding", ["solver.model=rigid", "output.fields_s=0", "solver.duration_s=3"])
case = case.replace({"contact.mu_static": 0.3, "contact.mu_kinetic": 0.3}).with_motion(time, acceleration)
run = fem.compute(case, band=False)
print(f"{run.verdict.outcome}: left behind by {-1e3 * run.verdict.residual_slip_m:.0f} mm")
