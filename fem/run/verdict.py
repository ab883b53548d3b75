"""The verdict of a run: outcome, extremes, events, energy balance, numerics."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.interface.penalty import contact_frequency
from contact.stepping.body import ROTATION
from contact.stepping.ledger import (
    BASE_WORK,
    CONTACT_DAMPING,
    CRUSHING,
    FRICTION,
    GAIN_LIMIT,
    IMBALANCE,
    IMPACTS,
    LOSS_LIMIT,
    LOSS_SHARE_LIMIT,
    MATERIAL_DAMPING,
)
from contact.stepping.modes import HOPPING, ROCKING
from fem.case.case import Case
from fem.case.columns import JOINTS
from fem.case.tables.boxes import shared_face
from fem.model.bounce import bounce_of
from fem.model.floor import YIELD_STRENGTH, is_steel_shell, post_strength, slab_of, steel_capacity
from fem.model.floor_numbers import plastic_work
from fem.model.joints import edge_forces
from fem.model.model import Model
from fem.model.peaks import casting_length
from fem.results.figures import BOX_FIGURES, FIGURES, BoxResult, Shown
from fem.results.history import History
from fem.results.outcome import Outcome, least_slide
from fem.results.run_result import (
    Energy,
    HeldResult,
    JointDemand,
    NeighbourResult,
    Numerics,
    Verdict,
    to_overturn,
)
from fem.runtime.units import SECONDS, finite

CONTENTS_FILTER = "Butterworth low-pass of two poles, causal"  #: `contact.stepping.contents`
MOST_RESTITUTION = 1.05  #: of a first impact, above which other energy entered
#: share of the slenderness angle from which one that rocks as its run ends is said to, by the kind of its motion: a
#: harmonic one goes on as it was, and without any it comes to rest
SWINGING = {"pulse": 0.1, "table": 0.1, "harmonic": 0.5, "none": math.inf}
SLIDES_ON = 1e-3  #: way over the width from which one that slides as its run ends is said to
STILL = 1e-4  #: change of the rotation over the slenderness angle below which a container does not turn


def outcome_of(model: Model) -> Outcome:
    """The outcome of the whole run, in one word; not valid where a corner is destroyed, whatever followed."""
    if destroyed_corner(model) is not None:
        return Outcome.INVALID
    fell = math.isfinite(model.run.track[0].overturned_at)
    return Outcome.OVERTURNED if fell else Outcome.of(**_moves(model))


def destroyed_corner(model: Model) -> str | None:
    """What has given way under a corner, further than the law of its contact holds; None where nothing has.

    A container that is followed until it lies on its side has fallen, whatever it crushes there.
    """
    lies = math.isfinite(model.run.track[0].overturned_at) and not model.case.output.stop_when_overturned
    depth = _indentation(model)
    if depth is None or lies:
        return None
    slab = slab_of(model.case, model.container.mesh.mass)
    if depth <= slab.deepest:
        return None
    steel = "its wall is" if post_strength(model.case) is None else "its posts are"
    what = steel if slab.yields_first else "the floor under it is"
    return f"{what} crushed by more than {1e3 * slab.deepest:.3g} mm"


def _moves(model: Model) -> dict[str, bool]:
    """Whether it slid and rocked beyond the limits, in a loose stack any box, and whether all of the base hopped."""
    run, width = model.run, model.container.mesh.width
    track, angle = run.track[0], ROCKING * model.static.slenderness_angle
    upper = run.joints[1:] if not model.container.row else ()  # boxes of a loose stack
    slides = run.joints[0].max_slip > least_slide(width)
    rocks = track.max_rocking > angle
    for joint in upper:
        slides = slides or joint.max_slip > least_slide(joint.width)
        rocks = rocks or min(joint.max_rotation, joint.max_opening / joint.width) > angle
    return {"slides": slides, "rocks": rocks, "hops": bool(track.max_flight > HOPPING * width)}


def verdict_of(model: Model, history: History, largest_von_mises: float | None) -> Verdict:
    """The `verdict` of a result; what was not reached is None."""
    time, slip = history["time_s"], history["slip_m"]
    end = float(time[-1]) if time.size else None
    verdict = verdict_from(model, end, time, slip, largest_von_mises)
    if verdict.tilt_rad is None and verdict.outcome != Outcome.OVERTURNED and model.case.links:
        # what leans on a stop bears on one side alone and does not turn
        late = history["rotation_rad"][time >= time[-1] - 1.0 / model.static.frequency_parameter]
        if late.size > 1 and np.ptp(late) < STILL * model.static.slenderness_angle:
            verdict = replace(verdict, tilt_rad=float(late[-1]))
    return replace(verdict, **place_of(model.case, model.container.mesh.width))


def place_of(case: Case, width: float) -> dict[str, Any]:
    """The slip beyond which a container has left its place [m], and whose it is: stated, the gap beside, its width."""
    place = min([*((row.gap_m, "gap") for row in case.neighbour if row.gap_m > 0.0), (width, "width")])
    if case.limits is not None and case.limits.slip_m is not None:
        place = case.limits.slip_m, "limit"
    return {"place_m": place[0], "place_is": place[1]}


def verdict_from(
    model: Model, end: float | None, time: np.ndarray, slip: np.ndarray, largest_von_mises: float | None
) -> Verdict:
    """The `verdict` of a model that was stepped to its end.

    Args:
        end: time of the last sample [s]; None if there is none.
        time, slip: of the samples, as far back as a cycle of the drive at least [s], [m].
        largest_von_mises: of the container [Pa].
    """
    run, case, angle, moves = model.run, model.case, model.static.slenderness_angle, _moves(model)
    destroyed, capacity = destroyed_corner(model), steel_capacity(case)
    track, joint = _numbers(run.track), _numbers(run.joints)
    fell = math.isfinite(track.overturned_at)
    outcome = Outcome.OVERTURNED if fell else Outcome.of(**moves)
    modes = track.modes | moves["hops"] << Outcome.HOP.code
    seen = {mode for mode in Outcome if modes & 1 << mode.code}
    if not moves["slides"]:  # sliding that is too small to count in the outcome does not count here
        still = {Outcome.SLIDE: Outcome.REST, Outcome.SLIDE_ROCK: Outcome.ROCK}
        seen = {still.get(mode, mode) for mode in seen}
    loose = model.container.boxes and not model.container.row
    joints = [_numbers(run.joints[k:]) for k in range(len(run.joints) if loose else 0)]
    boxes = tuple(
        BoxResult(**_recorded(BOX_FIGURES, joint=one), fell=math.isfinite(one.fell_at)) for one in joints
    )
    first = min(range(len(joints)), key=lambda k: joints[k].fell_at, default=0)
    rotation = max((box.max_rotation_rad for box in boxes), default=track.max_rotation)
    lowest = float(run.old.boxes[0, ROTATION] if len(run.old.boxes) else run.old.pose[ROTATION])
    turned = run.old.boxes[:, ROTATION] if boxes else run.old.pose[ROTATION]
    at_rest = finite(float(run.clock[0].rest_since))
    turns = track.left_open + track.right_open > 0 and at_rest is None  # about one side
    swing = float(np.abs(turned).max()) / angle if turns and not fell else 0.0
    neighbours = _neighbour_results(model)
    followed = end is not None and end > 0.0 and not case.output.stop_when_still
    lost_at_impact = 0.0 < track.restitution < MOST_RESTITUTION and not model.container.row
    return Verdict(
        **_recorded(FIGURES, track=track, joint=joint),
        outcome=outcome if destroyed is None else Outcome.INVALID,
        valid=destroyed is None,
        invalid_reason=destroyed,
        leans=(fell and at_rest is not None) or None,
        # states that the history passed through, and the outcome, which may follow from creep alone
        modes=tuple(mode for mode in Outcome if mode in seen or mode == outcome),
        max_rotation_rad=rotation,
        rotation_ratio=rotation / angle,
        flight_share=track.flight_time / track.rocking_time if track.rocking_time > 0.0 else None,
        slip_peak_to_peak_m=_peak_to_peak(model, end, time, slip),
        max_indentation_m=_indentation(model),
        tilt_rad=None if fell or turns else lowest,
        still_turned=swing if swing >= SWINGING[case.motion.kind] else None,
        still_sliding_m_s=None if fell else _still_sliding(case, time, slip),
        restored=outcome in (Outcome.ROCK, Outcome.SLIDE_ROCK)
        and float(np.abs(turned).max()) < ROCKING * angle,
        at_rest_s=at_rest,
        # of the first impact; none where it has none, or where other energy entered
        restitution_first=track.restitution if lost_at_impact else None,
        max_top_displacement_m=track.max_top_displacement if followed else None,
        max_acceleration_m_s2=track.max_acceleration if followed else None,
        max_von_mises_Pa=largest_von_mises,
        yield_strength_Pa=YIELD_STRENGTH if is_steel_shell(case) else None,
        stress_from_corner_m=None if largest_von_mises is None else casting_length(case),
        corner_capacity_N=capacity,
        plastic_work_J=None
        if capacity is None
        else plastic_work(track.max_corner_force, capacity, 0.5 * model.base_stiffness),
        boxes=boxes or None,
        fell_box=1 + first if boxes and boxes[first].fell else None,
        neighbours=neighbours or None,
        **_of_links(model, neighbours),
        **_of_row(model, outcome, neighbours),
    )


def _still_sliding(case: Case, time: np.ndarray, slip: np.ndarray) -> float | None:
    """Speed of the last two samples of one that slides on by itself [m/s]; None where it hardly does.

    On a level floor, friction stops it within v^2/(2 mu g). Under a harmonic motion it slides back and forth, and its
    speed at the end says nothing.
    """
    if len(time) < 2 or (case.motion.kind == "harmonic" and case.floor.slope == 0.0):
        return None
    speed = abs(float(slip[-1] - slip[-2])) / float(time[-1] - time[-2])
    stops_from = 2.0 * case.contact.mu_kinetic * case.gravity_m_s2 * SLIDES_ON * case.stack[0].width
    return speed if speed**2 > stops_from else None


def _recorded(figures: Mapping[str, Shown], **records: Any) -> dict[str, Any]:
    """The figures that the stepper records, by key; of an event that has not happened, None."""
    sources = {key: figure.of.split(".") for key, figure in figures.items() if figure.of}
    values = {key: getattr(records[record], name) for key, (record, name) in sources.items()}
    return {key: finite(value) if figures[key].unit is SECONDS else value for key, value in values.items()}


def _neighbour_results(model: Model) -> tuple[NeighbourResult, ...]:
    """What each neighbour in a row did, and what happened across the gap before it, in the order of the case."""
    neighbours = []
    for number, neighbour in enumerate(model.case.neighbour, 1):
        joint, gap = _numbers(model.run.joints[number:]), _numbers(model.run.links[number - 1 :])
        neighbours.append(
            NeighbourResult(
                side=neighbour.side,
                outcome=_outcome_in_row(joint),
                max_rotation_rad=joint.max_rotation,
                rotation_ratio=joint.max_rotation / joint.angle,
                max_slip_m=joint.max_slip,
                residual_slip_m=joint.slip,
                max_uplift_m=joint.max_opening,
                overturned_at_s=finite(joint.fell_at),
                hits=gap.hits,
                max_force_N=gap.max_force,
                largest_closing_velocity_m_s=gap.largest_closing_velocity,
                gap_left_m=gap.least_gap,
            )
        )
    return tuple(neighbours)


def _outcome_in_row(joint: SimpleNamespace) -> Outcome:
    """What one container of a row did, by the record of where it stands on the floor."""
    if math.isfinite(joint.fell_at):
        return Outcome.OVERTURNED
    rocks = min(joint.max_rotation, joint.max_opening / joint.width) > ROCKING * joint.angle
    return Outcome.of(slides=joint.max_slip > least_slide(joint.width), rocks=rocks)


def _of_row(model: Model, outcome: Outcome, neighbours: Sequence[NeighbourResult]) -> dict[str, Any]:
    """Who overturned first in a row, and what each container of it did; nothing of one alone."""
    if not neighbours:
        return {}
    fell_at = model.run.joints["fell_at"]
    first = int(np.argmin(fell_at))
    own = outcome if outcome != Outcome.OVERTURNED else _outcome_in_row(_numbers(model.run.joints))
    return {
        "fell_in_row": (f"neighbour {first}" if first else "container")
        if np.isfinite(fell_at[first])
        else None,
        "row_outcomes": ", ".join([own, *(neighbour.outcome for neighbour in neighbours)]),
    }


def _of_links(model: Model, neighbours: Sequence[NeighbourResult]) -> dict[str, Any]:
    """What stops, ties and neighbours did together, by key (`LinkFigures`); nothing where there are none."""
    case, links = model.case, model.run.links
    if not links.size:
        return {}
    whole = links[~np.isfinite(links["broken_at"]) & np.isfinite(links["least_gap"])]
    kinds = np.repeat(["neighbour", "stop", "tie"], [len(case.neighbour), len(case.stop), len(case.tie)])
    return {
        **{
            f"{kind}_force_N": float(links["max_force"][kinds == kind].max()) for kind in dict.fromkeys(kinds)
        },
        "link_hits": int(links["hits"].sum()),
        "link_velocity_m_s": float(links["largest_closing_velocity"].max()),
        "link_broken_at_s": finite(float(links["broken_at"].min())),
        "link_slack_m": float(whole["least_gap"].min()) if whole.size else None,
        "neighbour_rotation_ratio": max((neighbour.rotation_ratio for neighbour in neighbours), default=None),
    }


def held_by(model: Model) -> tuple[HeldResult, ...] | None:
    """What each neighbour, stop and tie did in a run of a band; None where there are none."""
    beside: list[dict[str, Any]] = [
        {"rotation_ratio": None if one.overturned_at_s is not None else one.rotation_ratio}
        | {"max_slip_m": one.max_slip_m}
        for one in _neighbour_results(model)
    ]
    held = []
    for number, record in enumerate(model.run.links):
        whole = math.isinf(record["broken_at"])
        held.append(
            HeldResult(
                max_force_N=float(record["max_force"]),
                hits=int(record["hits"]),
                largest_closing_velocity_m_s=float(record["largest_closing_velocity"]),
                gap_left_m=finite(float(record["least_gap"])) if whole else None,
                broken_at_s=finite(float(record["broken_at"])),
                **(beside[number] if number < len(beside) else {}),
            )
        )
    return tuple(held) or None


def _indentation(model: Model) -> float | None:
    """Largest permanent indentation under a base point [m]; None where the floor does not crush."""
    run, base = model.run, model.run.problem.control.base_points * max(1, len(model.container.row))
    return float(run.old.crushed[:base].max()) if np.isfinite(run.problem.contact.cap[:base]).any() else None


def _numbers(records: Any) -> SimpleNamespace:
    """The first record as plain numbers, which are read a hundred times faster than those of numpy."""
    return SimpleNamespace(**dict(zip(records.dtype.names, records[0].item(), strict=True)))


def energy_of(model: Model) -> Energy:
    """The energy balance of a model that was stepped to its end."""
    ledger, clock = model.run.ledger, model.run.clock[0]
    reference = model.run.problem.control.reference_energy
    return Energy(
        reference_J=reference,
        closure_error=max(-float(clock.least_imbalance), float(clock.most_imbalance)) / reference,
        friction_J=float(ledger[FRICTION]),
        contact_damping_J=float(ledger[CONTACT_DAMPING]),
        material_damping_J=float(ledger[MATERIAL_DAMPING]),
        crushing_J=float(ledger[CRUSHING]),
        impact_J=float(ledger[IMPACTS]),
        numerical_J=float(ledger[IMBALANCE]),
        base_work_J=float(ledger[BASE_WORK]),
    )


def softer_contact(case: Case) -> str:
    """What to try where the contact is too stiff to be stepped."""
    return "a softer floor" if case.floor.is_slab else "a softer contact.normal_penalty_Pa_m"


def audit(model: Model) -> str | None:
    """Why the energy balance fails this run, or None; of an overturned run, up to its fall."""
    clock, reference = model.run.clock[0], model.run.problem.control.reference_energy
    gained, lost = -float(clock.least_imbalance), float(clock.most_imbalance)
    largest = model.run.problem.control.largest_step
    remedy = f"set solver.step_s below the {largest:.2g} s used, or {softer_contact(model.case)}"
    if not np.all(np.isfinite(model.run.ledger)):
        return (
            f"t = {float(clock.time):.6g} s: the energy balance is not finite, as the motion grew; {remedy}"
        )
    if gained > GAIN_LIMIT * reference:
        return (
            f"numerical energy gain {gained:.3g} J, {gained / reference:.1e} of the energy "
            f"{to_overturn(bool(model.case.neighbour))} (limit {GAIN_LIMIT:.0e}); {remedy}"
        )
    limit = max(LOSS_SHARE_LIMIT * float(clock.dissipated), LOSS_LIMIT * reference)
    if lost > limit:
        return f"energy balance error {lost:.3g} J (limit {limit:.3g} J); {remedy}"
    return None


def numerics_of(model: Model, stepping_cpu: float) -> Numerics:
    """The accuracy and cost of the stepping."""
    run, container = model.run, model.container
    clock = run.clock[0]
    mass, stiffness = container.mesh.mass, model.base_stiffness
    # Rayleigh and Ritz: the modes of the free container come first, then the attachment modes of its contact points.
    elastic = model.elastic_modes if model.case.solver.model == "reduced" else 1
    spectra = model.spectra
    bounce = bounce_of(model.case, container, model.equilibrium.contact)
    return Numerics(
        unknowns=int(run.old.position.size),
        contact_nodes=int(
            container.nodes.size - len(model.case.links) if container.boxes else container.support.index.size
        ),
        steps=int(clock.steps),
        rejected=int(clock.rejected),
        newton_iterations=int(clock.contact_iterations),
        iterations=int(clock.iterations),
        simulated_s=float(clock.time),
        largest_step_s=run.problem.control.largest_step,
        smallest_step_s=float(clock.smallest_step) if clock.steps else None,
        stepping_cpu_s=stepping_cpu,
        normal_penalty_Pa_m=None if model.case.floor.is_slab else model.penalty,
        contact_damping_ratio=model.damping_ratio,
        contact_frequency_Hz=contact_frequency(mass, stiffness),
        static_penetration_m=mass * model.case.gravity_m_s2 / stiffness,
        max_penetration_m=float(run.track[0].max_penetration),
        elastic_frequencies_Hz=tuple(sorted(f for spectrum in spectra for f in spectrum[:elastic].tolist())),
        attachment_frequencies_Hz=tuple(
            sorted(f for spectrum in spectra for f in spectrum[elastic:].tolist())
        ),
        corner_force_window_s=run.problem.control.force_window,
        bounce_frequency_Hz=bounce.frequency,
        bounce_container_damping_ratio=bounce.container_damping_ratio,
        bounce_contact_damping_ratio=bounce.contact_damping_ratio,
        contents_filter=CONTENTS_FILTER,
        contents_filter_Hz=model.case.output.contents_filter_Hz,
    )


def end_of_drive(model: Model) -> float:
    """When the floor stops, or else the run [s]."""
    return min(model.duration, getattr(model.motion, "end_time", math.inf))


def _peak_to_peak(model: Model, last: float | None, time: np.ndarray, slip: np.ndarray) -> float | None:
    """Largest less smallest slip over the last full cycle of a harmonic drive [m]."""
    if model.case.motion.kind != "harmonic" or last is None:
        return None
    period = model.case.motion.period
    end = min(last, end_of_drive(model))
    if end < period * (1.0 - 1e-9):
        return None
    cycle = slip[(time >= end - period - 1e-9) & (time <= end + 1e-9)]
    if cycle.size < 2:  # sampled more coarsely than a cycle
        return None
    return float(cycle.max() - cycle.min())


def joint_demands(model: Model, history: History) -> tuple[JointDemand, ...] | None:
    """The demands on all joints, from the floor up; None for a single box, or if nothing was sampled.

    Of a container that overturned, until 90 degrees.
    """
    standing = history["time_s"] <= model.run.track[0].overturned_at
    if history.joints == 0 or not standing.any():
        return None
    mu, capacity = model.case.contact.mu_static, model.case.joints.bolt_capacity_N
    time, demands = history["time_s"][standing], []

    def first(happens: NDArray[np.bool_]) -> float | None:
        """Time of the first sample at which it happens [s]."""
        return float(time[np.argmax(happens)]) if happens.any() else None

    for joint in range(1, history.joints + 1):
        lower, upper = model.case.stack[joint - 1 : joint + 1]
        start, end = shared_face(lower, upper)
        normal, shear, moment = (history[name][standing] for name in JOINTS.names((joint,)))
        left, right = edge_forces(normal, moment, end - start)
        tension = max(0.0, -float(left.min())), max(0.0, -float(right.min()))
        carried, size = mu * np.maximum(normal, 0.0), np.abs(shear)
        sheared = shear != 0.0
        demands.append(
            JointDemand(
                joint=joint,
                height_m=upper.bottom,
                min_normal_N=float(normal.min()),
                max_normal_N=float(normal.max()),
                max_shear_N=float(size.max()),
                max_moment_Nm=float(np.abs(moment).max()),
                bolt_tension_left_N=tension[0],
                bolt_tension_right_N=tension[1],
                bolt_utilisation=None if capacity is None else max(tension) / capacity,
                bolt_shear_N=max(0.0, float((size - carried).max())),
                # least coefficient of friction at which it never slides; none if sheared without compression
                friction_needed=None
                if np.any(normal[sheared] <= 0.0)
                else float(np.max(size[sheared] / normal[sheared], initial=0.0)),
                partly_opens_at_s=first(np.abs(moment) > normal * (end - start) / 6.0),
                opens_at_s=first(np.minimum(left, right) < 0.0),
                slides_at_s=first(size > carried),
            )
        )
    return tuple(demands)
