"""Contact points with the plainest laws: springs, no dashpots, no caps; what a test needs besides, it names."""

import math
from typing import Any

import numpy as np

from contact.arrays import FloatArray
from contact.interface.laws import ELASTIC_STICK
from contact.interface.workspace import Contact


def contact_of(springs: FloatArray, *, force_scale: float, mu: float = 0.0, **named: Any) -> Contact:
    """Points on springs (n,) [N/m] with one coefficient of friction; other fields by their names."""
    n = springs.size
    plain: dict[str, Any] = {
        "normal_stiffness": springs,
        "tangential_stiffness": springs.copy(),
        "cap": np.full(n, math.inf),
        "mu_static": np.full(n, mu),
        "mu_kinetic": np.full(n, mu),
        "stribeck_velocity": 0.0,
        "friction": ELASTIC_STICK,
        "regularisation_velocity": 1e-3,
        "force_scale": force_scale,
        "resolution": 1e-15,
    }
    zeros = {name: np.zeros(n) for name in ("cap_growth", "relaxation_time", "weakening", "camber")}
    return Contact(**plain | zeros | named)
