"""Free-free elastic modes of the container, separated exactly from its rigid motion.

The frame that floats with the modes is Tisserand's: elastic modes carry neither momentum nor, to first
order, angular momentum, so they are M-orthogonal to the two translations and the rotation. Shabana, Dynamics
of Multibody Systems (2013), chapter 5. Lanczos iteration with shift and inversion (Ericsson and Ruhe,
Mathematics of Computation 35 (1980) 1251) on the complement of the rigid modes. Rotation > 0 tilts toward +x.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import cholesky, eigh, qr, solve_triangular
from scipy.sparse import csc_array
from scipy.sparse.linalg import LinearOperator, eigsh

from fem.results.fields import FrameFormat
from fem.runtime.arrays import FloatArray
from fem.runtime.own_files import make_folder, write_atomically
from fem.solid.assembly import FiniteElements, factorised

FEW = 5  #: modes in the table and the figure of a run: one row of shapes
_DENSE_UNKNOWNS = 400  # up to here a dense solution is as fast, and gives all modes


@dataclass(frozen=True, kw_only=True, eq=False)
class ElasticModes:
    """The lowest elastic modes of a free container, by rising frequency."""

    frequencies_Hz: FloatArray  #: shape (k,) [Hz]
    shapes: FloatArray  #: shape^T M shape = 1 for each, shape (k, n, 2) [kg^-1/2]

    @property
    def angular_frequencies(self) -> FloatArray:
        """Shape (k,) [rad/s]."""
        return 2.0 * np.pi * self.frequencies_Hz


def rigid_modes(elements: FiniteElements) -> FloatArray:
    """Translations along x and z and small rotation about the centroid, M-orthonormal, shape (3, n, 2)."""
    nodal_mass = elements.nodal_mass
    arm = elements.nodes - nodal_mass @ elements.nodes / nodal_mass.sum()
    modes = np.zeros((3, *elements.nodes.shape))
    modes[0, :, 0] = modes[1, :, 1] = 1.0
    modes[2] = np.stack([arm[:, 1], -arm[:, 0]], axis=1)
    return modes / np.sqrt(_modal_masses(elements, modes))[:, None, None]


def elastic_modes(elements: FiniteElements, count: int) -> ElasticModes:
    """The `count` lowest elastic modes, at most all but the three rigid ones of the unknowns.

    The same input gives the same shapes and signs: the largest component of each shape is positive (the first of
    equals, by node).
    """
    rigid = rigid_modes(elements).reshape(3, -1)
    # K alone is singular; K + shift M is positive definite, and any shift near the first elastic mode keeps
    # both the factor well conditioned and the wanted modes apart.
    shift = _first_square_estimate(elements, rigid)
    modes = _dense_modes if elements.unknowns <= max(_DENSE_UNKNOWNS, 4 * count) else _lanczos_modes
    squares, vectors = modes(elements, rigid, shift, count)
    shapes = vectors.T.reshape(count, -1, 2)
    shapes /= np.sqrt(_modal_masses(elements, shapes))[:, None, None]
    return ElasticModes(frequencies_Hz=np.sqrt(squares) / (2.0 * np.pi), shapes=shapes * signs_of(shapes))


def elastic_mode_table(modes: ElasticModes) -> list[dict[str, float]]:
    """One row a mode for the screen: number, frequency_Hz, period_s, ratio to the first."""
    frequencies = modes.frequencies_Hz.tolist()
    return [
        {"mode": i, "frequency_Hz": f, "period_s": 1.0 / f, "ratio_to_first": f / frequencies[0]}
        for i, f in enumerate(frequencies, start=1)
    ]


def write_modes(elements: FiniteElements, modes: ElasticModes, folder: Path) -> Path:
    """Write `modes.vtu` with every shape as a point vector (x, z, 0), scaled to a largest displacement of 1 m."""
    make_folder(folder)
    names = [f"mode {i:02d} ({f:.6g} Hz)" for i, f in enumerate(modes.frequencies_Hz, start=1)]
    largest = np.linalg.norm(modes.shapes, axis=2).max(axis=1)
    file = FrameFormat(
        points=_padded(elements.nodes),
        cells=elements.cells.astype(np.int32),
        cell_data={"region": np.asarray(elements.region, dtype=np.int32)},
    )
    shapes = {n: _padded(s / a) for n, s, a in zip(names, modes.shapes, largest, strict=True)}
    path = folder / "modes.vtu"
    write_atomically(path, file.frame(shapes))
    return path


def _dense_modes(
    elements: FiniteElements, rigid: FloatArray, shift: float, count: int
) -> tuple[FloatArray, FloatArray]:
    """By inversion of K + shift M, on a basis of the rigid modes' complement, orthonormal in it."""
    mass = elements.vector_mass
    upper = cholesky((elements.stiffness + shift * mass).toarray())
    basis = solve_triangular(upper, qr(upper @ rigid.T)[0][:, 3:])
    compliance = basis.T @ (mass @ basis)
    last = len(compliance) - 1
    inverses, vectors = eigh(0.5 * (compliance + compliance.T), subset_by_index=(last + 1 - count, last))
    return 1.0 / inverses[::-1] - shift, basis @ vectors[:, ::-1]


