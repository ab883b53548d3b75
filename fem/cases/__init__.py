"""The shipped cases, one commented TOML file each."""
