"""Figures of a run and their style, drawn with matplotlib. The room computes nothing."""
