"""Contact damping ratio against apparent restitution of slender blocks: computes
fem/model/data/contact_damping_restitution.csv.

    python tests/rigs/calibrate_contact_damping.py

A homogeneous block is released at rest from half its slenderness angle. Its apparent restitution is the square
root of the ratio of the potential energies above rest at the turning points after and before the first impact:
for a rigid block on two corners and an impact without bounce, Housner's. Friction is ample. Each row is computed
with the rigid model at the default penalty and at three times it, and with the elastic solid so stiff that its
first frequency is fifteen times the contact frequency, or as near as the largest Young's modulus allows. The value of
a run that fails its energy audit is left empty, and the script ends with an error if that is a run of the rigid
model. About two minutes on one core.
"""

import csv
import math
import sys
from itertools import product
from pathlib import Path

from runs import RunFailedError, run

from contact.interface.penalty import contact_frequency
from fem.case.case import Case, case_from
from fem.model.container import Container, discretise
from fem.model.model import build_model

WIDTH = 1.1
HEIGHTS = (1.5, 2.0, 2.5, 3.0, 4.0, 5.0)  #: over the width
DAMPING_RATIOS = (0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 4.0)
#: kind of support and length of a foot over the width
SUPPORTS = (("corners", 0.0), ("feet", 0.07), ("feet", 0.14), ("feet", 0.25), ("flat", 0.5))
STIFFNESS_RATIO = 15.0  #: first elastic over contact frequency of the solid
STIFFEST = 1e13  #: largest Young's modulus of a case [Pa]
STIFFER = 3.0  #: penalty of the sensitivity column over the default
TARGET = Path(__file__).parents[2] / "fem" / "model" / "data" / "contact_damping_restitution.csv"

CASE = case_from(
    {
        "container": {"width_m": 1.1, "height_m": 1.1, "density_kg_m3": 2066.0, "section": "solid"},
        "contact": {"mu_static": 2.0},
        "motion": {"kind": "none"},
        "solver": {"step_s": 1e-4},
        "output": {"history_s": 0.1, "fields_s": 0.0},
    }
)
HEADER = """\
# Apparent restitution of homogeneous blocks, by contact damping ratio c/(2 sqrt(k m)), support and slenderness.
# Made by tests/rigs/calibrate_contact_damping.py; all values computed by this program (no measurement).
# Released at rest from half the slenderness angle, friction 2, steps of at most 0.1 ms, peaks before and after the
# first impact: restitution = sqrt(potential energy above rest after / before). housner: 1 - 1.5 sin^2(slenderness
# angle). rigid: rigid model, default penalty; rigid_stiffer_contact: three times that penalty; solid: elastic,
# first elastic over contact frequency = solid_frequency_ratio. Empty: the run did not pass its energy audit.
"""


def case_of(kind: str, foot: float, slenderness: float, model: str) -> Case:
    """A block of that height over width, released from half its slenderness angle."""
    radius = 0.5 * WIDTH * math.hypot(1.0, slenderness)
    values = {
        "container.height_m": slenderness * WIDTH,
        "support.kind": kind,
        "support.foot_m": foot * WIDTH if kind == "feet" else 0.15,
        "initial.rotation_rad": 0.5 * math.atan(1.0 / slenderness),
        "solver.model": model,
        # the second peak comes after 2 to 3.5 times 1/p
        "solver.duration_s": 5.0 / math.sqrt(0.75 * 9.81 / radius),
    }
    return CASE.with_values(values)


def measured(case: Case, container: Container, damping_ratio: float, stiffer: float = 1.0) -> str:
    """Restitution of the first impact by the peaks around it; empty where a run fails its audit."""
    try:
        value = run(case, {"contact.damping_ratio": damping_ratio}, container, stiffer).restitution
    except RunFailedError:
        return ""
    return f"{value:.4f}" if math.isfinite(value) else ""


def rows_of(kind: str, foot: float, slenderness: float) -> list[dict[str, str]]:
    """Rows of one support and slenderness, over the damping ratios.

    The elastic block is so stiff that f1/f_c is STIFFNESS_RATIO if possible.
    """
    rigid_case = case_of(kind, foot, slenderness, "rigid")
    rigid = discretise(rigid_case)
    case = case_of(kind, foot, slenderness, "reduced")
    model, given = build_model(case), case.container.youngs_modulus_Pa
    ratio = model.spectra[0][0] / contact_frequency(model.container.mesh.mass, model.base_stiffness)
    modulus = min(given * (STIFFNESS_RATIO / ratio) ** 2, STIFFEST)
    chosen = {"container.youngs_modulus_Pa": modulus, "contact.normal_penalty_Pa_m": model.penalty}
    solid_case = case.with_values(chosen)
    solid, ratio = discretise(solid_case), ratio * math.sqrt(modulus / given)
    housner = build_model(rigid_case, rigid).static.housner_restitution
    return [
        {
            "support": kind,
            "foot_over_width": f"{foot:g}",
            "height_over_width": f"{slenderness:g}",
            "contact_damping_ratio": f"{damping_ratio:g}",
            "housner": f"{housner:.4f}",
            "rigid": measured(rigid_case, rigid, damping_ratio),
            "rigid_stiffer_contact": measured(rigid_case, rigid, damping_ratio, STIFFER),
            "solid": measured(solid_case, solid, damping_ratio),
            "solid_frequency_ratio": f"{ratio:.1f}",
        }
        for damping_ratio in DAMPING_RATIOS
    ]


def main() -> int:
    """Compute the table; 1 if a value of the rigid model is missing."""
    rows = []
    for (kind, foot), slenderness in product(SUPPORTS, HEIGHTS):
        rows += rows_of(kind, foot, slenderness)
        print(*rows[-1].values(), sep="\t", flush=True)
    with TARGET.open("w", encoding="utf-8", newline="") as file:
        file.write(HEADER)
        table = csv.DictWriter(file, rows[0], lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    gaps = [row for row in rows if not row["rigid"]]
    for row in gaps:
        print("no value:", *row.values(), file=sys.stderr)
    return 1 if gaps else 0


if __name__ == "__main__":
    sys.exit(main())
