"""Floor motions and their compiled form. It knows neither contact nor a container."""
