"""`check`: what can be said of a case without solving it."""

import importlib
import json
import math
from collections.abc import Mapping
from typing import Any

from contact.interface.penalty import contact_frequency
from fem.case.case import Case, case_hash, load_case
from fem.cli.console import AsJson, Overrides
from fem.model.geometry import build_container, node_count
from fem.model.restitution import apparent_restitution
from fem.model.static_checks import StaticChecks, static_checks
from fem.model.support import build_support, normal_penalty, require_firm_floor
from fem.results.disk import in_units
from fem.run.size import frames_of, required_disk, samples_of
from mesh.container import ContainerMesh


def check(
    case: str | None = None,
    /,
    *,
    overrides: Overrides = (),
    as_json: AsJson = False,
) -> None:
    """Static checks, derived numbers and chosen numerics of a case; nothing is solved or written.

    Parameters
    ----------
    case:
        A case file or the name of a shipped case; default: seed_stack_plateau.
    """
    loaded = load_case(case, overrides)
    mesh = build_container(loaded)
    peak = peak_floor_acceleration(loaded)
    static = checks_of(loaded, mesh, peak)
    document = {
        "case": loaded.name,
        "asked_hash": case_hash(loaded),
        "derived": derived_numbers(loaded, mesh, peak),
        "static": static.to_result().to_json(),
        "contact_restitution": contact_restitution(loaded, mesh, static),
        "numerics": chosen_numerics(loaded, mesh),
        "notes": notes(loaded, static, peak),
    }
    print(json.dumps(document, indent=2) if as_json else _page(loaded, document, static))


def peak_floor_acceleration(case: Case) -> float:
    """Largest |acceleration| that the floor reaches in the run [m/s2]."""
    motion, nominal = case.motion, case.nominal_peak_acceleration
    whole = motion.kind == "pulse" and case.solver.duration_s >= motion.delay_s + (motion.pulse_s or 0.0)
    plain = (
        motion.kind == "none"
        or whole
        or (
            motion.kind == "harmonic"
            and motion.ramp_cycles == 0.0
            and case.solver.duration_s >= 0.5 * motion.period
        )
    )
    if nominal is not None and plain:
        return nominal
    # The motion itself is asked only where it must be: its compiled functions take long to load.
    room = importlib.import_module("fem.model.motion")
    return float(room.peak_acceleration_within(room.build_motion(case), case.solver.duration_s))


def checks_of(case: Case, mesh: ContainerMesh, peak: float) -> StaticChecks:
    """Static checks of the meshed container under its own motion, peak floor acceleration in m/s2."""
    return static_checks(
        mass=mesh.mass,
        centroid=mesh.centroid[1],
        inertia=mesh.inertia,
        width=mesh.width,
        gravity=case.gravity_m_s2,
        mu_static=case.contact.mu_static,
        mu_kinetic=case.contact.mu_kinetic,
        peak_floor_acceleration=peak,
        ground_acceleration=case.static.ground_acceleration_m_s2,
        soil_factor=case.static.soil_factor,
        corner_period=case.static.corner_period_s,
        behaviour_factor=case.static.behaviour_factor,
        importance_factor=case.static.importance_factor,
        initial_rotation=case.initial.rotation_rad,
    )


def derived_numbers(case: Case, mesh: ContainerMesh, peak: float) -> dict[str, float | None]:
    """What follows from the case before anything moves; SI units stand in the keys."""
    harmonic = case.motion.kind == "harmonic"
    return {
        "mass_kg": mesh.mass,
        "box_mass_kg": case.box_mass,
        "mean_areal_density_kg_m2": case.mean_areal_density,
        "width_m": mesh.width,
        "height_m": mesh.height,
        "peak_floor_acceleration_m_s2": peak,
        "amplitude_m": case.amplitude if harmonic else None,
        "angular_frequency_rad_s": case.angular_frequency if harmonic else None,
        "period_s": case.motion.period if harmonic else None,
    }


def chosen_numerics(case: Case, mesh: ContainerMesh) -> dict[str, Any]:
    """Model, scheme and sizes of the computation."""
    solver = case.solver
    nodes = node_count(mesh, solver.order)
    penalty = normal_penalty(case, mesh)
    springs = build_support(case, mesh).normal_stiffness(penalty)
    stiffness = float(springs.sum())
    require_firm_floor(case, mesh, stiffness)
    return {
        "model": solver.model,
        "scheme": solver.scheme,
        "elements": len(mesh.quads),
        "nodes": nodes,
        "mesh_unknowns": 2 * nodes,
        "elastic_modes": {"rigid": 0, "reduced": solver.elastic_modes}.get(solver.model),
        "contact_nodes": len(springs),
        "normal_penalty_Pa_m": penalty,
        "contact_frequency_Hz": contact_frequency(mesh.mass, stiffness),
        "static_penetration_m": mesh.mass * case.gravity_m_s2 / stiffness,
        "duration_s": solver.duration_s,
        "history_samples": samples_of(case),
        "field_frames": frames_of(case),
        "output_bytes": required_disk(case, nodes),
    }


def contact_restitution(case: Case, mesh: ContainerMesh, static: StaticChecks) -> float | None:
    """Restitution that the contact damping ratio amounts to, were the container rigid; None off the table."""
    foot = case.support.foot
    return apparent_restitution(
        support=case.support.kind,
        foot_over_width=None if foot is None else foot / mesh.width,
        slenderness=static.centroid / (0.5 * mesh.width),
        damping_ratio=case.contact.damping_ratio,
        housner=static.housner_restitution,
    )


