"""Contact at the base: laws at a point, springs of a base, the condensed Newton iteration. It knows no time step."""
