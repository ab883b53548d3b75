"""A site whose verification takes seconds, and the least that a site file may say."""

SITE = """
container = "seed_stack"
[site]
ground = "D"
reference_acceleration_m_s2 = 3.5
[motions]
count = 3
stationary_s = 10.0
further = 2
[friction]
mu_static = [0.4]
mu_kinetic_over_static = [1.0]
[limits]
slip_m = 0.1
"""

LEAST = """
container = "seed_stack"
[site]
ground = "D"
reference_acceleration_m_s2 = 1.6
[friction]
mu_static = [0.3, 0.4]
[limits]
slip_m = 0.1
"""
