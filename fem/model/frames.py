"""How often a run keeps its fields, and what they take.

Measured on shells and blocks of 600 to 9000 nodes: a frame takes 21 (at rest) to 27 bytes a node, all of it compressed.
"""

from fem.case.case import Case
from fem.case.tables.duration import MOST_FREE_MOTION, ends_at_rest

BYTES_OF_A_NODE, BYTES_OF_A_FRAME = 28.0, 2e3
MOST_BYTES = 16e6  #: that the frames of a run take where nobody asks for more
INTERVALS = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)  #: [s]
USUAL_FREE_MOTION = 10.0  #: after a pulse or a record, until the container is at rest or has fallen [s]


def frame_bytes(nodes: int) -> float:
    """Size of a frame, at most."""
    return BYTES_OF_A_NODE * nodes + BYTES_OF_A_FRAME


def frame_interval(case: Case, nodes: int, duration: float) -> float:
    """Time between the fields that a run of at most this duration [s] keeps [s]; 0: none; `nodes`: of the elements.

    "auto" is the shortest of `INTERVALS` of which the frames take no more than `MOST_BYTES`.
    """
    if case.output.fields_s != "auto":
        return case.output.fields_s
    if ends_at_rest(case):
        duration -= MOST_FREE_MOTION - USUAL_FREE_MOTION
    most = MOST_BYTES / frame_bytes(nodes)
    return next((interval for interval in INTERVALS if duration / interval < most), INTERVALS[-1])
