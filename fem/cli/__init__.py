"""One module a command of `python -m fem`, imported only when called. Nothing imports it.

What computes is imported after the input was read: bad input is refused before anything is compiled.
"""
