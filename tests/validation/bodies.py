"""Bodies with the mass properties of a specimen, and halves of a series of tests to fit on and to predict."""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np
from meshes import grid_mesh
from runs import STACK

from fem.case.case import Case
from fem.model.container import Container, discretise
from mesh.errors import MeshError

ROUGH = 2.0  #: friction with which no specimen slides
LAYERS = 3  #: of one density each; as many as there are conditions

TestT = TypeVar("TestT")
FitT = TypeVar("FitT")


def rigid_case(
    *,
    width: float,
    height: float,
    element_size: float,
    **changes: float | str | list[float] | list[dict[str, float]],
) -> Case:
    """A rigid block as deep as it is wide, on two corners, which does not slide; `__` in place of the dot of a key."""
    keys = {
        "container.width_m": width,
        "container.depth_m": width,
        "container.height_m": height,
        "contact.mu_static": ROUGH,
        "solver.element_size_m": element_size,
    }
    return STACK.with_values(keys | {key.replace("__", "."): value for key, value in changes.items()})


def specimen(case: Case, *, centroid: float, inertia_ratio: float, columns: int = 1) -> Container:
    """The rigid container of a case, of three horizontal layers with shares of its mass, and so many elements across.

    `centroid`: height of the mass centre above the base [m]; `inertia_ratio`: moment of inertia about it over the mass
    [m2].
    """
    width, height, mass = case.container.width_m, case.container.height_m, case.box_mass
    levels, layer = np.linspace(0.0, height, LAYERS + 1), height / LAYERS
    middle = 0.5 * (levels[1:] + levels[:-1])
    about_centroid = (middle - centroid) ** 2 + (layer**2 + width**2) / 12.0
    conditions = np.stack([np.ones(LAYERS), middle, about_centroid])
    shares = np.asarray(np.linalg.solve(conditions, [1.0, centroid, inertia_ratio]), dtype=np.float64)
    if shares.min() < 0.0:
        raise MeshError(
            f"no body of {width:g} x {height:g} m has its mass centre at {centroid:g} m and an inertia of "
            f"{inertia_ratio:g} m2 times its mass"
        )
    across = np.linspace(-0.5 * width, 0.5 * width, columns + 1)
    density = np.repeat(mass * shares / (width * layer), columns)
    return discretise(case, grid_mesh(across, levels, depth=case.container.depth_m, areal_density=density))


def cross_validated(
    tests: Sequence[TestT], fit: Callable[[Sequence[TestT]], FitT]
) -> list[tuple[FitT, Sequence[TestT]]]:
    """Fit on the tests of odd rank to predict those of even rank, and vice versa: fits with the tests to predict."""
    odd, even = tests[0::2], tests[1::2]
    return [(fit(odd), even), (fit(even), odd)]
