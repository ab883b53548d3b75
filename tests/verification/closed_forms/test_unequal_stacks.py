"""Bolted stacks of boxes that differ: statics by hand, modes against meshes that are made otherwise."""

import math

import numpy as np
import pytest
from cases import LEAST

from contact.stepping.modes import ROCKING
from fem.case.case import Case, read_case
from fem.model.geometry import build_container
from fem.model.model import build_model
from fem.model.motion import build_motions, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.solid.assembly import assemble
from fem.solid.modes import elastic_modes
from mesh.container import ContainerMesh
from mesh.elevation import Elevation

BOX = "[[container.box]]\n"
LIGHT = f"{BOX}mass_kg = 4000.0\n{BOX}width_m = 0.8\nheight_m = 0.6\nmass_kg = 800.0\noffset_m = 0.1\n"


def stack(boxes: str = LIGHT, motion: str = 'kind = "none"', more: str = "") -> Case:
    text = LEAST.replace("[contact]", f"youngs_modulus_Pa = 1e9\n{boxes}[contact]") + more
    return read_case(text.replace('kind = "none"', motion).replace("mu_static = 0.4", "mu_static = 2.0"))


def test_static_checks_are_those_of_the_nearer_corner():
    case = stack()
    static = static_checks_of(case, build_container(case), *peaks_in_run(case, *build_motions(case)))
    mass, x = 4800.0, 800.0 * 0.1 / 4800.0
    z = (4000.0 * 0.5 + 800.0 * 1.3) / mass
    nearer, farther = 0.55 - x, 0.55 + x
    inertia = sum(
        m * ((w**2 + h**2) / 12.0 + (bx - x) ** 2 + (bz - z) ** 2)
        for m, w, h, bx, bz in ((4000.0, 1.1, 1.0, 0.0, 0.5), (800.0, 0.8, 0.6, 0.1, 1.3))
    )
    about = inertia + mass * (nearer**2 + z**2)
    assert static.slenderness_angle == pytest.approx(math.atan2(nearer, z))
    assert static.uplift_acceleration == pytest.approx(9.81 * nearer / z)
    assert static.restoring_moment == pytest.approx(mass * 9.81 * nearer)
    assert static.frequency_parameter == pytest.approx(math.sqrt(mass * 9.81 * math.hypot(nearer, z) / about))
    # A plastic impact of the nearer corner, after a turn about the farther one: angular momentum about it is kept.
    kept = inertia + mass * (z**2 - nearer * farther)
    assert static.housner_restitution == pytest.approx(kept / about)


@pytest.mark.parametrize(("sign", "arm"), [(-1.0, 0.55 - 0.1 / 6.0), (1.0, 0.55 + 0.1 / 6.0)])
@pytest.mark.parametrize("share", [0.98, 1.02])
def test_each_corner_lifts_at_its_own_acceleration(sign, arm, share):
    # A floor that accelerates to the left tilts the stack to the right, about the nearer corner.
    z = (4000.0 * 0.5 + 800.0 * 1.3) / 4800.0
    peak = share * sign * 9.81 * arm / z
    motion = f'kind = "pulse"\nshape = "rectangular"\npeak_acceleration_m_s2 = {peak!r}\npulse_s = 1.0'
    more = '[solver]\nmodel = "rigid"\nduration_s = 1.0\n[output]\nfields_s = 0.0\n'
    model = build_model(stack(motion=motion, more=more))
    simulate(model, Recorder(model))
    rotation = float(model.run.old.pose[0])
    rocks = abs(rotation) > ROCKING * model.static.slenderness_angle
    assert rocks is (share > 1.0)
    if rocks:
        assert rotation * sign < 0.0


def frequencies(mesh: ContainerMesh, count: int = 5) -> np.ndarray:
    elements = assemble(mesh, youngs_modulus=1e9, poisson_ratio=0.3, order=2)
    return elastic_modes(elements, count).frequencies_Hz


def test_modes_are_those_of_the_same_shape_meshed_as_one():
    # Box 2 stands on the right part of box 1; the cells of a uniform grid of 0.1 m that lie in either.
    case = stack(f"{BOX}width_m = 1.0\n{BOX}width_m = 0.6\nheight_m = 0.5\noffset_m = 0.1\n")
    mesh = build_container(case)
    column, row = np.meshgrid(np.arange(10), np.arange(15))
    inside = (row < 10) | ((column >= 3) & (column < 9))
    first = (row * 11 + column)[inside]
    x, z = np.meshgrid(-0.5 + 0.1 * np.arange(11), 0.1 * np.arange(16))
    used, quads = np.unique(np.column_stack([first, first + 1, first + 12, first + 11]), return_inverse=True)
    masses = np.where(row < 10, 2500.0 / 1.0, 2500.0 / 0.3)[inside]
    other = ContainerMesh(
        elevation=Elevation(np.column_stack([x.ravel(), z.ravel()])[used], quads.reshape(-1, 4)),
        region=np.full(len(first), 3),
        box=np.where(row < 10, 0, 1)[inside],
        thickness=np.full(len(first), 1.1),
        areal_density=masses,
    )
    assert len(mesh.quads) == len(other.quads)
    assert frequencies(mesh) == pytest.approx(frequencies(other), rel=1e-8)
