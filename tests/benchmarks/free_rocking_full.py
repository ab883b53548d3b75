"""Free rocking of the stiff solid stack with the `full` model, against Housner's rigid block.

Released from half its slenderness angle on two corners, mu = 1, default contact damping. First impact and velocity
ratio there; then the same at half the step and on a finer mesh. The velocity ratio is that of the peaks before
and after the impact, the square root of their potential energies. The rigid limit requires a first elastic
frequency well above the bounce frequency of the contact, which is printed; the block is therefore ten times as stiff
as the shipped case `free_rocking`, which follows at the end to show the effect of elasticity at a ratio of 5.
"""

import math
import sys

from measuring import Figure, Stepped, near, report, stepped

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
    """First elastic frequency over the bounce frequency of the contact."""
    first = float(elastic_modes(run.model.container.elements, 1).angular_frequencies[0])
    bounce = contact_frequency(run.model.container.mesh.mass, run.model.base_stiffness)
    return first / (2.0 * math.pi * bounce)


def main() -> int:
    time, ratio = quarter_period(STACK, 0.5 * STACK.slenderness_angle), STACK.housner_restitution
    plain = stepped(case())
    step, penalty = plain.model.run.control.largest_step, plain.model.penalty
    variants = {
        "default": plain,
        "half the step": stepped(case(solver__step_s=0.5 * step)),
        "finer mesh": stepped(case(solver__element_size_m=0.05, contact__normal_penalty_Pa_m=penalty)),
    }
    stiffness = frequency_ratio(plain)
    figures = [
        Figure("first elastic frequency over contact frequency", f"{stiffness:.2f}", "> 7", stiffness > 7.0)
    ]
    first_time, first_ratio = found(plain)
    for name, run in variants.items():
        impact, loss = found(run)
        change = f" (change {impact - first_time:+.1e})"
        figures += [
            near(f"{name}: first impact [s]", impact, time, TIME_ACCURACY * time, ".6f", details=change),
            near(
                f"{name}: velocity ratio",
                loss,
                ratio,
                RATIO_ACCURACY,
                details=f" (change {loss - first_ratio:+.1e})",
            ),
            Figure(
                f"{name}: unknowns, steps, CPU s",
                f"{int(run.model.run.old.position.size)}, {run.steps}, {run.cpu_s:.1f}",
            ),
            run.ledger,
        ]
    soft = stepped(case(container__youngs_modulus_Pa=2.1e11))
    impact, loss = found(soft)
    name = f"E = 2.1e11 Pa, f1/f_c = {frequency_ratio(soft):.2f}: first impact [s], velocity ratio"
    figures.append(Figure(name, f"{impact:.6f}, {loss:.4f}"))
    return report("full model, free rocking of the solid stack", figures)


if __name__ == "__main__":
    sys.exit(main())
