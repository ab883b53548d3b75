"""What a rocking elastic box costs with the `full` model, on the problem that general codes were measured on.

A solid box of 22 x 20 bilinear quads (966 unknowns, E = 2.1e9 Pa, mu = 1), released from a quarter of its
slenderness angle and followed through its impacts. General finite-element codes need 10 to 25 CPU seconds per
simulated second of it with small strain, 60 to 95 with finite rotation. The box is so soft against its floor (first
elastic frequency 2.4 times the contact's) that it rebounds like a bar from a wall: Housner's ratio is printed to show
how far from rigid it is, not as a target.
"""

import math
import sys

from measuring import BENCHMARK_BOX, Figure, Stepped, median_of, report, stepped

from contact.reference.closed_forms_rocking import quarter_period
from contact.reference.rigid_block import RigidBlock
from fem.case.case import Case, load_case

REPEATS = 3
DURATION = 1.0  # s: the first impact at 0.26 s, then the small ones that follow at a restitution of 0.18
ADAPTIVE, FINE = 2.0, 5.0  # CPU seconds per simulated second
FINE_STEP = 1e-3
BLOCK = RigidBlock.homogeneous(width=1.1, height=1.0)


def box(step: float | str) -> Case:
    return load_case(
        "free_rocking",
        [
            *BENCHMARK_BOX,
            f"initial.rotation_rad={0.25 * math.atan2(1.1, 1.0)!r}",
            f"solver.duration_s={DURATION}",
            f"solver.step_s={step}",
        ],
    )


def measured(step: float | str) -> tuple[float, Stepped]:
    """CPU seconds per simulated second, the median, and one of the runs."""
    runs: list[Stepped] = []

    def once() -> float:
        runs.append(stepped(box(step)))
        return runs[-1].cpu_s / DURATION

    return median_of(REPEATS, once), runs[-1]


def main() -> int:
    figures = []
    for name, step, limit in (("adaptive", "auto", ADAPTIVE), ("steps <= 1 ms", FINE_STEP, FINE)):
        cost, run = measured(step)
        track, clock = run.model.run.track[0], run.model.run.clock[0]
        ratio = float(track.restitution_by_velocity)
        found = f"{ratio:.4f}" if math.isfinite(ratio) else "none, it rebounds"
        unknowns = int(run.model.run.old.position.size)
        figures += [
            Figure(f"{name}: CPU s per simulated s", f"{cost:.2f}", f"<= {limit:g}", cost <= limit),
            Figure(
                f"{name}: steps, rejected, residuals a step",
                f"{run.steps}, {int(clock.rejected)}, {clock.iterations / max(run.steps, 1):.2f}",
            ),
            run.ledger,
            Figure(
                f"{name}: first impact [s], velocity ratio, impacts",
                f"{track.first_impact:.4f}, {found}, {int(track.impacts)}",
                f"rigid block: {quarter_period(BLOCK, 0.25 * BLOCK.slenderness_angle):.4f}, "
                f"{BLOCK.housner_restitution:.4f}",
            ),
        ]
    return report(f"full model, elastic box, {unknowns} unknowns", figures)


if __name__ == "__main__":
    sys.exit(main())
