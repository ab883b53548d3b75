"""Sweeps over the keys of a case: table, maps, thresholds. They know neither ensembles nor reports."""
