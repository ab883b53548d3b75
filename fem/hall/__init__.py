"""A hall of containers: a list in, a list out."""
