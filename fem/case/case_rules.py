"""What ties the tables of a case together."""

import math
from functools import partial
from typing import Any

from fem.case.columns import history_columns
from fem.case.tables import quantities as q
from fem.case.tables.boxes import BOX_RULES, JOINT_RULES, WEAKENING_RULES, plan_share
from fem.case.tables.container_tables import MASSES
from fem.case.tables.duration import duration_in_words, longest_time
from fem.case.tables.floors import FLOOR_CASE_RULES
from fem.case.tables.links import LINK_RULES
from fem.case.tables.neighbours import NEIGHBOUR_RULES
from fem.case.tables.problem import Rule, left_out, refused

MOST_SAMPLES = 2e7
MOST_HISTORY = 3.4e9  # bytes in memory: so many samples of a single box
MOST_FRAMES = 1e6
MOST_STEPS = 1e9


def _implausible(case: Any, key: str) -> str:
    """Why the mean density that follows from the weight or the mass of a box is that of no material."""
    box, value = case.container, getattr(case.container, key)
    if value is None or box.box is not None:
        return ""
    mass = float(case.gravity_m_s2) if key == "weight_N" else 1.0  # of a kilogram, in the unit of the key
    volume = box.width_m * box.height_m * box.depth_m * plan_share(box)
    density = value / (mass * volume)
    if q.DENSITY.allows(density):
        return ""
    slips = {"tonnes": 1e3 * mass} | ({"kilonewtons": 1e3, "kilograms": mass} if key == "weight_N" else {})
    guess = q.Quantity(unit=MASSES[key].unit, typical=1e3 * mass * volume, slips=slips).guess(
        value, lambda meant: q.DENSITY.allows(meant / (mass * volume))
    )
    return (
        f"= {value:g} {MASSES[key].unit} on {box.width_m:g} x {box.depth_m:g} x {box.height_m:g} m is a mean "
        f"density of {density:.3g} kg/m3, it must be {q.DENSITY.range_in_words} kg/m3; "
        + (guess or "are all dimensions in metres?")
    )


def _coarse(case: Any) -> str:
    """Why an element of a metre or more that is larger than the container is a slip of the unit."""
    box, size = case.container, case.solver.element_size_m
    largest = float(max(box.width_m, box.boxes * box.height_m))
    if box.box is not None:
        largest = max(case.stack[-1].top, *(own.width for own in case.stack))
    if size < 1.0 or size <= 2.0 * largest:
        return ""
    guess = q.ELEMENT_SIZE.guess(size, lambda meant: meant <= largest) or "0.1 m is usual"
    return f"must be at most twice the largest dimension ({largest:g} m), got {size:g} m; {guess}"


def _tapers_beyond_the_run(case: Any, table: str) -> str:
    """Why the tapers of a harmonic motion that ends with the run are longer than that."""
    motion = getattr(case, table)
    if motion.omega is None or motion.cycles is not None:
        return ""
    tapered = 2.0 * motion.ramp_cycles * 2.0 * math.pi / motion.omega
    if tapered <= longest_time(case):
        return ""
    return (
        f"= {motion.ramp_cycles:g} tapers {tapered:g} s in all, more than {duration_in_words(case)}; take fewer or a "
        "longer run"
    )


def _begins_behind_the_run(case: Any, table: str) -> str:
    """Why a pulse begins after the end of the run."""
    motion = getattr(case, table)
    if motion.kind != "pulse" or motion.delay_s < longest_time(case):
        return ""
    return (
        f"must be less than {duration_in_words(case)}, got {motion.delay_s:g} s: the pulse would begin after the end "
        "of the run"
    )


def _too_many_samples(case: Any) -> str:
    """Why the history takes more than memory has."""
    samples = longest_time(case) / float(case.output.history_s) + 1.0
    size = 8.0 * len(history_columns(case))  # bytes of a sample
    most = min(MOST_SAMPLES, MOST_HISTORY / size)
    if samples <= most:
        return ""
    return (
        f"= {case.output.history_s:g} s makes {samples:.3g} samples of {duration_in_words(case)}, "
        f"{size * samples / 1e9:.2g} GB in memory and some {2.4 * size * samples / 1e9:.2g} GB of text; "
        f"at most {most:.1g} are kept: take a longer interval"
    )


def _too_many_frames(case: Any) -> str:
    """Why there are more frames than a disk has room for."""
    interval = case.output.fields_s
    frames = longest_time(case) / float(interval) + 1.0 if interval not in (0.0, "auto") else 0.0
    if frames <= MOST_FRAMES:
        return ""
    return (
        f"= {interval:g} s makes {frames:.3g} frames of {duration_in_words(case)}, more than {MOST_FRAMES:.0e}; take a "
        "longer interval, or 0 for none"
    )


