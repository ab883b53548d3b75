"""Compute a sweep: what does a stack do on floors of several frictions, under motions of several strengths?"""

from pathlib import Path

import fem

if __name__ == "__main__":
    table = fem.compute_sweep(Path(__file__).with_name("friction.toml"))
    slides = table["outcome"] == "slide"
    least = table["motion.peak_acceleration_m_s2"][slides].min()
    print(f"{table.result['rows']} runs; it slides from {least} m/s2 on")
