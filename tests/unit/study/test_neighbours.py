"""Which cells are perturbed, how, and how wide the band is."""

import math

import numpy as np
import pytest

from fem.case.case import load_case
from fem.results.outcome import Ending
from fem.study.axes import Axis
from fem.study.design import Perturbation
from fem.study.sure import band_width, near_cells

X = Axis(key="contact.mu_static", values=(0.1, 0.2, 0.3, 0.4, 0.5), scale="linear")
Y = Axis(key="motion.peak_acceleration_m_s2", values=(1.0, 2.0, 4.0, 8.0), scale="log", unit="m/s2")


def members(case):
    return [change.values for change in Perturbation().changes(case)]


def test_cells_beside_another_kind_are_near_diagonals_too_and_a_close_call_is_by_itself():
    kind, ratio = np.full((5, 4), Ending.STANDING), np.zeros((5, 4))
    kind[0, 0], ratio[3, 2] = Ending.OVERTURNED, 0.6
    near = near_cells((X, Y), kind, ratio, 0.5)
    assert sorted(map(tuple, np.argwhere(near))) == [(0, 0), (0, 1), (1, 0), (1, 1), (3, 2)]


def test_the_band_is_as_wide_as_its_stretch_of_cells():
    unsure = np.zeros((5, 4), dtype=bool)
    unsure[1:3, 1] = True
    unsure[4, 1] = True
    along_x = band_width((X, Y), unsure, 0)
    assert along_x[:, 1] == pytest.approx([0.0, 0.2, 0.2, 0.0, 0.05])
    along_y = band_width((X, Y), unsure, 1)
    assert along_y[1] == pytest.approx([0.0, math.sqrt(8.0) - math.sqrt(2.0), 0.0, 0.0])
    assert along_x[:, [0, 2, 3]].max() == 0.0


def test_each_member_changes_one_thing():
    case = load_case(
        "seed_stack_plateau", ["floor.kind=rigid", "contact.damping_ratio=1.0", "motion.phase_rad=6.2"]
    )
    found = members(case)
    peak = case.motion.peak_acceleration_m_s2 or case.motion.amplitude * case.motion.angular_frequency**2
    changed = [case.with_values(member) for member in found]
    peaks = [one.motion.amplitude * one.motion.angular_frequency**2 for one in changed]
    assert sorted(round(p / peak, 9) for p in peaks) == [0.98] + [1.0] * 6 + [1.02]
    assert all(one.motion.angular_frequency == case.motion.angular_frequency for one in changed)
    friction = {(one.contact.mu_static, one.contact.mu_kinetic) for one in changed}
    mu, kinetic = case.contact.mu_static, case.contact.mu_kinetic
    steps = [(round(a - mu, 9), round(b - kinetic, 9)) for a, b in friction]
    assert sorted(steps) == [(-0.02, -0.02), (0.0, 0.0), (0.02, 0.02)]
    assert sorted({one.contact.damping_ratio for one in changed}) == [0.5, 1.0, 2.0]
    shifts = {round(math.remainder(one.motion.phase_rad - 6.2, math.tau), 9) for one in changed}
    assert shifts == {-0.3142, 0.0, 0.3142}


def test_a_pulse_has_no_phase_and_a_floor_at_rest_no_amplitude():
    still = members(load_case("free_rocking"))
    assert not any(key.startswith("motion.") for member in still for key in member)
    peak = "motion.peak_acceleration_m_s2"
    pulse = ["motion.kind=pulse", "motion.shape=sine", "motion.pulse_s=0.5", f"{peak}=-4.0"]
    found = [member[peak] for member in members(load_case("seed_stack", pulse)) if peak in member]
    assert found == pytest.approx([-3.92, -4.08])
