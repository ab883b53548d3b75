"""Stills of the motion, for paper and for browsers that run no scripts: the container at a few instants, as SVG.

Same colours, same exaggeration of the elastic part as the animation first shows, less in an impact; x to the right, z
up.
"""

import math
from typing import NamedTuple

import numpy as np
from markupsafe import Markup

from fem.assessment.verdict import relative_rotation
from fem.report.animation import Animation, AnimationFrame, colour_scale, exaggeration, round_down
from fem.results.history import History
from fem.results.outcome import ROCKING, SLIDING, Outcome
from fem.results.run_result import Verdict
from fem.runtime.arrays import FloatArray
from fem.runtime.units import MILLIMETRES, RATIO

MOST = 6
MOST_ELASTIC = 0.05  #: enlarged elastic part over the height of the container
BINS = 14  #: colours of a still
STEEL, INK, QUIET, WALL = "#dfe7ee", "#1c2330", "#55606f", "#c9c4bc"


class Still(NamedTuple):
    """The container at one instant."""

    caption: str
    svg: Markup


def stills(
    animation: Animation, history: History, verdict: Verdict, *, angle: float, width: float, height: float
) -> list[Still]:
    """Start, first uplift, the extremes and the end, where frames show them and there was such a motion.

    Args:
        animation: of the run.
        history, verdict: of the run.
        angle: slenderness angle [rad].
        width, height: of the container [m].
    """
    judged = 1 if verdict.neighbours else None  # in a row the container itself, which is the first
    chosen = _instants(animation, history, verdict, judged)
    factor = exaggeration(animation, height)
    frames = {k: animation.frames[k] for k in chosen}
    factors = {k: _bearable(frame, factor, height) for k, frame in frames.items()}
    placed = {k: _placed(animation, frame, factors[k]) for k, frame in frames.items()}
    walls = [abs(link.outer) for link in animation.links]
    span = 1.05 * max(
        [0.7 * width, *walls, *(float(np.abs(points[:, 0]).max()) for points in placed.values())]
    )
    top = 103.0 / span * max((float(points[:, 1].max()) for points in placed.values()), default=0.0)
    return [
        Still(
            f"t = {frame.time:.3f} s, {chosen[k]}; {_rotation_in_words(frame.rotation[:judged], angle)}"
            + (f"; elastic part × {factors[k]:g}" if factors[k] != factor else ""),
            _drawing(animation, frame, placed[k] * [100.0 / span, -100.0 / span], top, 100.0 / span),
        )
        for k, frame in frames.items()
    ]


def _bearable(frame: AnimationFrame, factor: float, height: float) -> float:
    """The exaggeration, or a smaller one where an impact would tear the drawing."""
    largest = float(np.hypot(*frame.elastic.T).max(initial=0.0))
    most = MOST_ELASTIC * height
    return factor if factor * largest <= most else max(1.0, round_down(most / largest))


def _instants(
    animation: Animation, history: History, verdict: Verdict, judged: int | None = None
) -> dict[int, str]:
    """Frames to show, in the order of time, and why, by the rotation of the first `judged` bodies; None: all."""
    if not animation.frames or not len(history):
        return {}
    times = np.array([frame.time for frame in animation.frames])
    rotation = np.array([frame.rotation[_most_turned(frame.rotation[:judged])] for frame in animation.frames])
    # a loose box each
    slips = [np.abs(history[name]) for name in history.numbers if name.endswith("slip_m")][:judged]
    slip = np.interp(times, history["time_s"], np.max(slips, axis=0))
    candidates = [(0, "start")]
    if verdict.first_uplift_s is not None:
        candidates.append((int(np.searchsorted(times, verdict.first_uplift_s)), "after the first uplift"))
    seen = {verdict.outcome, *verdict.modes}
    if not seen.isdisjoint((*ROCKING, Outcome.OVERTURNED)):
        candidates.append((int(np.argmax(rotation)), "farthest to the right"))
        candidates.append((int(np.argmin(rotation)), "farthest to the left"))
    if not seen.isdisjoint(SLIDING) or (verdict.max_joint_slip_m or 0.0) > MILLIMETRES.least:
        candidates.append((int(np.argmax(slip)), "largest slip"))
    chosen: dict[int, str] = {}
    for k, name in [*candidates, (len(times) - 1, "last frame")]:
        if k < len(times) and len(chosen) < MOST:
            chosen.setdefault(k, name)
    return dict(sorted(chosen.items()))


