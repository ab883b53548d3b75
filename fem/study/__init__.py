"""One study of many cases: points times draws, on all cores, to a table, maps, a curve or a list."""
