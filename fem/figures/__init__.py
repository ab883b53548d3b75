"""Figures of a run and their style, drawn with matplotlib. No result is computed here."""