def _lanczos_modes(
    elements: FiniteElements, rigid: FloatArray, shift: float, count: int
) -> tuple[FloatArray, FloatArray]:
    """By the same inversion, with what rounding leaves of the rigid modes removed at each."""
    mass, stiffness = elements.vector_mass, elements.stiffness
    factor = factorised(stiffness + shift * mass)

    def solve(momentum: FloatArray) -> FloatArray:
        return _without_rigid_motion(factor.solve(momentum), rigid, mass)

    # Without symmetry, so that no mode is missed.
    start = np.random.default_rng(0).standard_normal(elements.unknowns)
    squares, vectors = eigsh(
        stiffness,
        k=count,
        M=mass,
        sigma=-shift,
        OPinv=LinearOperator(stiffness.shape, matvec=solve, dtype=float),
        v0=_without_rigid_motion(start, rigid, mass),
        ncv=min(elements.unknowns, 2 * count + 20),
    )
    rising = np.argsort(squares, kind="stable")
    return squares[rising], vectors[:, rising]


def _first_square_estimate(elements: FiniteElements, rigid: FloatArray) -> float:
    """Rayleigh-Ritz over displacements of second degree: above the first angular frequency squared [1/s2]."""
    scale = np.ptp(elements.nodes, axis=0)
    x, z = ((elements.nodes - elements.nodes.mean(axis=0)) / scale).T
    trial = np.zeros((10, *elements.nodes.shape))
    for i in range(2):
        trial[5 * i : 5 * i + 5, :, i] = x, z, x * x, x * z, z * z
    mass = elements.vector_mass
    vectors = _without_rigid_motion(trial.reshape(10, -1).T, rigid, mass)
    # The ten fields are now linearly dependent (the rotation is among them): drop those without mass.
    values, directions = np.linalg.eigh(vectors.T @ (mass @ vectors))
    moving = values > 1e-8 * values[-1]
    vectors = vectors @ (directions[:, moving] / np.sqrt(values[moving]))
    return float(np.linalg.eigvalsh(vectors.T @ (elements.stiffness @ vectors))[0])


def _without_rigid_motion(vectors: FloatArray, rigid: FloatArray, mass: csc_array) -> FloatArray:
    """Remove the part of each column that has momentum or angular momentum."""
    return vectors - rigid.T @ (rigid @ (mass @ vectors))


def _modal_masses(elements: FiniteElements, shapes: FloatArray) -> FloatArray:
    return np.array([np.sum(shape * (elements.mass @ shape)) for shape in shapes])


def signs_of(shapes: FloatArray) -> FloatArray:
    """+1 or -1 for each shape, (k, 1, 1); of components that tie up to rounding the first node's counts."""
    flat = shapes.reshape(len(shapes), -1)
    size = np.abs(flat)
    first = np.argmax(size >= (1.0 - 1e-6) * size.max(axis=1, keepdims=True), axis=1)
    return np.sign(flat[np.arange(len(flat)), first])[:, None, None]


def _padded(vectors: FloatArray) -> FloatArray:
    return np.column_stack([vectors, np.zeros(len(vectors))])
