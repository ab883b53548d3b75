"""What the joints between the boxes of a stack must carry, and what they would do without bolts.

The bolts along an edge must carry its tension all together, and more where they sit further in. Forces are means over
`output.history_s` (`fem.model.joints`).
"""

import numpy as np
from numpy.typing import NDArray

from fem.case.columns import JOINTS
from fem.case.tables.boxes import shared_face
from fem.model.model import Model
from fem.results.history import History
from fem.results.run_result import JointDemand
from fem.runtime.arrays import FloatArray


def edge_forces(
    normal: FloatArray, moment: FloatArray, width: float | FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Compression at the left and the right edge of a joint of rigid faces [N]; negative: tension."""
    return 0.5 * normal + moment / width, 0.5 * normal - moment / width


def joint_demands(model: Model, history: History) -> tuple[JointDemand, ...] | None:
    """The demands on all joints, from the floor up; None for a single box, or if nothing was sampled.

    Of a container that overturned, until 90 degrees.
    """
    standing = history["time_s"] <= model.run.track[0].overturned_at
    if history.joints == 0 or not standing.any():
        return None
    return tuple(_demands_of(model, history, joint, standing) for joint in range(1, history.joints + 1))


def _demands_of(model: Model, history: History, joint: int, standing: NDArray[np.bool_]) -> JointDemand:
    lower, upper = model.case.stack[joint - 1 : joint + 1]
    start, end = shared_face(lower, upper)
    width, mu = end - start, model.case.contact.mu_static
    time = history["time_s"][standing]
    normal, shear, moment = (history[name][standing] for name in JOINTS.names((joint,)))
    left, right = edge_forces(normal, moment, width)
    tension = max(0.0, -float(left.min())), max(0.0, -float(right.min()))
    capacity = model.case.joints.bolt_capacity_N
    carried = mu * np.maximum(normal, 0.0)
    return JointDemand(
        joint=joint,
        height_m=upper.bottom,
        min_normal_N=float(normal.min()),
        max_normal_N=float(normal.max()),
        max_shear_N=float(np.abs(shear).max()),
        max_moment_Nm=float(np.abs(moment).max()),
        bolt_tension_left_N=tension[0],
        bolt_tension_right_N=tension[1],
        bolt_utilisation=None if capacity is None else max(tension) / capacity,
        bolt_shear_N=max(0.0, float((np.abs(shear) - carried).max())),
        friction_needed=_friction_needed(normal, shear),
        partly_opens_at_s=_first(time, np.abs(moment) > normal * width / 6.0),
        opens_at_s=_first(time, np.minimum(left, right) < 0.0),
        slides_at_s=_first(time, np.abs(shear) > carried),
    )


def _friction_needed(normal: FloatArray, shear: FloatArray) -> float | None:
    """Least coefficient of friction at which the joint never slides; None if there is shear without compression."""
    sheared = shear != 0.0
    if np.any(normal[sheared] <= 0.0):
        return None
    return float(np.max(np.abs(shear[sheared]) / normal[sheared], initial=0.0))


def _first(time: FloatArray, happens: NDArray[np.bool_]) -> float | None:
    """Time of the first sample at which it happens [s]."""
    return float(time[np.argmax(happens)]) if happens.any() else None
