"""The outcome map of the rigid stack against the event-driven block: they agree wherever the band says sure.

The block shares no code with the stepping: Housner's impacts, exact events (`contact.reference.planar_block`).
"""

import numpy as np
import pytest

from contact.reference.planar_block import PlanarBlock, PlanarMode, simulate_planar_block
from fem.model.model import build_model
from fem.run.rigid_check import block_of, floor_of
from fem.run.simulation import AFTERMATH
from fem.study.file import load_sweep
from fem.study.sweep import run_sweep
from fem.study.sweep_table import open_sweep

MAP = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"container.section" = "solid"
"solver.duration_s" = 20.0
"output.history_s" = 0.02
# the block has this friction and this start
"uncertainty.mu_kinetic" = "known"
"uncertainty.weakening_m" = "known"
"uncertainty.stribeck_velocity_m_s" = "known"
"uncertainty.start" = "known"
"uncertainty.ramp" = "known"
[axes]
"motion.angular_frequency_rad_s" = { from = 1.5, to = 10.0, count = 24, scale = "log" }
"motion.peak_acceleration_m_s2" = { from = 1.7, to = 13.3, count = 24 }
"""


def block_overturns(sweep, cell, container):
    """Whether the block falls; None where it leaves what it models."""
    case = sweep.case(cell)
    model = build_model(case, container)
    block = PlanarBlock(
        body=block_of(model), mu_static=case.contact.mu_static, mu_kinetic=case.contact.mu_kinetic
    )
    duration = case.solver.duration_s
    for end in (duration, duration + AFTERMATH / model.static.frequency_parameter):
        motion = simulate_planar_block(block, floor_of(model.motion, driven_until=duration), duration=end)
        if motion.outcome is PlanarMode.OUTSIDE:
            return None
        if motion.outcome is PlanarMode.OVERTURNED:
            return True
        if abs(motion.at(np.array([motion.end])).rotation[0]) < model.static.slenderness_angle:
            return False
    return None


@pytest.mark.slow
def test_sure_cells_agree_with_the_block(tmp_path):
    path = tmp_path / "map.toml"
    path.write_text(MAP, encoding="utf-8")
    sweep = load_sweep(path)
    info = run_sweep(sweep, tmp_path / "out")
    table = open_sweep(tmp_path / "out")
    container = build_model(sweep.case(0)).container
    overturned = table.outcome == "overturned"
    sure = table["unsure"] == 0.0
    compared, differing = 0, []
    for cell in np.flatnonzero(sure):
        falls = block_overturns(sweep, int(cell), container)
        if falls is not None:
            compared += 1
            if falls != overturned[cell]:
                differing.append((sweep.point(int(cell)), table.outcome[cell], table["rotation_ratio"][cell]))
    assert differing == []
    assert info["outcomes"].get("failed", 0) == 0
    assert compared > 0.4 * table.outcome.size  # half of the cells are sure over what is not known
    assert overturned[sure].any() and not overturned[sure].all()
