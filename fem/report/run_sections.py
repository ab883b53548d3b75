"""The sections of the page of a run behind its first sheet: how sure it is, and what it is compared with."""

from collections.abc import Mapping, Sequence
from functools import partial

from contact.reference.event_driven import EventError
from fem.assessment.joint_tables import joints_note, unbolted
from fem.assessment.loose_boxes import BOXES_NOTE
from fem.assessment.ranges import impact_note
from fem.assessment.rigid_check import check_against_rigid_block
from fem.assessment.summary import band_note
from fem.html import sections as html
from fem.html.units import number, quantity, short
from fem.model.model import Model
from fem.report.run_view import RunView
from fem.report.static_sheet import SheetLine, static_sheet
from fem.results.history import History
from fem.results.kinds import RUN
from fem.results.reader import OpenedRun
from fem.results.run_result import JointDemand, RigidCheckResult
from fem.solid.modes import FEW, elastic_mode_table

NOT_WORSE = (
    "A stronger motion is not always worse: the container may stand under a motion that is stronger than one that "
    "overturns it."
)
DEGREES = 57.29577951308232  #: in a radian


def boxes_section(view: RunView) -> html.PageSection:
    """What each box of a loose stack did."""
    if not view.boxes:
        return html.section("", "boxes")
    heads = ("largest rotation [°]", "largest slip [mm]", "slip left [mm]", "largest opening [mm]")
    columns: list[html.Column[Sequence[str]]] = [
        *html.in_order("box", *heads, look=html.NUMBER),
        html.Column("fell", lambda row: html.Cell(row[5] or "no", "fail" if row[5] else "")),
    ]
    return html.section(
        "Boxes of the loose stack",
        "boxes",
        html.table_of("boxes of the loose stack", columns, view.boxes),
        html.Note(BOXES_NOTE),
        look="brief" if view.brief else "",
    )


def sureness_section(view: RunView) -> html.PageSection:
    """The outcome over the unknown inputs."""
    band, note = view.figures("band"), band_note(view.verdict.band)
    if not (band or note):
        return html.section("", "band")
    counted = "Sliding counts from 1 mm and 10⁻⁴ of the width, rocking from 10⁻² of the slenderness angle."
    if view.case.motion.kind != "none":
        counted = f"{counted} {NOT_WORSE}"
    return html.section(
        "How sure it is",
        "band",
        *band,
        html.Note(f"{note} {counted}".lstrip()),
        look="brief" if view.brief else "",
    )


def modes_section(view: RunView) -> html.PageSection:
    """The elastic modes of the container, also of a rigid run."""
    solver, numerics = view.case.solver, view.result.numerics
    modes = elastic_mode_table(view.model.container.lowest_modes(FEW))
    whose = "each container of the row, alone and" if view.case.neighbour else "the container"
    used = {
        "rigid": "; this rigid run uses none",
        "reduced": f"; this run uses {solver.elastic_modes}, with a damping ratio of "
        f"{short(view.case.container.damping_ratio)} in the first, proportional to frequency in the others",
    }.get(solver.model, "")
    contact = ""
    if numerics and solver.model != "rigid" and (bounce := numerics.contact_frequency_Hz):
        contact = (
            f" Contact frequency {quantity(bounce, 'Hz')}: first elastic over contact frequency "
            f"{number(modes[0]['frequency_Hz'] / bounce, figures=3)}. Restitution hardly depends on it; forces, "
            "accelerations and stresses of an impact do depend on the contact stiffness."
        )
    columns: list[html.Column[Mapping[str, float]]] = [
        html.Column("mode", lambda row: str(int(row["mode"]))),
        html.Column("frequency [Hz]", lambda row: number(row["frequency_Hz"], figures=5), html.NUMBER),
        html.Column("period [ms]", lambda row: number(row["period_s"], 1000, 4), html.NUMBER),
        html.Column("to the first", lambda row: number(row["ratio_to_first"]), html.NUMBER),
    ]
    return html.section(
        "Elastic modes",
        "modes",
        f"Modes of {whose} without contact{used}.{contact}",
        html.columns(html.table_of("elastic modes", columns, modes), *view.figures("modes")),
    )


