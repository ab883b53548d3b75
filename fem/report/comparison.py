"""Rows of a report: the case as given, the static rules beside the run; assumptions."""

import math
from typing import NamedTuple, assert_never

from markupsafe import Markup

from fem.case.case import Case
from fem.case.tables.boxes import Box
from fem.case.tables.motion_tables import FloorMotionTable
from fem.html.units import degrees, number, quantity, short, typeset
from fem.model.container import modes_of_a_body
from fem.model.static_checks import StaticChecks
from fem.results.run_result import Verdict
from fem.run.described import link_rows
from fem.run.static_words import rule_says
from fem.run.summary import own_motion_name, run_lifted, run_slid, run_tilted

EDITION = "EN 1998-1:2004, "  #: of the clauses; the head of their column names it


class Compared(NamedTuple):
    """The static rule under one action, and what the run found where the two may be compared."""

    check: str
    action: str
    demand: str
    capacity: str
    utilisation: str
    exceeded: bool
    clause: str
    rule: str  #: what the rule says
    run: str  #: what the run found; empty where it is not to be compared


def compared_rows(static: StaticChecks, verdict: Verdict) -> list[Compared]:
    """Sliding and overturning under the run's own peak, then under the code's base shear."""
    compared = static.own_motion, static.own_motion_vertical
    actions = [(static.own_motion, typeset(own_motion_name(static.to_result())))]
    if static.own_motion_vertical is not None:
        peak = quantity(static.peak_vertical_acceleration, "m/s²", figures=3)
        actions.append((static.own_motion_vertical, f"own peak, and {peak} vertical"))
    if (code := static.by_code) is not None:
        q = code.values.behaviour_factor
        codes = [(code.as_given, f"code, q = {short(q)}"), (code.q1, "code, q = 1")]
        actions += codes if q != 1.0 else codes[:1]
    if static.wind is not None:
        actions.append((static.wind, "wind"))
    rows = [
        Compared(
            check=check,
            action=name,
            demand=quantity(rule.demand, f"k{rule.unit}", 1e-3),
            capacity=quantity(rule.capacity, f"k{rule.unit}", 1e-3),
            utilisation="∞" if rule.utilisation == math.inf else number(rule.utilisation),
            exceeded=not rule.passed,
            clause=rule.clause.removeprefix(EDITION).removesuffix(f", {check}"),
            rule=rule_says(check, rule.utilisation),
            run=typeset(words_of(verdict))
            if verdict.outcome and any(action is own for own in compared)
            else "",
        )
        for action, name in actions
        for check, rule, words_of in (
            ("sliding", action.sliding, run_slid),
            ("overturning", action.overturning, run_tilted),
        )
    ]
    lifting = static.to_result().ruling.utilisation_lifting
    if lifting is not None and lifting > 1.0:
        rows.append(
            Compared(
                check="lifting",
                action="own peak, vertical",
                demand=quantity(lifting * static.weight, "kN", 1e-3),
                capacity=quantity(static.weight, "kN", 1e-3),
                utilisation=number(lifting),
                exceeded=True,
                clause="",
                rule=rule_says("lifting", lifting),
                run=typeset(run_lifted(verdict)) if verdict.outcome else "",
            )
        )
    return rows


def case_rows(case: Case) -> list[tuple[str, str]]:
    """The case in words: name and value."""
    box, contact = case.container, case.contact
    walls = ", ".join(dict.fromkeys(short(stacked.wall, 1e3) for stacked in case.stack))
    section = f"shell, walls {walls} mm" if box.section == "shell" else "solid block"
    if (post := box.post_section) is not None:
        section += f", posts {' × '.join(short(length, 1e3) for length in post)} mm"
    corners = "two bottom corners"
    if casting := case.support.casting_m:
        corners = f"castings of {short(casting[0], 1e3)} × {short(casting[1], 1e3)} mm, at their outer edges"
    supports = {
        "corners": corners,
        "feet": f"two feet, {short(case.support.foot_m, 1e3)} mm long",
        "flat": "flat base",
    }
    a_box = " a box" if box.is_loose else ""
    models = {
        "full": "full: every node of the mesh, finite rotation",
        "reduced": f"reduced: turning frame and {modes_of_a_body(case)} elastic modes{a_box}",
        "rigid": f"rigid: three coordinates{a_box}",
    }
    mu, joints = Markup("μ<sub>s</sub> = {}, μ<sub>k</sub> = {}"), case.joint_friction
    weakening = f", falling over {short(joints['weakening_m'], 1e3)} mm" if joints["weakening_m"] else ""
    whose = ", as on the floor" if case.joints.mu_static is None else ""
    between = mu.format(short(joints["mu_static"]), short(joints["mu_kinetic"])) + weakening + whose
    duration = "to the end of the motion, and on until rest or a fall"
    if case.solver.duration_s != "auto":
        duration = f"{short(case.solver.duration_s)} s"
    return [
        *_box_rows(case),
        (
            "section",
            f"{section}, E = {short(box.youngs_modulus_Pa, 1e-9)} GPa, ν = {short(box.poisson_ratio)}",
        ),
        ("support", supports[case.support.kind]),
        ("friction", mu.format(short(contact.mu_static), short(contact.mu_kinetic))),
        *([("friction between boxes", between)] if box.is_loose else []),
        ("floor", motion_in_words(case.motion)),
        *([("floor, vertical", motion_in_words(case.vertical))] if case.has_vertical else []),
        *((name, typeset(value)) for name, value in link_rows(case)),
        ("start", _start(case)),
        ("model", models[case.solver.model]),
        ("time", f"{duration}, g = {short(case.gravity_m_s2)} m/s²"),
    ]


