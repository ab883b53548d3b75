"""Probability of overturning from a seeded ensemble: fragility curves and confidence boundaries."""
