"""Stills of the motion, for paper and for browsers that run no scripts: the container at a few instants, as SVG.

Same colours, same exaggeration of the elastic part as the animation first shows; x to the right, z up.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from fem.report.animation import Film, Split, exaggeration
from fem.results.history import History
from fem.runtime.arrays import FloatArray

MOST = 6
BINS = 14  #: colours of a still
#: of the stresses, from low to high: YlGnBu of Cynthia Brewer (colorbrewer2.org), darker and darker for anyone's eyes
SCALE = ("ffffd9", "edf8b1", "c7e9b4", "7fcdbb", "41b6c4", "1d91c0", "225ea8", "253494", "081d58")
STEEL, INK, QUIET = "#dfe7ee", "#1c2330", "#55606f"


@dataclass(frozen=True, kw_only=True)
class Still:
    """The container at one instant."""

    caption: str
    svg: Markup


def colours(count: int) -> list[str]:
    """The colour scale of the stresses, from low to high, as hexadecimal codes."""
    known = np.array([list(bytes.fromhex(colour)) for colour in SCALE], dtype=float)
    places = np.linspace(0.0, len(SCALE) - 1.0, count)
    channels = [np.interp(places, range(len(SCALE)), channel) for channel in known.T]
    return ["#" + bytes(np.rint(colour).astype(np.uint8)).hex() for colour in np.transpose(channels)]


def stills(
    film: Film, history: History, verdict: Mapping[str, Any], *, angle: float, width: float, height: float
) -> list[Still]:
    """Start, first uplift, the extremes and the end, as far as frames show them and there was such a motion.

    Args:
        film: what is shown.
        history: of the run.
        verdict: of the run.
        angle: slenderness angle [rad].
        width, height: of the container [m].
    """
    chosen = _instants(film, history, verdict)
    if not chosen:
        return []
    factor = exaggeration(film, height)
    span = max(float(np.abs(_placed(film, film.frames[k], factor)[:, 0]).max()) for k in chosen)
    span = max(span, 0.7 * width) * 1.05
    top = max(float(_placed(film, film.frames[k], factor)[:, 1].max()) for k in chosen) * 1.03
    return [
        Still(
            caption=_caption(film.frames[k], names, angle),
            svg=_drawing(film, film.frames[k], factor, span=span, top=top),
        )
        for k, names in chosen.items()
    ]


def _instants(film: Film, history: History, verdict: Mapping[str, Any]) -> dict[int, str]:
    """Frames to show, in the order of time, and why."""
    if not film.frames or not len(history):
        return {}
    times = np.array([frame.time for frame in film.frames])
    turned = np.array([frame.rotation for frame in film.frames])
    slip = np.interp(times, history["time_s"], history["slip_m"])
    wanted = [(0, "start")]
    uplift = verdict.get("first_uplift_s")
    if uplift is not None:
        wanted.append((int(np.searchsorted(times, uplift)), "after the first uplift"))
    seen = {verdict.get("outcome"), *(verdict.get("modes") or ())}
    if seen & {"rock", "slide-rock", "overturned"}:
        wanted.append((int(np.argmax(turned)), "farthest to the right"))
        wanted.append((int(np.argmin(turned)), "farthest to the left"))
    if seen & {"slide", "slide-rock"}:
        wanted.append((int(np.argmax(np.abs(slip))), "largest slip"))
    wanted.append((len(times) - 1, "last frame"))
    chosen: dict[int, str] = {}
    for k, name in wanted:
        if k < len(times) and len(chosen) < MOST:
            chosen.setdefault(k, name)
    return dict(sorted(chosen.items()))


def _caption(frame: Split, name: str, angle: float) -> str:
    ratio = f"{round(frame.rotation / angle, 3) + 0.0:.3f}".replace("-", "−")  # never −0.000
    return f"t = {frame.time:.3f} s, {name}; rotation ratio {ratio}"


def _placed(film: Film, frame: Split, factor: float) -> FloatArray:
    """Drawn nodes (n, 2), x from where the container first stood on the floor [m]."""
    weight = np.maximum(frame.normal_force, 0.0) + 1e-6 * max(1.0, float(np.abs(frame.normal_force).max()))
    held = np.average(frame.elastic[film.contact], axis=0, weights=weight) if factor else np.zeros(2)
    arm = film.points + factor * frame.elastic - (factor - 1.0) * held if factor else film.points
    cosine, sine = math.cos(frame.rotation), math.sin(frame.rotation)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    placed: FloatArray = frame.centre - np.array([frame.floor, 0.0]) + arm @ turn
    return placed


def _drawing(film: Film, frame: Split, factor: float, *, span: float, top: float) -> Markup:
    scale = 100.0 / span
    points = _placed(film, frame, factor) * [scale, -scale]
    parts = [
        f'<path d="M-104 0H104" stroke="{INK}" stroke-width="1.2"/>',
        '<path d="'
        + "".join(f"M{x} 0l-4 4" for x in range(-96, 108, 12))
        + f'" stroke="{QUIET}" stroke-width=".6"/>',
        *_cells(film, frame, points),
        _edges(film, points),
    ]
    high = scale * top
    return Markup(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-105 {-high - 2.0:.1f} 210 {high + 8.0:.1f}" fill="none" '
        f'role="img" aria-label="container at {frame.time:.3f} s">{"".join(parts)}</svg>'
    )


def _cells(film: Film, frame: Split, points: FloatArray) -> list[str]:
    """Cells by colour: one path each."""
    if not len(film.quads):
        return []
    if film.stress_scale > 0.0 and frame.von_mises is not None:
        level = frame.von_mises[film.quads].mean(axis=1) / film.stress_scale
        bins = np.clip((BINS * level).astype(int), 0, BINS - 1)
        paints = colours(BINS)
    else:
        bins, paints = np.zeros(len(film.quads), dtype=int), [STEEL]
    return [
        f'<path d="{"".join(_outline(points[quad]) for quad in film.quads[bins == k])}" '
        f'fill="{paints[k]}" stroke="{paints[k]}" stroke-width=".3"/>'
        for k in np.unique(bins)
    ]


def _outline(corners: FloatArray) -> str:
    return "M" + "L".join(f"{x:.1f} {z:.1f}" for x, z in corners) + "Z"


def _edges(film: Film, points: FloatArray) -> str:
    path = "".join(
        f"M{points[a, 0]:.1f} {points[a, 1]:.1f}L{points[b, 0]:.1f} {points[b, 1]:.1f}" for a, b in film.edges
    )
    return f'<path d="{path}" stroke="{INK}" stroke-width=".7"/>'
