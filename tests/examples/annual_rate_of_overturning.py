"""How often a year a body overturns that falls under half of the motions of 3.2 m/s2."""

import math

import fem

# two points of a hazard map: 1.6 m/s2 once in 475 years, 3.0 m/s2 once in 2475 years
rate = fem.annual_rate([1.6, 3.0], [1 / 475, 1 / 2475], median_m_s2=3.2, beta=0.4)
in_50_years = -math.expm1(-50.0 * rate)
print(f"{rate:.2e} per year, {100.0 * in_50_years:.1f} % in 50 years")
