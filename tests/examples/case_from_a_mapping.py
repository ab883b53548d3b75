"""Write a case in Python instead of a file: a box on a floor that shakes sideways."""

import fem

box = {"width_m": 1.1, "height_m": 1.0, "density_kg_m3": 2000.0}
shaking = {"kind": "harmonic", "amplitude_m": 0.05, "angular_frequency_rad_s": 10.0}
case = fem.case_from({"container": box, "contact": {"mu_static": 0.3}, "motion": shaking})
case = case.replace({"solver.model": "rigid", "solver.duration_s": 5.0, "output.fields_s": 0.0})
run = fem.compute(case, band=False)
shear, normal = run.history["shear_force_N"], run.history["normal_force_N"]
print(f"{run.verdict.outcome}: slides {1e3 * run.verdict.max_slip_m:.1f} mm")
