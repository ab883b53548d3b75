"""Probability of overturning over random quantities: fragility curves and boundaries. It knows no reports."""
