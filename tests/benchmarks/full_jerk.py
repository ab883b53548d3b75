"""A floor that starts with a jerk under the elastic box: how far it slides, and whether it then stays put.

x = 0.05 m sin(6.93 t) with the box at rest at t = 0 and mu = 0.4/0.4: the floor leaves with 0.3465 m/s, the box is
dragged along, slides 13.80 mm within 76 ms and sticks from then on, for the floor's 2.40 m/s2 stay below
stiction. Reference: the event-driven rigid slider, set-valued Coulomb friction without creep.
"""

import sys

import numpy as np
from measuring import BENCHMARK_BOX, Figure, report, stepped

from contact.reference.floor_acceleration import sine_floor
from contact.reference.sliding import RigidSlider, simulate_sliding
from fem.case.case import load_case

AMPLITUDE, ANGULAR_FREQUENCY, FRICTION, DURATION = 0.05, 6.93, 0.4, 3.0
ACCURACY = 5e-3  # of the slip
CREEP = 5e-5  # m, from the stop to the end
AFTER_THE_STOP = 0.025  # s until the elastic stick has stopped ringing

CASE = load_case(
    "free_rocking",
    [
        *BENCHMARK_BOX,
        "initial.rotation_rad=0.0",
        f"contact.mu_static={FRICTION}",
        f"contact.mu_kinetic={FRICTION}",
        "motion.kind=harmonic",
        f"motion.amplitude_m={AMPLITUDE}",
        f"motion.angular_frequency_rad_s={ANGULAR_FREQUENCY}",
        "motion.start=rest",
        f"solver.duration_s={DURATION}",
        "output.history_s=0.001",
    ],
)


def main() -> int:
    slider = RigidSlider(mu_static=FRICTION, mu_kinetic=FRICTION, gravity=CASE.gravity_m_s2)
    exact = simulate_sliding(
        slider,
        sine_floor(amplitude=AMPLITUDE, angular_frequency=ANGULAR_FREQUENCY),
        duration=DURATION,
        slip_velocity=-AMPLITUDE * ANGULAR_FREQUENCY,
    )
    stop, stroke = exact.intervals[0].end, exact.intervals[0].stroke
    run = stepped(CASE)
    time, slip = run.history["time_s"], run.history["slip_m"]
    settled = slip[time >= stop + AFTER_THE_STOP]
    reached = float(time[np.argmax(np.abs(slip - settled[0]) < 1e-3 * abs(stroke))])
    error = float(settled[0]) / stroke - 1.0
    creep = float(np.ptp(settled))
    return report(
        "full model, elastic box on a floor that starts with a jerk",
        [
            Figure(
                "slip [mm]",
                f"{1e3 * settled[0]:.3f} ({100.0 * error:+.2f} %)",
                f"{1e3 * stroke:.3f} within {100.0 * ACCURACY:g} %",
                abs(error) <= ACCURACY,
            ),
            Figure("has slid all but a thousandth of it [s]", f"{reached:.3f}", f"stops at {stop:.4f}"),
            Figure(
                "creep from the stop to 3 s [mm]",
                f"{1e3 * creep:.1e}",
                f"<= {1e3 * CREEP:g}",
                creep <= CREEP,
            ),
            run.ledger,
            Figure("CPU s per simulated s", f"{run.cpu_s / DURATION:.2f}"),
        ],
    )


if __name__ == "__main__":
    sys.exit(main())
