"""How much a run writes.

A number of the history takes 18 to 19.4 bytes of text. Added are the frames, a checkpoint and the one that replaces it,
figures, and a page of results.
"""

import math

from fem.case.case import Case
from fem.case.columns import history_width
from fem.model.frames import frame_bytes, frame_interval
from fem.results.disk import BYTES_BESIDE, in_units, table_bytes

BYTES_OF_A_CHECKPOINT_NODE = 500.0


def samples_of(case: Case, duration: float) -> int:
    """Rows of the history of a run of this duration [s]."""
    return math.floor(duration / case.output.history_s * (1.0 + 1e-12)) + 1


def frames_of(case: Case, nodes: int, duration: float) -> int:
    """Frames of a run of this duration [s]; `nodes` of the elements."""
    interval = frame_interval(case, nodes, duration)
    return math.floor(duration / interval * (1.0 + 1e-12)) + 1 if interval else 0


def required_disk(case: Case, nodes: int, duration: float) -> float:
    """Size of the folder of a run of this duration [s], in bytes; `nodes` of the elements."""
    history = table_bytes(samples_of(case, duration), history_width(case))
    frames = frame_bytes(nodes) * frames_of(case, nodes, duration)
    return history + frames + BYTES_OF_A_CHECKPOINT_NODE * nodes + BYTES_BESIDE


def size_in_words(case: Case, nodes: int, duration: float) -> str:
    """The run and what takes most of its space, for a refusal."""
    frames = f"{frames_of(case, nodes, duration)} frames of {in_units(frame_bytes(nodes))}"
    return f"the run ({frames}, {samples_of(case, duration)} rows of history)"
