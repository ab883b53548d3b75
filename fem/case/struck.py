"""Keys of what stands beside a container and may be struck by it: a stop, or another container."""

from typing import Annotated, Literal

from fem.case import quantities as q
from fem.case.table import CaseTable, case_key

USUAL_DAMPING = 2.0  #: damping ratio where nothing is said: neither bounces


class StruckTable(CaseTable):
    """What stands beside the container, and its side."""

    side: Literal["left", "right"] = case_key("of the container at which it stands", example="right")
    gap_m: Annotated[float, q.GAP] = case_key("between it and what it stands beside, at rest", example=0.05)
    stiffness_N_m: Annotated[float, q.LINK_STIFFNESS] = case_key("where it is struck", example=1e8)
    damping_ratio: Annotated[float, q.CONTACT_DAMPING] | None = case_key(
        "c/(2 sqrt(k m)), m the mass that strikes, of two containers the reduced one, on this stiffness k; default: 2",
        None,
        example=0.5,
    )
    restitution: Annotated[float, q.STOP_RESTITUTION] | None = case_key(
        "in place of damping_ratio: of what strikes it without turning", None, example=0.5
    )
    mu: Annotated[float, q.FRICTION] = case_key("of friction along its face", 0.0)
