"""What ties several keys of a case together: one small rule each.

A rule takes a table (or the whole case), reads its keys, and returns a `Problem` or None. It reads
nothing but keys, so that it can also judge a case in which other keys are wrong: a rule that asks for
a key that could not be read is left out, all others still speak, and one look at the messages of a
file is enough to mend it.
"""

import math
from typing import Any

from fem.case import quantities as q
from fem.case.motion_rules import harmonic_angular_frequency
from fem.case.problem import Problem, Rule, leaves_the_folder

MOST_SAMPLES = 2e7
MOST_HISTORY = 2.6e9  # bytes in memory: so many samples of a single box
MOST_FRAMES = 1e6
MOST_STEPS = 1e9


# [container]


def one_of_weight_and_density(container: Any) -> Problem | None:
    """The mass of a box is given once."""
    given = [key for key in ("weight_N", "density_kg_m3") if getattr(container, key) is not None]
    if len(given) == 1:
        return None
    what = "none is given" if not given else f"both are given ({container.weight_N:g} N, "
    what += "" if not given else f"{container.density_kg_m3:g} kg/m3)"
    return Problem(key="weight_N", reason=f"or density_kg_m3: exactly one of the two must be given, {what}")


def shell_has_a_wall(container: Any) -> Problem | None:
    """A shell needs its wall thickness."""
    if container.section == "solid" or container.wall_m is not None:
        return None
    return Problem(key="wall_m", reason='is missing: section = "shell" needs the wall thickness, in m')


def walls_fit_into_the_box(container: Any) -> Problem | None:
    """Opposite walls leave room between them."""
    wall = container.wall_m
    smallest = min(container.width_m, container.height_m, container.depth_m)
    if container.section == "solid" or wall is None or 2.0 * wall < smallest:
        return None
    guess = q.WALL.guess(wall, lambda meant: 2.0 * meant < smallest)
    way_out = guess or 'for a full block take section = "solid"'
    return Problem(
        key="wall_m",
        reason=f"must be less than half the smallest outer dimension, {smallest:g} m, "
        f"got {wall:g} m; {way_out}",
    )


def box_is_neither_needle_nor_plate(container: Any) -> Problem | None:
    """Width over height of one box within what the program has been tried on."""
    ratio = container.width_m / container.height_m
    if 0.02 * (1.0 - 1e-9) <= ratio <= 20.0 * (1.0 + 1e-9):
        return None
    return Problem(
        key="width_m",
        reason=f"over height_m must lie between 0.02 and 20, got {container.width_m:g} m / "
        f"{container.height_m:g} m = {ratio:g}; are both in metres?",
    )


def mass_centre_lies_in_the_box(container: Any) -> Problem | None:
    """The mass centre is above the bottom and below the lid."""
    centroid, height = container.centroid_m, container.height_m
    if centroid < height:
        return None
    guess = q.LENGTH.guess(centroid, lambda meant: meant < height)
    way_out = guess or "it is measured from the bottom of one box"
    return Problem(
        key="centroid_m", reason=f"must be less than height_m = {height:g} m, got {centroid:g} m; {way_out}"
    )


def mesh_file_stays_beside_the_case(container: Any) -> Problem | None:
    """A mesh is read from the folder of the case file or below it."""
    return leaves_the_folder("mesh_file", container.mesh_file)


# [contact]


def kinetic_friction_is_not_above_static(contact: Any) -> Problem | None:
    """What slides is held back by no more than what rests."""
    if contact.mu_kinetic <= contact.mu_static:
        return None
    return Problem(
        key="mu_kinetic",
        reason=f"must be at most mu_static = {contact.mu_static:g}, got {contact.mu_kinetic:g}; "
        "leave it out where the two are equal",
    )


# [solver]


def newmark_is_unconditionally_stable(solver: Any) -> Problem | None:
    """2 beta >= gamma >= 1/2: stable for every step (Hughes, The Finite Element Method, 1987, 9.1.2)."""
    beta, gamma = solver.newmark_beta, solver.newmark_gamma
    if solver.scheme != "newmark" or 2.0 * beta >= gamma:
        return None
    return Problem(
        key="newmark_beta",
        reason=f"must be at least newmark_gamma/2 = {gamma / 2.0:g} to be stable at every step, "
        f"got {beta:g}; 1/4 and 1/2 are usual",
    )


def steps_can_be_counted(solver: Any) -> Problem | None:
    """A largest step so small that the run would not end."""
    if solver.step_s == "auto" or solver.duration_s / solver.step_s <= MOST_STEPS:
        return None
    return Problem(
        key="step_s",
        reason=f"= {solver.step_s:g} s makes {solver.duration_s / solver.step_s:.3g} steps of duration_s = "
        f'{solver.duration_s:g} s, more than {MOST_STEPS:.0e}; take a longer step or "auto"',
    )


# the whole case


