"""Directions of components as headers name them, and the positive sense of a vertical one."""

import re

from fem.records.record import Direction

UPWARD = {"up", "u", "ud", "u-d", "v", "ver", "vert", "vertical", "z", "hnz", "hlz", "bnz", "hgz", "-up"}
DOWNWARD = {"down", "dwn", "dn", "d"}
HORIZONTAL = {
    "n", "s", "e", "w", "ns", "ew", "sn", "we", "n-s", "e-w", "h1", "h2", "long", "longitudinal", "tran", "trans",
    "transverse", "radial", "rad", "radl", "tang", "north", "south", "east", "west",
}  # fmt: skip
AZIMUTH = re.compile(r"([ns]?\s*\d{1,3}\s*[ew]?)(\s*deg(rees)?)?", re.IGNORECASE | re.ASCII)


def direction_of(word: str) -> tuple[Direction | None, float]:
    """Direction by its name, and the factor that makes a vertical component positive upward: -1 of "down".

    A number is an azimuth in degrees. None where the name gives none.
    """
    name = word.strip().strip(".").casefold()
    if name in UPWARD:
        return "vertical", 1.0
    if name in DOWNWARD:
        return "vertical", -1.0
    if name in HORIZONTAL or AZIMUTH.fullmatch(name):
        return "horizontal", 1.0
    return (stream_direction(name), 1.0) if len(name) == 3 else (None, 1.0)


def stream_direction(code: str) -> Direction | None:
    """Direction by the code of a stream, such as HNE or HNZ."""
    match = re.fullmatch(r"[a-z][nlghj]([zne123rtxy])", code.casefold())
    if match is None:
        return None
    return "vertical" if match[1] == "z" else "horizontal"
