"""The Newmark family on one elastic mode in free flight, with steps that change all the time."""

import numpy as np
import pytest
from evidence.findings import Convergence
from verification.time_stepping import oscillator_error

from contact.stepping.scheme import generalised_alpha, newmark

SCHEMES = {f"rho {radius:g}": generalised_alpha(radius) for radius in (0.0, 0.3, 0.5, 0.8, 1.0)}
SCHEMES["average acceleration"] = newmark(0.25, 0.5)


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_steps_that_change_all_the_time_keep_the_second_order(scheme):
    # The scheme's acceleration lags; were it not shifted when the step changes, the order would fall to one.
    errors = {}
    for h in 1e-2 / 2.0 ** np.arange(4):
        pattern = np.tile([0.9, 0.3, 0.5, 0.7], round(1.0 / (2.4 * h)) + 4)
        errors[h] = oscillator_error(scheme, h, 1.0, np.cumsum(pattern) * h)
    orders = Convergence("step [s]", errors, order=2.0, within=0.1)
    assert orders.passed, orders
