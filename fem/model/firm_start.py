"""A tilted start needs a contact that can carry it.

Tilted, the container stands on one corner. That corner of a flat base has the stiffness of the length of base beside
it alone, and "auto" never chooses a penalty above 3 E/h: of a soft container the weight may sink in by anything up to
many widths. What follows would be the doing of a numerical spring, not of the container.
"""

from contact.interface.solver import Contact
from contact.stepping.body import State
from contact.stepping.ledger import spring_energy
from fem.case.case import Case, CaseError


def require_firm_start(
    case: Case, *, width: float, reference_energy: float, contact: Contact, start: State
) -> None:
    """Refuse a tilted start whose contact springs hold more than what it takes to overturn the container.

    Args:
        case: whose start it is; width: of the container [m].
        reference_energy: what it takes to overturn it [J].
        contact: its springs; start: the state at t = 0.

    Raises:
        CaseError: with how far the corner would sink in.
    """
    held = float(spring_energy(contact, start.point, start.stick)) / reference_energy
    if case.initial.rotation_rad == 0.0 or held <= 1.0:
        return
    sunk = float(-start.point[:, 1].min())
    raise CaseError(
        f"[initial] rotation_rad = {case.initial.rotation_rad:g} rad: the corner that carries the weight would sink in "
        f"by {sunk:.3g} m ({sunk / width:.2g} of the width), and its spring would hold {held:.2g} times what it "
        "takes to overturn the container, and throw it; take a larger contact.normal_penalty_Pa_m (where it is "
        '"auto", it follows container.youngs_modulus_Pa), or support.kind = "corners", whose two corners carry the '
        "stiffness of the whole base"
    )
