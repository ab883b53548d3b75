"""The worked example of the simplified methods: container K1 on site S1, and its hand-checked numbers in the tests.

K1: 1.1 m wide and deep, 4 m high, homogeneous, 10 t, mu 0.4 static, 0.2 kinetic. S1: type 1, ground D, a_g S 2.4 m/s2.
"""

from contact.reference.rigid_block import RigidBlock
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.body import FloorAction, LooseBody

SITE = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.4 / 1.35)
#: 0.06 (S_alpha S_beta)^0.55 with the plateau and the value at 1 s
PEAK_VELOCITY = 0.06 * (6.0 * 4.8) ** 0.55
ACTION = FloorAction.on_ground(SITE, PEAK_VELOCITY)
SLIP = 0.1  #: the clearance [m]


def k1(*, mu_static: float = 0.4, mu_kinetic: float = 0.2) -> LooseBody:
    block, size = RigidBlock.homogeneous(width=1.1, height=4.0), {"width": 1.1, "height": 4.0, "depth": 1.1}
    return LooseBody(block=block, **size, mass=10_000.0, mu_static=mu_static, mu_kinetic=mu_kinetic)
