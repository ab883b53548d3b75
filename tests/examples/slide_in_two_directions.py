"""How far a body slides on a floor that moves on a circle, and by how much one component alone misses it."""

import numpy as np

import fem

time = np.arange(0.0, 20.0, 0.001)
x, y = (-0.1 * 7.0**2 * wave(7.0 * time) for wave in (np.cos, np.sin))  # a circle of 0.1 m at 7 rad/s
both = fem.slide_in_plane(time, x, y, mu_static=0.2)
alone = fem.slide_in_plane(time, x, np.zeros_like(x), mu_static=0.2)
steady = time > 15.0
across = [np.ptp(slip[steady], axis=0).max() for slip in (both, alone)]
print(f"peak to peak {1e3 * across[0]:.1f} mm; under one component {1e3 * across[1]:.1f} mm")