def block_section(view: RunView) -> html.PageSection:
    """The run beside the analytic rigid block."""
    title, check = "Comparison with the analytic rigid block", rigid_check(view.run, view.model, view.history)
    if check is None:
        return html.section(title, "block", f"Not compared: the run is {view.run.status}.")
    fair = html.joined("The comparison is fair.")
    if not check.meaningful:
        fair = html.joined(html.strong("No fair comparison:"), f" {'; '.join(check.reasons)}.")
    introduction = html.joined(
        "A rigid block with the same mass centre, inertia, friction and floor, computed from event to event by "
        "independent code. ",
        fair,
    )
    table = [_block_table(check)] if check.reference else []
    return html.section(title, "block", introduction, *table, *view.figures("rigid_check"))


def _block_table(check: RigidCheckResult) -> html.Table:
    first, ratio, apart = check.first_impact_s, check.velocity_ratio, check.largest_difference_before_impact
    rows = (
        [
            (
                "first impact [s]",
                *(
                    "none" if value is None else number(value, figures=5)
                    for value in (first.run, first.block)
                ),
            )
        ]
        if first
        else []
    )
    if ratio:
        rows.append(
            (
                "restitution there",
                *("not measured" if value is None else number(value) for value in (ratio.run, ratio.block)),
            )
        )
    rows += [
        (f"peak {k} [°]", number(peak.run_rad, DEGREES), number(peak.block_rad, DEGREES))
        for k, peak in enumerate(check.peaks, 1)
    ]
    if apart is not None:
        words = "largest difference before an impact, of the slenderness angle"
        rows.append((words, number(apart, figures=3), ""))
    columns = html.in_order("compared", "run", "block", look=html.NUMBER)
    return html.table_of("run and analytic block", columns, rows)


def rigid_check(run: OpenedRun, model: Model, history: History) -> RigidCheckResult | None:
    """The comparison with the analytic block: that of the run, or else made now; None of an unfinished run."""
    result = run.typed_result
    if result.rigid_check is not None:
        return result.rigid_check
    if run.status not in RUN.finished or result.verdict is None or len(history) < 2:
        return None
    try:
        return check_against_rigid_block(model, history, result.verdict).result
    except (ValueError, EventError) as error:
        return RigidCheckResult(reasons=(str(error),))


def joints_section(view: RunView) -> html.PageSection:
    """The forces in the joints of a bolted stack."""
    if not view.result.joints:
        return html.section("", "joints")
    forces = {
        "shear [kN]": "max_shear_N",
        "moment [kNm]": "max_moment_Nm",
        "bolts left [kN]": "bolt_tension_left_N",
        "bolts right [kN]": "bolt_tension_right_N",
        "bolt shear [kN]": "bolt_shear_N",
    }

    def force(name: str, joint: JointDemand) -> str:
        return number(getattr(joint, name), 1e-3, 3)

    def normal(joint: JointDemand) -> str:
        return f"{force('min_normal_N', joint)} to {force('max_normal_N', joint)}"

    def friction(joint: JointDemand) -> str:
        needed = joint.friction_needed
        return "none holds" if needed is None else number(needed, figures=3)

    columns: list[html.Column[JointDemand]] = [
        html.Column("at [m]", lambda joint: short(joint.height_m)),
        html.Column("normal [kN]", normal, html.NUMBER),
        *(html.Column(head, partial(force, name), html.NUMBER) for head, name in forces.items()),
        html.Column("friction needed", friction, html.NUMBER),
        html.Column("without bolts it", unbolted),
    ]
    return html.section(
        f"Joints between the boxes{impact_note(view.verdict)}",
        "joints",
        *view.figures("joints"),
        html.table_of("joints between the boxes", columns, view.result.joints),
        html.Note(joints_note(view.verdict)),
    )


def sheet_section(view: RunView) -> html.PageSection:
    """The static calculation, with its numbers."""

    def source(line: SheetLine) -> str:
        colon = ": " if line.source and line.verdict else ""
        return html.joined(line.source, colon, html.strong(line.verdict) if line.verdict else "")

    columns: list[html.Column[SheetLine]] = [
        html.Column("quantity", lambda line: line.name),
        html.Column("formula", lambda line: line.formula),
        html.Column("with numbers", lambda line: line.numbers),
        html.Column("result", lambda line: f"{line.result} {line.unit}", html.NUMBER),
        html.Column("source", source, "note"),
    ]
    tables = (
        html.table_of(heading, columns, lines, caption=heading, look="sheet")
        for heading, lines in static_sheet(view.model.static, view.case)
    )
    introduction = "Equilibrium of the rigid container on its corners, every line with its numbers."
    return html.section("Static calculation", "sheet", introduction, *tables)
