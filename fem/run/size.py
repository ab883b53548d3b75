"""How much a run writes.

Measured on shells and blocks of 600 to 9000 nodes: a frame takes 23 (at rest) to 36 bytes a node, since fields that
are the same at most nodes are compressed; a number of the history takes 18 to 19.4 bytes of text. Added are a
checkpoint and the one that replaces it, figures, and a page of results.
"""

import math

from fem.case.case import Case
from fem.case.columns import history_columns
from fem.results.disk import BYTES_BESIDE, in_units, table_bytes

BYTES_OF_A_NODE, BYTES_OF_A_FRAME = 40.0, 2e3
BYTES_OF_A_CHECKPOINT_NODE = 500.0


def samples_of(case: Case, duration: float) -> int:
    """Rows of the history of a run of this duration [s]."""
    return math.floor(duration / case.output.history_s * (1.0 + 1e-12)) + 1


def frames_of(case: Case, duration: float) -> int:
    """Frames of a run of this duration [s]."""
    if case.output.fields_s == 0.0:
        return 0
    return math.floor(duration / case.output.fields_s * (1.0 + 1e-12)) + 1


def required_disk(case: Case, nodes: int, duration: float) -> float:
    """Size of the folder of a run of this duration [s], in bytes; `nodes` of the elements."""
    history = table_bytes(samples_of(case, duration), len(history_columns(case)))
    frames = (BYTES_OF_A_NODE * nodes + BYTES_OF_A_FRAME) * frames_of(case, duration)
    return history + frames + BYTES_OF_A_CHECKPOINT_NODE * nodes + BYTES_BESIDE


def size_in_words(case: Case, nodes: int, duration: float) -> str:
    """The run and what takes most of its space, for a refusal."""
    frame = in_units(BYTES_OF_A_NODE * nodes + BYTES_OF_A_FRAME)
    return f"the run ({frames_of(case, duration)} frames of {frame}, {samples_of(case, duration)} rows of history)"
