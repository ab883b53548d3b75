"""Many cases at once: sweeps over the keys of a case, their tables, maps and boundaries."""