def _most_turned(rotation: FloatArray) -> int:
    """The body with the largest rotation."""
    return int(np.argmax(np.abs(rotation)))


def _rotation_in_words(rotations: FloatArray, angle: float) -> str:
    """The rotation ratio, of a loose stack that of the box that has turned most."""
    most = _most_turned(rotations)
    ratio, box = RATIO.text(relative_rotation(rotations[most], angle)), f" (box {most + 1})"
    sign = "−" if rotations[most] < 0.0 and not ratio.startswith("<") else ""
    named = len(rotations) > 1 and not ratio.startswith("<") and ratio != "0"
    return f"rotation ratio {sign}{ratio}{box if named else ''}"


def _placed(animation: Animation, frame: AnimationFrame, factor: float) -> FloatArray:
    """Drawn nodes (n, 2), x from where the container first stood on the floor [m].

    An enlarged elastic part leaves the loaded points in place; a loose box stands on the corners of the one below.
    """
    weight = np.maximum(frame.normal_force, 0.0) + 1e-6 * max(1.0, float(np.abs(frame.normal_force).max()))
    placed, ahead = np.empty_like(animation.points), np.zeros(2)
    for k, (centre, rotation) in enumerate(zip(frame.centre, frame.rotation, strict=True)):
        own, corners = animation.body == k, animation.corners[k]
        ahead = ahead * (not animation.in_a_row)
        cosine, sine = math.cos(rotation), math.sin(rotation)
        turn = np.array([[cosine, -sine], [sine, cosine]])
        arm = animation.points[own]
        if factor:
            arm = arm + factor * frame.elastic[own]
            held = frame.elastic[corners[:2]].mean(axis=0)
            if k == 0:
                held = np.average(frame.elastic[animation.contact], axis=0, weights=weight)
            ahead = ahead - (factor - 1.0) * held @ turn
        placed[own] = centre - frame.floor + ahead + arm @ turn
        if factor:
            ahead = ahead + (factor - 1.0) * frame.elastic[corners[2:]].mean(axis=0) @ turn
    return placed


def _drawing(
    animation: Animation, frame: AnimationFrame, points: FloatArray, top: float, scale: float
) -> Markup:
    """Floor, stops and ties, cells by colour (one path a colour) and edges."""
    hatch = "".join(f"M{x} 0l-4 4" for x in range(-96, 108, 12))
    parts = [_path("M-104 0H104", stroke=INK, width=1.2), _path(hatch, stroke=QUIET, width=0.6)]
    for link, (node, other) in zip(animation.links, animation.held, strict=True):
        if frame.time < link.until:
            foot = np.array([(link.x, 0.0), (link.outer, 0.0)]) * [scale, 1.0]
            end = (foot - [0.0, scale * link.height])[::-1]
            if link.anchor is not None:
                foot, end = scale * np.array([(link.outer, -link.anchor)]), points[[node]]
                if link.joins:
                    foot = points[[other]]
            parts.append(
                _path("M" + _line(np.concatenate([foot, end])) + "Z", stroke=INK, width=1.0, fill=WALL)
            )
    bins, paints = np.zeros(len(animation.quads), dtype=int), [STEEL]
    if animation.stress_scale > 0.0 and frame.von_mises is not None:
        level = frame.von_mises[animation.quads].mean(axis=1) / animation.stress_scale
        bins, paints = np.clip((BINS * level).astype(int), 0, BINS - 1), colour_scale("YlGnBu", BINS)
    for k in np.unique(bins):
        cells = "".join("M" + _line(points[quad]) + "Z" for quad in animation.quads[bins == k])
        parts.append(_path(cells, stroke=paints[k], width=0.3, fill=paints[k]))
    parts.append(_path("".join("M" + _line(points[edge]) for edge in animation.edges), stroke=INK, width=0.7))
    return Markup(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-105 {-top - 2.0:.1f} 210 {top + 8.0:.1f}" '
        f'role="img" aria-label="container at {frame.time:.3f} s">{"".join(parts)}</svg>'
    )


def _line(points: FloatArray) -> str:
    return "L".join(f"{x:.1f} {z:.1f}" for x, z in points)


def _path(data: str, *, stroke: str, width: float, fill: str = "none") -> str:
    return f'<path d="{data}" stroke="{stroke}" stroke-width="{width:g}" fill="{fill}"/>'
