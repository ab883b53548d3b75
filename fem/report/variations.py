"""The variations in the report of a run: friction, impacts, penalty, phase, vertical motion, start, strength.

None of these is known exactly. Every variation changes one thing. Where there is time for some of them only, one of
each subject comes first, and moderate changes come before large ones.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fem.case.case import Case
from fem.case.strength import scaled_motion
from fem.case.uncertainty import apart_from_floor
from fem.html.units import degrees, quantity, short

FRICTION_FACTORS = (0.5, 0.75, 1.25, 1.5)
DAMPING_RATIOS = (0.5, 1.0, 2.0, 4.0)
RESTITUTION_FACTORS = (0.9, 0.95)
SLAB_FACTORS = (0.5, 2.0)  #: on strength and stiffness of a slab
PENALTY_FACTORS = (1.0 / 3.0, 3.0)
PHASES = (0.25, 0.5, 0.75)  #: of half a turn; a whole half turn is the mirror image
STRENGTHS = (0.8, 0.9, 1.1, 1.25, 1.5, 2.0)
ROTATIONS = (0.9, 1.1)


@dataclass(frozen=True, kw_only=True)
class Variation:
    """One thing that is changed, and to what."""

    subject: str
    change: str  #: for people
    values: Mapping[str, Any]  #: dotted keys; none: the run as computed

    @property
    def command(self) -> str:
        """The options that make this run from its resolved case."""
        return " ".join(f"--set {key}={value!r}".replace("'", "") for key, value in self.values.items())


def variations_of(case: Case) -> Iterator[Variation]:
    """The variations, in the order of the table."""
    contact, motion, initial = case.contact, case.motion, case.initial
    for factor in FRICTION_FACTORS:
        static, kinetic = (round(factor * mu, 6) for mu in (contact.mu_static, contact.mu_kinetic))
        yield Variation(
            subject="friction",
            change=f"μₛ {short(static)}, μₖ {short(kinetic)} (× {factor:g})",
            values=apart_from_floor(case, {"contact.mu_static": static, "contact.mu_kinetic": kinetic}),
        )
    for factor in FRICTION_FACTORS if case.container.is_loose else ():
        between = case.joint_friction
        static, kinetic = (round(factor * between[name], 6) for name in ("mu_static", "mu_kinetic"))
        yield Variation(
            subject="friction between boxes",
            change=f"μₛ {short(static)}, μₖ {short(kinetic)} (× {factor:g})",
            values={"joints.mu_static": static, "joints.mu_kinetic": kinetic},
        )
    if (restitution := contact.restitution_over_housner) is not None:
        for factor in RESTITUTION_FACTORS:
            yield Variation(
                subject="restitution",
                change=f"{short(factor * restitution)} of Housner's (× {factor:g})",
                values={"contact.restitution_over_housner": round(factor * restitution, 6)},
            )
    if case.floor.is_slab:
        for name, key in (
            ("bearing strength", "bearing_strength_Pa"),
            ("stiffness of the floor", "youngs_modulus_Pa"),
        ):
            for factor in SLAB_FACTORS:
                values = {f"floor.{key}": factor * getattr(case.floor, key)}
                yield Variation(subject=name, change=f"× {factor:g}", values=values)
        yield Variation(subject="floor", change="rigid, with elastic impacts", values={"floor.kind": "rigid"})
    for ratio in DAMPING_RATIOS if not case.floor.is_slab else ():
        if contact.damping_ratio not in (None, ratio):
            yield Variation(
                subject="contact damping", change=f"ratio {ratio:g}", values={"contact.damping_ratio": ratio}
            )
    if not isinstance(contact.normal_penalty_Pa_m, str):
        for factor in PENALTY_FACTORS:
            yield Variation(
                subject="contact penalty",
                change=f"× {'1/3' if factor < 1.0 else '3'}",
                values={"contact.normal_penalty_Pa_m": factor * contact.normal_penalty_Pa_m},
            )
    if motion.kind == "harmonic":
        for share in PHASES:
            phase = math.remainder(motion.phase_rad + share * math.pi, 2.0 * math.pi)
            yield Variation(
                subject="phase of the floor", change=degrees(phase, 3), values={"motion.phase_rad": phase}
            )
    if motion.kind != "none":
        start = "rest" if motion.start == "moving" else "moving"
        words = {"rest": "the floor starts with its velocity", "moving": "it moves with the floor"}
        yield Variation(subject="start", change=f"{start}: {words[start]}", values={"motion.start": start})
    if case.has_vertical:
        key = "scale" if case.vertical.scale_to_m_s2 is None else "scale_to_m_s2"
        other = {f"vertical.{key}": -getattr(case.vertical, key)}
        yield Variation(subject="vertical motion", change="the other sign", values=other)
        yield Variation(subject="vertical motion", change="none", values={"vertical.kind": "none"})
    if initial.rotation_rad != 0.0:
        for factor in ROTATIONS:
            rotation = factor * initial.rotation_rad
            yield Variation(
                subject="start",
                change=f"from {degrees(rotation)} (× {factor:g})",
                values={"initial.rotation_rad": rotation},
            )
    yield from _strengths(case)


def _strengths(case: Case) -> Iterator[Variation]:
    """The floor's motions made stronger and weaker: the factor at which it overturns is the margin."""
    peak = case.nominal_peak_acceleration
    for factor in STRENGTHS:
        shown = f", peak {quantity(factor * peak, 'm/s²', figures=3)}" if peak else ""
        both = ", both motions" if case.has_vertical and case.motion.kind != "none" else ""
        if values := scaled_motion(case, factor):
            yield Variation(subject="strength", change=f"× {factor:g}{shown}{both}", values=values)


def by_importance(variations: Sequence[Variation]) -> list[int]:
    """Indices of variations, the more important first."""
    subjects: dict[str, list[int]] = {}
    for index, one in enumerate(variations):
        subjects.setdefault(one.subject, []).append(index)
    ranked = []
    for indices in subjects.values():
        middle = 0.5 * (indices[0] + indices[-1])
        ranked += [(turn, index) for turn, index in enumerate(sorted(indices, key=lambda i: abs(i - middle)))]
    return [index for _, index in sorted(ranked)]
