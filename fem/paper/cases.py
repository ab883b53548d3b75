"""The paper's containers and motions, as shipped cases."""

import math

from fem.paper.claims import Setup

GRAVITY, WIDTH, HEIGHT = 9.81, 1.1, 4.0  #: m/s2; of the stack [m]
BOX_WEIGHT = 24525.0  #: of one box, 1 m high [N]
HALF_WIDTH = 0.5 * WIDTH  #: a/2 [m]
UPLIFT = GRAVITY * WIDTH / HEIGHT  #: acceleration at which the stack tilts, g a/c [m/s2]
#: p of a homogeneous block as large as the stack, p^2 = 3 g/(4 R) [1/s]
FREQUENCY_PARAMETER = math.sqrt(0.75 * GRAVITY / (0.5 * math.hypot(WIDTH, HEIGHT)))

BOX = Setup(base="seed_box", what="one box, 50 mm at 6.928 rad/s")
STACK = Setup(base="seed_stack", what="stack of four, 50 mm at 6.928 rad/s")
PLATEAU = Setup(base="seed_stack_plateau", what="stack of four, 4.0 m/s² at 6.928 rad/s")

ANGULAR_FREQUENCY = 6.928  #: sqrt(2.4 m/s2 / 50 mm), the paper's motion [rad/s]
STATED_PEAK, PLATEAU_PEAK = 2.4, 4.0  #: [m/s2]
#: the paper's g with its mass: 2500 kg
G_TEN = {"gravity_m_s2": 10.0, "container.weight_N": 25000.0}
NO_SLIDING = {"contact.mu_static": 1.0, "contact.mu_kinetic": 1.0}
#: a rigid container whose history is not asked for
FOR_MAPS = {"solver.model": "rigid", "output.history_s": 2.0}


def harmonic(peak: float, angular_frequency: float) -> dict[str, float]:
    """A harmonic motion by its peak acceleration [m/s2] and frequency [rad/s]."""
    return {
        "motion.peak_acceleration_m_s2": float(f"{peak:.8g}"),
        "motion.angular_frequency_rad_s": float(f"{angular_frequency:.8g}"),
    }
