"""Dimensions, motions and friction of the paper's container, with g = 9.81."""

import math

GRAVITY, WIDTH, HEIGHT = 9.81, 1.1, 4.0  #: m/s2; of the stack [m]
BOX_WEIGHT = 24525.0  #: of one box, 1 m high [N]
HALF_WIDTH = 0.5 * WIDTH  #: a/2 [m]
UPLIFT = GRAVITY * WIDTH / HEIGHT  #: acceleration at which the stack tilts, g a/c [m/s2]
#: p of a homogeneous block as large as the stack, p^2 = 3 g/(4 R) [1/s]
FREQUENCY_PARAMETER = math.sqrt(0.75 * GRAVITY / (0.5 * math.hypot(WIDTH, HEIGHT)))
ANGULAR_FREQUENCY = 6.928  #: sqrt(2.4 m/s2 / 50 mm), the paper's motion [rad/s]
STATED_PEAK, PLATEAU_PEAK = 2.4, 4.0  #: [m/s2]
PAPER_MU = (0.4, 0.2)  #: static and kinetic friction, Eq. (6)
HOLDING = (1.0, 1.0)  #: of a stack that cannot slide
