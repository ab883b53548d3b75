"""Figures of a run and the style they share, drawn with matplotlib. They step nothing."""