def notes(case: Case, static: StaticChecks, peak: float) -> list[str]:
    """What to keep in mind when the run is read."""
    said = []
    angle = static.slenderness_angle
    if abs(case.initial.rotation_rad) >= angle:
        said.append(
            f"initial.rotation_rad = {case.initial.rotation_rad:g} is beyond the slenderness angle, "
            f"{angle:.4g} rad: without help from the floor the container falls"
        )
    if not static.housner_credible:
        said.append(
            f"Housner's restitution is {static.housner_restitution:.3f}, below 0.5: for a container so squat "
            "the rigid block's impact model is not credible"
        )
    if not static.applicability.passed:
        limit = static.applicability
        said.append(
            f"the lateral force method does not apply: rocking period {limit.demand:.2f} s > "
            f"{limit.capacity:.1f} s ({limit.clause})"
        )
    if case.motion.kind == "table":
        room = importlib.import_module("fem.model.motion")
        said += room.motion_notes(room.build_motion(case))
    if case.contact.friction == "regularised":
        said.append("friction regularised in velocity creeps under constant load; elastic-stick does not")
    if case.motion.start == "rest" and case.motion.kind == "harmonic":
        kick = case.amplitude * case.angular_frequency * abs(math.cos(case.motion.phase_rad))
        said.append(f'start = "rest": the floor begins with a jerk of {kick:.3g} m/s')
    if peak >= static.uplift_acceleration and static.own_motion.sliding.passed:
        said.append(
            "the floor reaches the acceleration of uplift, and friction holds until then: expect rocking"
        )
    return said


def page_of_numerics(numerics: Mapping[str, Any]) -> list[str]:
    """Lines for people of what `chosen_numerics` found."""
    modes = f", {numerics['elastic_modes']} elastic modes" if numerics["elastic_modes"] else ""
    return [
        f"  model       {numerics['model']}{modes}, {numerics['scheme']}",
        f"  mesh        {numerics['elements']} elements, {numerics['nodes']} nodes "
        f"({numerics['mesh_unknowns']} unknowns), {numerics['contact_nodes']} contact nodes",
        f"  contact     penalty {numerics['normal_penalty_Pa_m']:.4g} Pa/m, bounces at "
        f"{numerics['contact_frequency_Hz']:.4g} Hz, "
        f"sinks in by {1e6 * numerics['static_penetration_m']:.3g} um",
        f"  output      {numerics['history_samples']} samples, {numerics['field_frames']} frames "
        f"over {numerics['duration_s']:g} s, about {in_units(numerics['output_bytes'])}",
    ]


def _page(case: Case, document: dict[str, Any], static: StaticChecks) -> str:
    derived, numerics = document["derived"], document["numerics"]
    container, support, motion = case.container, case.support, case.motion
    boxes = f"{container.boxes} box{'es' if container.boxes > 1 else ''}, {container.section}, {support.kind}"
    floor = {"none": "at rest", "pulse": f"{motion.shape} pulse", "table": f"table {motion.file}"}.get(
        motion.kind, f"A = {case.amplitude:.4g} m, Omega = {case.angular_frequency:.4g} rad/s"
    )
    lines = [
        f"{case.name}: {case.title}" if case.title else case.name,
        f"  container   {derived['width_m']:g} x {derived['height_m']:g} m, "
        f"{derived['mass_kg']:.6g} kg, {boxes}",
        f"  floor       {floor}, peak {derived['peak_floor_acceleration_m_s2']:.4g} m/s2",
        "",
        f"  slenderness angle      {math.degrees(static.slenderness_angle):8.3f} deg   "
        f"mass centre at {static.centroid:.4g} m",
        f"  frequency parameter    {static.frequency_parameter:8.4f} 1/s   "
        f"rocking period {static.period_eq2:.3f} s (Eq. 2), {static.period_eq3:.3f} s (Eq. 3)",
        f"  uplift from            {static.uplift_acceleration:8.4f} m/s2  "
        f"slip from {static.sliding_limit_static / derived['mass_kg']:.4g} m/s2",
        f"  Housner's restitution  {static.housner_restitution:8.4f}      {_restitution_of_contact(case, document)}",
        "",
        "  static rule                        demand     capacity   utilisation",
    ]
    actions = {
        "own motion": static.own_motion,
        f"code, q = {case.static.behaviour_factor:g}": static.code,
        "code, q = 1": static.code_q1,
    }
    for action, result in actions.items():
        for what, one in (("sliding", result.sliding), ("overturning", result.overturning)):
            verdict = "" if one.passed else f"  {'slides' if what == 'sliding' else 'overturns'}"
            lines.append(
                f"    {action:<14} {what:<12} {one.demand / 1e3:8.3f}   {one.capacity / 1e3:8.3f} "
                f"{'k' + one.unit:<4} {one.utilisation:8.3f}{verdict}"
            )
    lines += ["", *page_of_numerics(numerics)]
    lines += [f"  note: {note}" for note in document["notes"]]
    return "\n".join(lines)


def _restitution_of_contact(case: Case, document: Mapping[str, Any]) -> str:
    """What the calibration table says, for the page."""
    contact = f"contact damping ratio {case.contact.damping_ratio:g} on {case.support.kind}"
    value = document["contact_restitution"]
    return f"{contact}: {value:.3f} if rigid" if value is not None else f"{contact}: not in the table"
