"""Free rocking of the stiff solid stack with the `full` model, against Housner's rigid block.

Released from half its slenderness angle on two corners, mu = 1, default contact damping. First impact and velocity
ratio at it; then the same at half the step and on a finer mesh. The velocity ratio is that of the peaks before
and after the impact, the square root of their potential energies. The rigid limit asks for a first elastic
frequency well above that of the bounce on the contact, which is printed; so the block is ten times as stiff as the
shipped case `free_rocking`, which is shown below it for what elasticity does at a ratio of 5.
"""

import math
import sys

from measuring import Figure, Stepped, report, stepped

from contact.interface.penalty import contact_frequency
from contact.reference.closed_forms_rocking import quarter_period
from contact.reference.rigid_block import RigidBlock
from fem.case.case import Case, load_case
from fem.solid.modes import elastic_modes

YOUNGS_MODULUS = 2.1e12  # Pa, ten times the shipped case's: f1/f_c = 16
DURATION = 1.45  # s: past the turning point that follows the first impact
TIME_ACCURACY, RATIO_ACCURACY = 5e-3, 1e-2
STACK = RigidBlock.homogeneous(width=1.1, height=4.0)


def case(**changes: object) -> Case:
    base = load_case(
        "free_rocking",
        [
            "solver.model=full",
            f"solver.duration_s={DURATION}",
            f"container.youngs_modulus_Pa={YOUNGS_MODULUS}",
        ],
    )
    return base.with_values({key.replace("__", "."): value for key, value in changes.items()})


def found(run: Stepped) -> tuple[float, float]:
    """Time of the first impact [s] and velocity ratio by the peaks around it."""
    track = run.model.run.track[0]
    return float(track.first_impact), float(track.restitution_by_peaks)


def frequency_ratio(run: Stepped) -> float:
    """First elastic frequency over that of the bounce on the contact."""
    first = float(elastic_modes(run.model.container.elements, 1).angular_frequencies[0])
    return first / (
        2.0 * math.pi * contact_frequency(run.model.container.mesh.mass, run.model.base_stiffness)
    )


def main() -> int:
    exact_time = quarter_period(STACK, 0.5 * STACK.slenderness_angle)
    exact_ratio = STACK.housner_restitution
    plain = stepped(case())
    step, penalty = plain.model.run.control.largest_step, plain.model.penalty
    variants = {
        "as it comes": plain,
        "half the step": stepped(case(solver__step_s=0.5 * step)),
        "finer mesh": stepped(case(solver__element_size_m=0.05, contact__normal_penalty_Pa_m=penalty)),
    }
    ratio = frequency_ratio(plain)
    figures = [Figure("first elastic frequency over contact frequency", f"{ratio:.2f}", "> 7", ratio > 7.0)]
    first_time, first_ratio = found(plain)
    for name, run in variants.items():
        time, ratio = found(run)
        figures += [
            Figure(
                f"{name}: first impact [s]",
                f"{time:.6f} (change {time - first_time:+.1e})",
                f"{exact_time:.6f} within {100.0 * TIME_ACCURACY:g} %",
                abs(time / exact_time - 1.0) <= TIME_ACCURACY,
            ),
            Figure(
                f"{name}: velocity ratio",
                f"{ratio:.4f} (change {ratio - first_ratio:+.1e})",
                f"{exact_ratio:.4f} within {RATIO_ACCURACY:g}",
                abs(ratio - exact_ratio) <= RATIO_ACCURACY,
            ),
            Figure(
                f"{name}: unknowns, steps, CPU s",
                f"{int(run.model.run.old.position.size)}, {run.steps}, {run.cpu_s:.1f}",
            ),
            run.ledger,
        ]
    soft = stepped(case(container__youngs_modulus_Pa=2.1e11))
    time, ratio = found(soft)
    figures.append(
        Figure(
            f"E = 2.1e11 Pa, f1/f_c = {frequency_ratio(soft):.2f}: first impact [s], velocity ratio",
            f"{time:.6f}, {ratio:.4f}",
        )
    )
    return report("full model, free rocking of the solid stack", figures)


if __name__ == "__main__":
    sys.exit(main())
