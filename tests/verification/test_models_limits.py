"""The reduced model between its limits: the full model as modes are added, the rigid one as stiffness grows."""

import numpy as np
from container_runs import difference, stack

from fem.verification.runs import Finished, run

#: softer than the default, so that f1/f_c is 11, 34, 107; held, so that only the container changes [Pa/m]
PENALTY = 4.577e8
MODULI = (1e11, 1e12, 1e13)


def solid_with(**values: object) -> Finished:
    """Steps small enough that the stepping does not show in the differences."""
    settings = {"solver__duration_s": 1.3, "solver__step_s": 2e-4}
    return run(stack(contact__normal_penalty_Pa_m=PENALTY, **settings, **values))


def test_motion_converges_with_the_number_of_modes() -> None:
    # Attachment modes carry the local deformation under the corners, so even no elastic mode at all is close.
    shell = stack("shell", solver__duration_s=1.3)
    full = run(shell.with_values({"solver.model": "full"}))
    errors = {
        modes: difference(run(shell.with_values({"solver.elastic_modes": modes})), full)
        for modes in (0, 2, 5, 20)
    }
    assert errors[0] <= 0.01
    assert errors[5] <= 1e-3
    assert errors[20] <= 3e-4
    assert errors[0] > 2.0 * errors[2] > 4.0 * errors[5]


def test_rigid_is_the_limit_of_reduced_through_an_impact() -> None:
    # Through a damped impact the difference falls more slowly than 1/E, near 1/sqrt(E), as the frequency ratio does.
    rigid = solid_with(solver__model="rigid")
    apart = [difference(solid_with(container__youngs_modulus_Pa=modulus), rigid) for modulus in MODULI]
    assert apart[0] < 3e-3
    assert apart[1] < 1e-3
    assert apart[2] < 3e-4
    assert np.polyfit(np.log(MODULI), np.log(apart), 1)[0] < -0.4
