"""Modules of commands of `python -m fem`, imported only when called. Nothing below imports them.

What computes is imported after the input was read: bad input is refused before anything is compiled.
"""