def _posts_do_not_fit(case: Any) -> str:
    """Why posts do not fit into the boxes, empty where they do."""
    if case.container.post_m is None or case.container.section != "shell":
        return ""
    width, wall = case.container.post_m
    boxes = case.stack
    narrowest = min(case.container.depth_m, *(box.width for box in boxes))
    if 2.0 * wall > width:
        return f"must be [width, wall] with a wall of at most half the width, got {case.container.post_m}"
    if 2.0 * width >= narrowest:
        return f"= {case.container.post_m}: two posts must leave room in {narrowest:g} m, the least of width and depth"
    return ""


def _casting_does_not_fit(case: Any) -> str:
    """Why castings do not fit below the base, empty where they do."""
    if case.support.casting_m is None:
        return ""
    width, depth, inset = case.support.casting_m
    if case.support.kind != "corners":
        return f'belongs to support.kind = "corners", got "{case.support.kind}"; leave it out'
    if width <= 0.0 or depth <= 0.0:
        return f"must be [width, depth, inset] with a positive width and depth, got {case.support.casting_m}"
    if case.floor.corner_patch_m is not None:
        return "and floor.corner_patch_m both say what bears under a corner; keep one of them"
    half = 0.5 * case.stack[0].width
    if inset + width > half or 2.0 * depth > case.container.depth_m:
        return (
            f"= {case.support.casting_m} does not fit under the base: inset and width at most half of width_m = "
            f"{half:g} m, two depths at most depth_m = {case.container.depth_m:g} m"
        )
    return ""


CASE_RULES = (
    *FLOOR_CASE_RULES,
    *BOX_RULES,
    *JOINT_RULES,
    *WEAKENING_RULES,
    *LINK_RULES,
    *NEIGHBOUR_RULES,
    *(refused(f"container.{key}", partial(_implausible, key=key)) for key in ("weight_N", "mass_kg")),
    *left_out(
        lambda case: case.support.camber_m > 0.0,
        {
            "contact.restitution_over_housner": "does not apply to support.camber_m > 0: a cambered base rolls, and "
            "its feet do not strike at their corners; leave it out"
        },
    ),
    refused("support.casting_m", _casting_does_not_fit),
    refused("container.post_m", _posts_do_not_fit),
    *left_out(
        lambda case: case.support.kind != "corners",
        {
            "container.corner_post_N": 'belongs to support.kind = "corners", where a post stands above each; leave it '
            'out, or take "corners"'
        },
    ),
    Rule(
        "support.foot_m",
        lambda case: case.support.kind != "feet" or case.support.foot_m < 0.5 * case.stack[0].width,
        lambda case: (
            f"must be less than half of width_m = {case.stack[0].width:g} m, got {case.support.foot_m:g} m; "
            + (
                q.FOOT.guess(case.support.foot_m, lambda meant: meant < 0.5 * case.stack[0].width)
                or 'for a base that bears all along take kind = "flat"'
            )
        ),
    ),
    refused("solver.element_size_m", _coarse),
    Rule(
        "solver.step_s",
        lambda case: case.solver.step_s == "auto" or longest_time(case) / case.solver.step_s <= MOST_STEPS,
        lambda case: (
            f"= {case.solver.step_s:g} s makes {longest_time(case) / case.solver.step_s:.3g} steps of "
            f'{duration_in_words(case)}, more than {MOST_STEPS:.0e}; take a longer step or "auto"'
        ),
    ),
    *(
        refused(f"{table}.{key}", partial(says, table=table))
        for table in ("motion", "vertical")
        for key, says in (("ramp_cycles", _tapers_beyond_the_run), ("delay_s", _begins_behind_the_run))
    ),
    Rule(
        "vertical.file",
        lambda case: (
            case.vertical.kind != "table" or case.vertical.file is not None or case.motion.kind == "table"
        ),
        'is missing: kind = "table" needs file, or a motion.file with a vertical component',
    ),
    Rule(
        "support.effective_width",
        lambda case: (
            case.solver.model != "full"
            or (case.support.effective_width == 1.0 and (case.support.casting_m or (0.0,))[-1] == 0.0)
        ),
        "(or an inset of casting_m) belongs to the rigid and the reduced model: the full model bears where its nodes "
        "are; change width_m",
    ),
    refused("output.history_s", _too_many_samples),
    refused("output.fields_s", _too_many_frames),
)
