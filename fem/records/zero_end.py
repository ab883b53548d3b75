"""Baseline of an acceleration that brings the floor to rest where it began.

Subtracted is the polynomial of degree 5 whose displacement fits that of the motion best (least squares over time) among
those that end with its velocity and displacement. Every polynomial is interpolated linearly between samples and
integrated as the motion is, so that both end at zero to the rounding of these sums, whatever the interval.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact.motion.samples import sampled_motion
from fem.runtime.arrays import FloatArray

#: of the acceleration subtracted: displacements of t^2 to t^7
DEGREE = 5


@dataclass(frozen=True, kw_only=True, eq=False)
class ZeroEnd:
    """The baselines of all motions with the same times."""

    times: FloatArray  #: rising, shape (n,) [s]

    def baseline(self, acceleration: FloatArray) -> FloatArray:
        """What to subtract from an acceleration (n,), shape (n,) [m/s2]."""
        (shapes, of_displacement, of_ends), length = self._fit, float(self.times[-1] - self.times[0])
        x, v, _ = sampled_motion(self.times, acceleration, "acceleration")
        ends = np.array([x[-1] / length**2, v[-1] / length])
        return np.asarray(shapes @ (of_displacement @ x + of_ends @ ends))

    @cached_property
    def _fit(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Polynomials at the samples (n, 6), and their coefficients as linear functions of displacements (6, n), and of
        displacement and velocity at the end over the length squared and the length (6, 2)."""
        times, length = self.times, float(self.times[-1] - self.times[0])
        s = (times - 0.5 * (times[0] + times[-1])) / (0.5 * length)
        shapes = np.asarray(np.polynomial.legendre.legvander(s, DEGREE), dtype=np.float64)
        integrals = [sampled_motion(times, shape, "acceleration")[:2] for shape in shapes.T]
        ends = np.array([[x[-1] / length**2, v[-1] / length] for x, v in integrals]).T
        # What meets the constraints, and of all that changes nothing about them, the best fit.
        meets, free = np.linalg.pinv(ends), np.linalg.svd(ends)[2][2:].T
        steps = np.diff(times)
        weights = np.sqrt(0.5 * (np.append(steps, 0.0) + np.append(0.0, steps)))
        moved = np.array([x for x, _ in integrals]).T * weights[:, None]
        best = free @ np.linalg.pinv(moved @ free)
        return shapes, best * weights, meets - best @ (moved @ meets)
