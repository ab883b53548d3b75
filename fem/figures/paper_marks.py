"""The paper's example on the axes of a map: its friction, its aspect ratios, its motion.

Knoedel and Hrabowski, sections 4.3 and 7: mu_s 0.4, boxes of 1.1 x 1.0 m, alone and four high, 2.4 and 4.0 m/s2 at
6.928 rad/s.
"""

import math

#: shipped cases of the paper's containers
CASES = frozenset({"seed_box", "seed_stack", "seed_stack_plateau", "stack_on_concrete"})
OMEGA = 6.928  #: [rad/s]
LABEL = "the paper's example"
#: key of an axis -> its values
VALUES: dict[str, tuple[float, ...]] = {
    "container.boxes": (1.0, 4.0),
    "contact.mu_static": (0.4,),
    **dict.fromkeys(("free.aspect_ratio", "free.slenderness"), (1.0 / 1.1, 4.0 / 1.1)),  # as shipped
    "motion.angular_frequency_rad_s": (OMEGA,),
    "motion.frequency_Hz": (OMEGA / (2.0 * math.pi),),
    "motion.peak_acceleration_m_s2": (2.4, 4.0),
    "motion.amplitude_m": (2.4 / OMEGA**2, 4.0 / OMEGA**2),
}


def marks_of(base: str, key: str) -> tuple[float, ...]:
    """Values of the paper's example on an axis; none where the base case is another container."""
    return VALUES.get(key, ()) if base in CASES else ()
