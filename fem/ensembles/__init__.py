"""Shipped ensembles, a commented TOML file each."""
