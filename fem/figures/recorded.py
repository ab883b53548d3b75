"""Figure of the recorded motions of a run: their response spectra."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fem.case.case import CaseError
from fem.case.recorded import MotionKey, recorded_motion
from fem.figures.canvas import Canvas
from fem.figures.style import (
    BLUE,
    GREEN,
    VERMILLION,
    head,
    legend_above,
    number,
    panels,
    spectrum_axes,
)
from fem.records.processing import motion_of
from fem.records.record import Component
from fem.records.spectrum import Spectrum, evenly_sampled, log_spaced_periods, response_spectrum
from fem.results.reader import OpenedRun

if TYPE_CHECKING:
    from fem.figures.style import AnyAxes

COLOURS = (BLUE, VERMILLION, GREEN)
LINES = ("-", "--", ":")
DAMPED = "pseudo-acceleration, 5 % of critical damping"


def spectrum_of(component: Component) -> Spectrum:
    """Response spectrum of a processed component, for 5 % of damping, from what its samples resolve up to 4 s."""
    step, values = evenly_sampled(component.times, motion_of(component)[2])
    return response_spectrum(step, values, log_spaced_periods(component.step))


def spectrum_figure(run: OpenedRun) -> Canvas | None:
    """Response spectra of the records that move the floor of a run; None where none does, or its file is gone."""
    case = run.case
    tables: dict[MotionKey, str] = {"motion": "along x", "vertical": "upward"}
    try:
        found = [
            (name, recorded_motion(case, table).motion)
            for table, name in tables.items()
            if getattr(case, table).kind == "table"
        ]
    except CaseError:
        return None
    if not found:
        return None
    figure, (axes,) = panels((2.4,), header=2 + (len(found) > 1))
    draw_record_spectra(axes, found)
    periods, largest = _largest(found[0][1])
    head(
        figure,
        f"Response spectrum of the floor's motion: {number(largest)} m/s² at {number(periods)} s",
        DAMPED,
    )
    return figure


def _largest(component: Component) -> tuple[float, float]:
    spectrum = spectrum_of(component)
    at = int(np.argmax(spectrum.pseudo_acceleration_m_s2))
    return float(spectrum.periods_s[at]), float(spectrum.pseudo_acceleration_m_s2[at])


def draw_record_spectra(axes: "AnyAxes", named: Sequence[tuple[str, Component]]) -> None:
    """Response spectra of processed components with their names."""
    for k, (name, one) in enumerate(named):
        spectrum = spectrum_of(one)
        axes.plot(
            spectrum.periods_s,
            spectrum.pseudo_acceleration_m_s2,
            color=COLOURS[k % len(COLOURS)],
            linestyle=LINES[k % len(LINES)],
            label=name if len(named) > 1 else None,
        )
    spectrum_axes(axes)
    axes.set_ylabel("spectrum [m/s²]")
    axes.set_xlabel("period [s]")
    if len(named) > 1:
        legend_above(axes)