def _box_rows(case: Case) -> list[tuple[str, str]]:
    """Size and weight of a box, and how many there are; of boxes that differ, of each from the floor up."""
    boxes, depth, joints = case.stack, short(case.container.depth_m), case.container.joints
    count = f"{len(boxes)} boxes, {joints}" if len(boxes) > 1 else ""

    def described(box: Box) -> str:
        size = " × ".join((short(box.width), depth, short(box.height)))
        names = "width × depth × height"
        if case.container.is_round:
            size, names = f"{short(box.width)} × {short(box.height)}", "cylinder, diameter × height"
        return f"{size} m ({names}), {short(box.mass * case.gravity_m_s2, 1e-3, 6)} kN with fill"

    if case.container.box is None:
        return [("container", f"{count}, each {described(boxes[0])}" if count else described(boxes[0]))]
    rows = [("container", f"{count or 'one box'}, from the floor up:")]
    for k, box in enumerate(boxes, 1):
        offset = (
            f"; its axis {short(abs(box.axis), 1e3)} mm {'right' if box.axis > 0.0 else 'left'} of that of box 1"
            if box.axis
            else ""
        )
        rows.append((f"box {k}", f"{described(box)}, mass centre at {short(box.centroid)} m{offset}"))
    return rows


def motion_in_words(motion: FloorMotionTable) -> str:
    """How the floor moves in one direction."""
    match motion.kind:
        case "none":
            return "at rest"
        case "harmonic":
            frequency = motion.angular_frequency / (2.0 * math.pi)
            words = (
                f"harmonic, A = {quantity(motion.amplitude, 'mm', 1e3)}, "
                f"Ω = {short(motion.angular_frequency, 1.0, 5)} rad/s ({quantity(frequency, 'Hz')}), "
                f"peak {quantity(motion.nominal_peak, 'm/s²')}"
            )
            extras = [
                f"phase {degrees(motion.phase_rad)}" if motion.phase_rad else "",
                f"ramps of {short(motion.ramp_cycles)} cycles" if motion.ramp_cycles else "",
                f"{short(motion.cycles)} cycles" if motion.cycles is not None else "",
                "the other sign" if motion.factor < 0.0 else "",
            ]
            return ", ".join([words, *filter(None, extras)])
        case "pulse":
            return (
                f"{motion.shape} pulse, {quantity(motion.factor * (motion.peak_acceleration_m_s2 or 0.0), 'm/s²')} for "
                f"{quantity(motion.pulse_s, 's')}, from t = {short(motion.delay_s)} s"
            )
        case "table":
            unit = f", {motion.unit}" if motion.unit else ""
            record = f"record {motion.file}" if motion.file else "vertical component of that record"
            scale = f"scale {short(motion.scale)}"
            if motion.scale_to_m_s2 is not None:
                scale = f"scaled to {quantity(motion.scale_to_m_s2, 'm/s²')}"
            return f"{record} ({motion.quantity}{unit}), {scale}, baseline {motion.baseline}"
    assert_never(motion.kind)


def _start(case: Case) -> str:
    initial = case.initial
    words = []
    if case.motion.kind != "none":
        moving = case.motion.start == "moving"
        words.append(
            "moving with the floor" if moving else "at rest while the floor starts with its velocity"
        )
    if initial.rotation_rad:
        words.append(f"tilted by {degrees(initial.rotation_rad)}")
    if initial.angular_velocity_rad_s:
        words.append(f"turning at {quantity(initial.angular_velocity_rad_s, 'rad/s')}")
    if initial.velocity_m_s:
        words.append(f"sliding at {quantity(initial.velocity_m_s, 'm/s')}")
    return ", ".join(words) or "at rest"
