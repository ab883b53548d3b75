"""Verification at a site: the commands `assess` and `size`, with their file, runs, result and page."""
