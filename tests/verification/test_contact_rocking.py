"""A stepped rigid block on two springs and dashpots against the exact rocking block.

Contact damping 2 makes an impact plastic at the corner (Housner, 1963). The bounce frequency on the penalty is once
and three times the one that a case chooses.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import GRAVITY, Block, Rig, rig

from contact.interface.equilibrium import tilted
from contact.motion.base_motion import HarmonicMotion
from contact.stepping.integrator import OVERTURNED
from contact.stepping.outcome import advance_compiled

STACK = Block()
AMPLE = replace(STACK, mu_static=1.0, mu_kinetic=1.0)


def released(block: Block, share: float) -> Rig:
    """Tilted to a share of the slenderness angle, let go."""
    stance = tilted(
        rotation=share * block.slenderness_angle,
        angular_velocity=0.0,
        mass=block.mass,
        inertia=block.inertia,
        gravity=block.gravity,
        point=block.point,
        corner_x=math.copysign(0.5 * block.width, share),
        compliance=np.zeros((4, 4)),
        normal_stiffness=block.contact().normal_stiffness,
        mu_static=block.mu_static,
    )
    return rig(block, stance=stance)


# Housner's e = 1 - (3/2) sin^2 of the slenderness angle, c/a = 1.5, 2, 2.5, 3.64.
HOUSNER = {1.65: 0.5385, 2.2: 0.7, 2.75: 0.7931, 4.0: 0.8945}


@pytest.mark.parametrize("frequency", [117.0, 350.0])
@pytest.mark.parametrize(("height", "printed"), HOUSNER.items())
def test_restitution_on_two_corners_is_housners(height, printed, frequency):
    block = replace(AMPLE, height=height, bounce_frequency=frequency)
    exact = 1.0 - 1.5 * math.sin(block.slenderness_angle) ** 2
    assert exact == pytest.approx(printed, abs=1e-4)
    run = released(block, 0.5).advance(4.0)
    assert run.track.restitution == pytest.approx(exact, abs=5e-3)


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_the_slenderness_angle_divides_falling_from_coming_back(share):
    # Balanced on a corner, the side of it on which the weight stands decides.
    run = released(AMPLE, share)
    status = advance_compiled(run.body, run.run, 10.0)
    assert (status == OVERTURNED) == (share > 1.0)
    assert (run.track.overturned_at < math.inf) == (share > 1.0)


@pytest.mark.parametrize("acceleration", [0.95, 1.05])
def test_a_constant_pull_lifts_an_edge_from_g_times_width_over_height_on(acceleration):
    # Uplift of a rigid block, statics; on two corners there is no earlier opening of the base.
    limit = GRAVITY * STACK.width / STACK.height
    motion = HarmonicMotion(amplitude=acceleration * limit / 0.5**2, angular_frequency=0.5, duration=20.0)
    run = rig(STACK, motion=motion).advance(4.0)  # beyond the first peak of the floor's acceleration
    assert (run.track.first_uplift < math.inf) == (acceleration > 1.0)
    if acceleration > 1.0:  # it lifts where the slowly rising floor acceleration passes the limit
        exact = math.asin(1.0 / acceleration) / 0.5
        assert run.track.first_uplift == pytest.approx(exact, rel=0.01)
