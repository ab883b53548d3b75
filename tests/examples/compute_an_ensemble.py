"""Compute an ensemble: how often does a stack overturn on a floor whose friction is not known?"""

from pathlib import Path

import fem

if __name__ == "__main__":
    table = fem.compute_ensemble(Path(__file__).with_name("unknown_friction.toml"))
    for peak, share in zip(table["motion.peak_acceleration_m_s2"], table["probability"], strict=True):
        print(f"{peak} m/s2: overturns in {100 * share:.0f} % of the draws")
