"""What ties the keys of one table together: [container], [contact] and [solver]."""

from typing import Any

from fem.case.tables import quantities as q
from fem.case.tables.problem import Rule, file_beside


def _smallest(box: Any) -> float:
    """Smallest outer dimension of a box [m]."""
    return float(min(box.width_m, box.height_m, box.depth_m))


#: keys of which one gives the mass of a box, and their quantities
MASSES = {"weight_N": q.WEIGHT, "mass_kg": q.MASS, "density_kg_m3": q.DENSITY}


def _masses(box: Any) -> dict[str, float]:
    """The keys of `MASSES` that are given."""
    return {key: value for key in MASSES if (value := getattr(box, key)) is not None}


def _not_one_mass(box: Any) -> str:
    given = [f"{key} = {value:g} {MASSES[key].unit}" for key, value in _masses(box).items()]
    rule = ", mass_kg, density_kg_m3: exactly one of the three must be given, "
    return rule + (f"got {', '.join(given)}; keep one of them" if given else "none is given")


CONTAINER_RULES = (
    Rule(
        "container.weight_N",
        lambda box: (
            len(_masses(box)) == 1
            or not (_masses(box) or box.box is None or any(own.mass_kg is None for own in box.box))
        ),
        _not_one_mass,
    ),
    Rule(
        "container.wall_m",
        lambda box: box.section == "solid" or box.wall_m is not None or box.box is not None,
        'is missing: section = "shell" needs the wall thickness, in m',
    ),
    Rule(
        "container.wall_m",
        lambda box: box.section == "solid" or box.wall_m is None or 2.0 * box.wall_m < _smallest(box),
        lambda box: (
            f"must be less than half the smallest outer dimension, {_smallest(box):g} m, got {box.wall_m:g} m; "
            + (
                q.WALL.guess(box.wall_m, lambda meant: 2.0 * meant < _smallest(box))
                or 'for a full block take section = "solid"'
            )
        ),
    ),
    # The range that the program has been tried on: neither a needle nor a plate.
    Rule(
        "container.width_m",
        lambda box: 0.02 * (1.0 - 1e-9) <= box.width_m / box.height_m <= 20.0 * (1.0 + 1e-9),
        lambda box: (
            f"over height_m must lie between 0.02 and 20, got {box.width_m:g} m / {box.height_m:g} m = "
            f"{box.width_m / box.height_m:g}; are both in metres?"
        ),
    ),
    Rule(
        "container.centroid_m",
        lambda box: box.centroid_m < box.height_m,
        lambda box: (
            f"must be less than height_m = {box.height_m:g} m, got {box.centroid_m:g} m; "
            + (
                q.LENGTH.guess(box.centroid_m, lambda meant: 0.1 * box.height_m < meant < box.height_m)
                or "it is measured from the bottom of one box"
            )
        ),
    ),
    file_beside("container.mesh_file", below=False),
)

CONTACT_RULES = (
    Rule(
        "contact.mu_kinetic",
        lambda contact: contact.mu_kinetic <= contact.mu_static,
        "must be at most mu_static = {mu_static:g}, got {mu_kinetic:g}; leave it out where the two are equal",
    ),
)

SOLVER_RULES = (
    # 2 beta >= gamma >= 1/2: stable for every step (Hughes, The Finite Element Method, 1987, 9.1.2).
    Rule(
        "solver.newmark_beta",
        lambda solver: solver.scheme != "newmark" or 2.0 * solver.newmark_beta >= solver.newmark_gamma,
        lambda solver: (
            f"must be at least newmark_gamma/2 = {solver.newmark_gamma / 2.0:g} to be stable at every step, "
            f"got {solver.newmark_beta:g}; 1/4 and 1/2 are usual"
        ),
    ),
)
