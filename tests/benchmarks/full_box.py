"""Cost of a rocking elastic box with the `full` model, and its slip on a floor that starts with a jerk.

A solid box of 22 x 20 bilinear quads (966 unknowns, E = 2.1e9 Pa). Rocking: mu = 1, released from a quarter of its
slenderness angle and followed through its impacts. General finite-element codes need 10 to 25 CPU seconds per
simulated second with small strain, 60 to 95 with finite rotation. The box is so soft on its floor (first elastic
frequency 2.4 times that of the contact) that it rebounds like a bar from a wall: Housner's ratio is printed only to
show how far from rigid it is.

Jerk: x = 0.05 m sin(6.93 t) with the box at rest at t = 0 and mu = 0.4/0.4. The floor starts with 0.3465 m/s, the box
slides 13.80 mm within 76 ms and then sticks, since the floor's 2.40 m/s2 are below the sliding limit. Reference: the
event-driven rigid slider, set-valued Coulomb friction without creep.
"""

import math
import sys
from pathlib import Path

import numpy as np
from floors import sine_floor
from measuring import BENCHMARK_BOX, Figure, Stepped, at_most, median_of, near, report, stepped
from rigid_slider import RigidSlider, simulate_sliding

from contact.reference.rigid_block import RigidBlock
from fem.case.case import load_case

sys.path.append(str(Path(__file__).parents[1] / "rigs"))
from closed_forms_rocking import quarter_period

REPEATS = 3
DURATION = 1.0  # s: the first impact at 0.26 s, then the small ones that follow at a restitution of 0.18
ADAPTIVE, FINE = 0.6, 5.0  # CPU seconds per simulated second
FINE_STEP = 1e-3
BLOCK = RigidBlock.homogeneous(width=1.1, height=1.0)
AMPLITUDE, ANGULAR_FREQUENCY, FRICTION, JERK_DURATION = 0.05, 6.93, 0.4, 3.0
ACCURACY = 5e-3  # of the slip
CREEP = 0.05  # mm, from the stop to the end
AFTER_THE_STOP = 0.025  # s until the elastic stick has stopped ringing


def rocking(name: str, step: float | str, limit: float) -> list[Figure]:
    """CPU seconds per simulated second, the median, and details of one of the runs."""
    tilted = f"initial.rotation_rad={0.25 * BLOCK.slenderness_angle!r}"
    settings = [*BENCHMARK_BOX, tilted, f"solver.duration_s={DURATION}", f"solver.step_s={step}"]
    runs: list[Stepped] = []

    def once() -> float:
        runs.append(stepped(load_case("free_rocking", settings)))
        return runs[-1].cpu_s / DURATION

    cost, run = median_of(REPEATS, once), runs[-1]
    track, clock = run.model.run.track[0], run.model.run.clock[0]
    ratio = float(track.restitution)
    found = f"{ratio:.4f}" if math.isfinite(ratio) else "none, it rebounds"
    exact = f"{quarter_period(BLOCK, 0.25 * BLOCK.slenderness_angle):.4f}, {BLOCK.housner_restitution:.4f}"
    details = f"{run.steps}, {int(clock.rejected)}, {clock.iterations / max(run.steps, 1):.2f}"
    impacts = f"{track.first_impact:.4f}, {found}, {int(track.impacts)}"
    return [
        at_most(f"{name}: CPU s per simulated s", cost, limit),
        Figure(f"{name}: steps, rejected, residuals a step", details),
        run.ledger,
        Figure(f"{name}: first impact [s], velocity ratio, impacts", impacts, f"rigid block: {exact}"),
    ]


def jerk() -> list[Figure]:
    """Slip of the box that the floor leaves behind at the start, and its creep afterwards."""
    settings = [
        *BENCHMARK_BOX,
        "initial.rotation_rad=0.0",
        f"contact.mu_static={FRICTION}",
        f"contact.mu_kinetic={FRICTION}",
        "motion.kind=harmonic",
        f"motion.amplitude_m={AMPLITUDE}",
        f"motion.angular_frequency_rad_s={ANGULAR_FREQUENCY}",
        "motion.start=rest",
        f"solver.duration_s={JERK_DURATION}",
        "output.history_s=0.001",
    ]
    case = load_case("free_rocking", settings)
    slider = RigidSlider(mu_static=FRICTION, mu_kinetic=FRICTION, gravity=case.gravity_m_s2)
    floor = sine_floor(amplitude=AMPLITUDE, angular_frequency=ANGULAR_FREQUENCY)
    speed = -AMPLITUDE * ANGULAR_FREQUENCY
    exact = simulate_sliding(slider, floor, duration=JERK_DURATION, slip_velocity=speed).intervals[0]
    run = stepped(case)
    time, slip = run.history["time_s"], run.history["slip_m"]
    settled = slip[time >= exact.end + AFTER_THE_STOP]
    reached = float(time[np.argmax(np.abs(slip - settled[0]) < 1e-3 * abs(exact.stroke))])
    stroke = 1e3 * exact.stroke
    return [
        near("jerk: slip [mm]", 1e3 * settled[0], stroke, ACCURACY * abs(stroke), ".3f"),
        Figure("jerk: 99.9 % of the slip reached at [s]", f"{reached:.3f}", f"stops at {exact.end:.4f}"),
        at_most("jerk: creep from the stop to 3 s [mm]", 1e3 * float(np.ptp(settled)), CREEP, ".1e"),
        run.ledger,
        Figure("jerk: CPU s per simulated s", f"{run.cpu_s / JERK_DURATION:.2f}"),
    ]


def main() -> int:
    figures = rocking("adaptive", "auto", ADAPTIVE) + rocking("steps <= 1 ms", FINE_STEP, FINE) + jerk()
    return report("full model, elastic box, 966 unknowns", figures)


if __name__ == "__main__":
    sys.exit(main())
