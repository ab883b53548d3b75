"""What the joints of a stack must carry, as tables of a summary."""

from collections.abc import Iterator, Sequence
from functools import partial

from rich.box import SIMPLE
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from fem.assessment.ranges import crushes, impact_note
from fem.results.run_result import JointDemand, Verdict
from fem.runtime.units import visible_number

MOST_JOINTS = 8  #: joints shown; of more, those with a largest value
JOINTS_NOTE = (
    "The boxes are bolted and move as one. The table gives the forces in their joints (means over the interval "
    "of the history), the tension in the bolts along one edge, the shear in the bolts beyond static friction as on the "
    "floor, and when a joint without bolts would open at an edge or slide."
)
OVERSTATED = (
    "Where impacts are elastic, means over them overstate the friction needed, the forces in the bolts, and how often "
    "joints without bolts would open or slide."
)
LOOSE_RUN = "A run of the stack with loose joints finds what boxes without bolts do."
LARGEST = ("max_shear_N", "max_moment_Nm", "bolt_tension_left_N", "bolt_tension_right_N", "bolt_shear_N")


def joints_note(verdict: Verdict) -> str:
    """How to read the joints of a bolted stack, whose table is only an estimate of what loose boxes do."""
    return " ".join(
        [JOINTS_NOTE, *([OVERSTATED] if verdict.impacts and not crushes(verdict) else []), LOOSE_RUN]
    )


def titled_table(title: str, *columns: str) -> Table:
    """An empty table; the numbers of a column that begins with > are aligned at the right."""
    table = Table(
        title=title, title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0), show_header=any(columns)
    )
    for name in columns:
        table.add_column(name.removeprefix(">"), justify="right" if name.startswith(">") else "left")
    return table


def joint_tables(every: Sequence[JointDemand], verdict: Verdict) -> Iterator[RenderableType]:
    """Forces, and what bolts carry; one row a joint, from the floor up."""
    note, kilo = impact_note(verdict), partial(visible_number, factor=1e-3)
    forces = titled_table(
        f"Forces in the joints between boxes{note}", "joint at", ">normal kN", ">shear kN", ">moment kNm"
    )
    bolts = titled_table(
        f"Bolts{note}", "joint at", ">tension left, right kN", ">shear kN", ">mu needed", "without bolts it"
    )
    joints = _shown(every)
    for joint in joints:
        place, normal = f"{joint.height_m:.4g} m", (joint.min_normal_N, joint.max_normal_N)
        tension = (joint.bolt_tension_left_N, joint.bolt_tension_right_N)
        used = "" if joint.bolt_utilisation is None else f" ({joint.bolt_utilisation:.2g})"
        needed = "no mu" if joint.friction_needed is None else f"{joint.friction_needed:.3g}"
        forces.add_row(
            place, " .. ".join(map(kilo, normal)), kilo(joint.max_shear_N), kilo(joint.max_moment_Nm)
        )
        bolts.add_row(
            place, ", ".join(map(kilo, tension)) + used, kilo(joint.bolt_shear_N), needed, unbolted(joint)
        )
    yield from (forces, bolts)
    if any(joint.bolt_utilisation is not None for joint in joints):
        yield Text("In parentheses: the larger tension over the capacity of a bolt.\n")
    left_out = len(every) - len(joints)
    yield Text(
        joints_note(verdict) + (f" {left_out} more joints are in run.json." if left_out else "") + "\n"
    )


def _shown(joints: Sequence[JointDemand]) -> Sequence[JointDemand]:
    if len(joints) <= MOST_JOINTS:
        return joints
    chosen = {max(range(len(joints)), key=lambda j: getattr(joints[j], key)) for key in LARGEST}
    return [joints[j] for j in sorted(chosen)]


def unbolted(joint: JointDemand) -> str:
    """What the joint would do without bolts."""
    events = (("opens", joint.opens_at_s), ("slides", joint.slides_at_s))
    instants = [f"{verb} at {instant:.3g} s" for verb, instant in events if instant is not None]
    return ", ".join(instants) or "stays closed, sticks"