def weight_fits_the_volume(case: Any) -> Problem | None:
    """The mean density that follows from weight and outer dimensions is that of a container."""
    box = case.container
    if box.weight_N is None:
        return None
    volume = box.width_m * box.height_m * box.depth_m

    def density(weight: float) -> float:
        return float(weight / (case.gravity_m_s2 * volume))

    if q.DENSITY.allows(density(box.weight_N)):
        return None
    slips = {"kilonewtons": 1e3, "tonnes": 1e3 * case.gravity_m_s2, "kilograms": case.gravity_m_s2}
    weights = q.Quantity(unit="N", typical=2e3 * case.gravity_m_s2 * volume, slips=slips)
    guess = weights.guess(box.weight_N, lambda weight: q.DENSITY.allows(density(weight)))
    return Problem(
        table="container",
        key="weight_N",
        reason=f"= {box.weight_N:g} N on {box.width_m:g} x {box.depth_m:g} x {box.height_m:g} m is a mean "
        f"density of {density(box.weight_N):.3g} kg/m3, it must be {q.DENSITY.range_in_words} kg/m3; "
        + (guess or "are all dimensions in metres?"),
    )


def feet_fit_under_the_box(case: Any) -> Problem | None:
    """Two feet stand side by side; when they touch, the base is flat."""
    foot, width = case.support.foot_m, case.container.width_m
    if case.support.kind != "feet" or foot < 0.5 * width:
        return None
    guess = q.FOOT.guess(foot, lambda meant: meant < 0.5 * width)
    return Problem(
        table="support",
        key="foot_m",
        reason=f"must be less than half of width_m = {width:g} m, got {foot:g} m; "
        + (guess or 'for a base that bears all along take kind = "flat"'),
    )


def elements_are_smaller_than_the_container(case: Any) -> Problem | None:
    """An element of a metre and more, and larger than the container, is a slip of the unit."""
    size, box = case.solver.element_size_m, case.container
    largest = max(box.width_m, box.boxes * box.height_m)
    if size < 1.0 or size <= 2.0 * largest:
        return None
    guess = q.ELEMENT_SIZE.guess(size, lambda meant: meant <= largest)
    return Problem(
        table="solver",
        key="element_size_m",
        reason=f"must be at most twice the largest dimension ({largest:g} m), got {size:g} m; "
        + (guess or "0.1 m is usual"),
    )


def ramps_fit_into_the_run(case: Any) -> Problem | None:
    """Without `cycles` the second taper ends with the run."""
    motion, duration = case.motion, case.solver.duration_s
    frequency = harmonic_angular_frequency(motion)
    if frequency is None or motion.cycles is not None:
        return None
    tapered = 2.0 * motion.ramp_cycles * 2.0 * math.pi / frequency
    if tapered <= duration:
        return None
    return Problem(
        table="motion",
        key="ramp_cycles",
        reason=f"= {motion.ramp_cycles:g} tapers {tapered:g} s in all, more than duration_s = "
        f"{duration:g} s; take fewer or a longer run",
    )


def pulse_begins_within_the_run(case: Any) -> Problem | None:
    """A pulse after the end would be a run without motion."""
    motion, duration = case.motion, case.solver.duration_s
    if motion.kind != "pulse" or motion.delay_s < duration:
        return None
    return Problem(
        table="motion",
        key="delay_s",
        reason=f"must be less than duration_s = {duration:g} s, got {motion.delay_s:g} s: "
        "the pulse would never come",
    )


def history_fits_into_memory(case: Any) -> Problem | None:
    """The samples of the history can be held."""
    samples = case.solver.duration_s / case.output.history_s + 1.0
    columns = 16 + 3 * (case.container.boxes - 1)  # three for every joint of a stack
    size = 8.0 * columns * samples
    if samples <= MOST_SAMPLES and size <= MOST_HISTORY:
        return None
    return Problem(
        table="output",
        key="history_s",
        reason=f"= {case.output.history_s:g} s makes {samples:.3g} samples of duration_s = "
        f"{case.solver.duration_s:g} s, {size / 1e9:.2g} GB in memory and some {2.4 * size / 1e9:.2g} GB of text; "
        f"at most {min(MOST_SAMPLES, MOST_HISTORY / (8.0 * columns)):.1g} are kept: take a longer interval",
    )


def frames_can_be_kept(case: Any) -> Problem | None:
    """One file a frame: a number of files that a folder can hold."""
    if case.output.fields_s == 0.0:
        return None
    frames = case.solver.duration_s / case.output.fields_s + 1.0
    if frames <= MOST_FRAMES:
        return None
    return Problem(
        table="output",
        key="fields_s",
        reason=f"= {case.output.fields_s:g} s makes {frames:.3g} frames of duration_s = "
        f"{case.solver.duration_s:g} s, more than {MOST_FRAMES:.0e}; take a longer interval, or 0 for none",
    )


RULES_OF_A_CASE: tuple[Rule, ...] = (
    weight_fits_the_volume,
    feet_fit_under_the_box,
    elements_are_smaller_than_the_container,
    ramps_fit_into_the_run,
    pulse_begins_within_the_run,
    history_fits_into_memory,
    frames_can_be_kept,
)
