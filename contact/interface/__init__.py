"""Contact at the base: force laws, springs of a base, Newton iteration, equilibrium. It knows no time step."""
