"""One module a command of `python -m fem`, imported only when called. Nothing imports it."""
