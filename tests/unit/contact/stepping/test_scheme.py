"""Coefficients of the Newmark family that are refused, what a step dissipates, and how large it may be."""

import numpy as np
import pytest
from block_on_floor import Block, rig

from contact.stepping.control import allowed_imbalance
from contact.stepping.ledger import dissipation
from contact.stepping.scheme import newmark


@pytest.mark.parametrize(
    ("beta", "gamma"),
    [(0.0, 0.5), (1.0 / 6.0, 0.5), (0.25, 0.49), (0.25, 0.6), (np.nan, 0.5), (0.25, np.nan)],
)
def test_newmark_that_is_only_conditionally_stable_is_refused(beta, gamma):
    # Central differences and linear acceleration are members of the family, but not stable at every step.
    with pytest.raises(ValueError, match="2 beta >= gamma >= 1/2"):
        newmark(beta, gamma)


def test_a_step_that_gains_energy_by_damping_is_allowed_no_more_than_one_that_loses_none():
    # in a step much longer than the last one, the extrapolated acceleration of a fast mode may be a thousand times the
    # true one: the mode gains 44 kJ that the step after takes away, and of which a share would excuse itself
    run = rig(Block()).run
    step = run.problem.control.largest_step
    lossless, gains, loses = (allowed_imbalance.py_func(run, step, lost) for lost in (0.0, -44e3, 44e3))
    assert np.isfinite(lossless)
    assert gains == lossless
    assert loses > lossless


def test_every_loss_counts_once_as_dissipation():
    assert dissipation(np.array([1e5, 1.0, 20.0, 300.0, 4000.0, 5e6])) == 4321.0
