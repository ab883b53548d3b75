"""Raise a floor motion step by step, on all cores, and read off at which strength the container begins to rock."""

import fem

PULSE = {"motion.kind": "pulse", "motion.shape": "rectangular", "motion.pulse_s": 1.0}
ACCELERATIONS = [2.2 + 0.1 * k for k in range(11)]  # m/s2

if __name__ == "__main__":
    base = fem.load_case("rocking", ["solver.model=rigid", "contact.mu_static=1", "output.fields_s=0"])
    cases = [base.replace(PULSE | {"motion.peak_acceleration_m_s2": -a}) for a in ACCELERATIONS]
    runs = fem.compute_many(cases, band=False)
    first = next(a for a, run in zip(ACCELERATIONS, runs, strict=True) if run.verdict.outcome != "rest")
    print(f"rocks from {first:.1f} m/s2 on")
