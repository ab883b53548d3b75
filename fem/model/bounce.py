"""The bounce of one corner: its frequency, and the damping that container, fill and floor give it.

A container that lands on a corner swings on the springs of its shell and of the floor there, with the mass that the
corner feels: 1/m_eff = 1/m + x^2/I, x the distance of the corner from the mass centre. What damps this swing decides
how far the container rebounds.

The steel has a damping ratio at the first elastic mode. The fill is mass without stiffness; what it takes of the swing
is stated at the bounce: the ratio of a mode in which the fill alone moves, times its share of the mass. Both are
proportional to the stiffness, C = a K with

    a = 2 zeta_steel / omega_1 + 2 (share of the fill) zeta_fill / omega_b

so that rigid motions, the rocking itself, are not damped.
"""

import math
from dataclasses import dataclass

import numpy as np

from contact.interface.workspace import Contact
from fem.case.case import Case
from fem.model.container import Container

#: a corner force is averaged over this, over 1/p, and over this share of the period of the bounce, at most
FORCE_WINDOW, SHARE_OF_BOUNCE = 0.01, 0.1


@dataclass(frozen=True, kw_only=True)
class Bounce:
    """The swing of a container that stands on one corner, the one that gives way more."""

    angular_frequency: float  #: [rad/s]
    container_damping_ratio: float  #: of steel and fill at this frequency [-]
    contact_damping_ratio: float  #: of the floor's dashpot, or of that of the numerical penalty [-]
    material_damping: float  #: a of C = a K [s]

    @property
    def frequency(self) -> float:
        """Cycles a second [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    def force_window(self, frequency_parameter: float) -> float:
        """Over which a corner force is averaged [s]: short beside the bounce, and beside rocking with 1/p [s]."""
        period = 2.0 * math.pi / self.angular_frequency
        return min(FORCE_WINDOW / frequency_parameter, SHARE_OF_BOUNCE * period)


def bounce_of(case: Case, container: Container, contact: Contact) -> Bounce:
    """The bounce of a container on this contact; of a loose stack that of its lowest box, of a row that of the first.

    `contact` is that of the points on the floor, at their full weight; points behind them do not matter.
    """
    standing = container.bodies[0]
    mesh, response = standing.mesh, standing.response
    places = standing.elements.nodes[standing.nodes[: standing.support.index.size], 0]
    springs = contact.normal_stiffness[: places.size]
    centre, middle = mesh.centroid[0], 0.5 * (places[0] + places[-1])
    frequency, floor_share = math.inf, 1.0
    for side in (places < middle, places > middle):
        stiffness, points = float(springs[side].sum()), np.flatnonzero(side)
        load = springs[side] / stiffness
        arm = float(load @ places[side]) - centre
        shell = 0.0
        if response.compliance.size:
            vertical = 2 * points + 1
            shell = float(load @ response.compliance[np.ix_(vertical, vertical)] @ load)
        compliance = shell + 1.0 / stiffness
        own = math.sqrt((1.0 / mesh.mass + arm * arm / mesh.inertia) / compliance)
        if own < frequency:
            frequency, floor_share = own, 1.0 / stiffness / compliance
    box = case.container
    damping = 2.0 * box.damping_ratio / container.first
    fill = 0.0  # its share in the mass of a box of steel plates; of others none
    if box.section == "shell" and box.mesh_file is None:
        area, _ = mesh.elevation.areas_and_centroids
        fill = max(0.0, 1.0 - box.wall_density_kg_m3 * float(mesh.thickness @ area) / mesh.mass)
    damping += 2.0 * fill * box.fill_damping_ratio / frequency
    return Bounce(
        angular_frequency=frequency,
        container_damping_ratio=0.5 * (1.0 - floor_share) * damping * frequency,
        contact_damping_ratio=0.5 * floor_share * float(contact.relaxation_time[0]) * frequency,
        material_damping=damping if container.first < math.inf else 0.0,
    )
