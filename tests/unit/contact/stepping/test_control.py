"""How large a step may be."""

import numpy as np
from block_on_floor import Block, rig

from contact.stepping.control import allowed_imbalance


def test_a_step_that_gains_energy_by_damping_is_allowed_no_more_than_one_that_loses_none():
    # in a step much longer than the last one, the extrapolated acceleration of a fast mode may be a thousand times the
    # true one: the mode gains 44 kJ that the step after takes away, and of which a share would excuse itself
    run = rig(Block()).run
    step = run.problem.control.largest_step
    lossless, gains, loses = (allowed_imbalance.py_func(run, step, lost) for lost in (0.0, -44e3, 44e3))
    assert np.isfinite(lossless)
    assert gains == lossless
    assert loses > lossless
