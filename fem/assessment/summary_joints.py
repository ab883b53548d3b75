"""The joints between the boxes of a stack, as a table for the end of a run."""

from collections.abc import Sequence

from rich.box import SIMPLE
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from fem.results.run_result import JointDemand

MOST_JOINTS = 8  #: shown; of more, those that something is largest in
JOINTS_NOTE = (
    "The boxes are bolted and move as one; these are the forces in their joints (means over output.history_s): "
    "what the bolts along one edge must carry in tension, and beside the friction of the floor in shear; and when "
    "a joint without bolts would open at an edge or slide."
)
LEAST_N = 1e-6  #: smaller forces and moments are rounding
LARGEST = ("max_shear_N", "max_moment_Nm", "bolt_tension_left_N", "bolt_tension_right_N", "bolt_shear_N")


def joint_table(joints: Sequence[JointDemand]) -> RenderableType:
    """One row a joint, from the floor up.

    Args:
        joints: the `joints` of a result.
    """
    table = Table(title="Joints between boxes", title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0))
    table.add_column("joint at")
    for name in ("normal kN", "shear kN", "moment kNm", "bolts l, r kN", "bolt shear kN", "mu needed"):
        table.add_column(name, justify="right")
    table.add_column("unbolted, it")
    for joint in _shown(joints):
        table.add_row(
            f"{joint.height_m:.4g} m",
            f"{_kilo(joint.min_normal_N)} .. {_kilo(joint.max_normal_N)}",
            _kilo(joint.max_shear_N),
            _kilo(joint.max_moment_Nm),
            f"{_kilo(joint.bolt_tension_left_N)}, {_kilo(joint.bolt_tension_right_N)}",
            _kilo(joint.bolt_shear_N),
            "no mu" if joint.friction_needed is None else f"{joint.friction_needed:.3g}",
            _unbolted(joint),
        )
    left_out = len(joints) - table.row_count
    rest = f" {left_out} more joints are in run.json." if left_out else ""
    return Group(table, Text(JOINTS_NOTE + rest), Text())


def _shown(joints: Sequence[JointDemand]) -> Sequence[JointDemand]:
    if len(joints) <= MOST_JOINTS:
        return joints
    chosen = {max(range(len(joints)), key=lambda j: getattr(joints[j], key)) for key in LARGEST}
    return [joints[j] for j in sorted(chosen)]


def _unbolted(joint: JointDemand) -> str:
    opens, slides = joint.opens_at_s, joint.slides_at_s
    found = [
        f"{verb} at {instant:.3g} s"
        for verb, instant in (("opens", opens), ("slides", slides))
        if instant is not None
    ]
    return ", ".join(found) or "stays closed, stuck"


def _kilo(value: float) -> str:
    return f"{1e-3 * value:.4g}" if abs(value) >= LEAST_N else "0"
