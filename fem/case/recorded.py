"""The recorded motions of a case: read from its files and processed as its keys say."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fem.case.case import Case
from fem.case.tables import quantities as q
from fem.case.tables.motion_tables import FloorMotionTable
from fem.case.validation import CaseError
from fem.records.files import read_record
from fem.records.processing import Processing, motion_of, processed, stated_baseline
from fem.records.record import Component, Record, RecordError, require_together
from fem.records.units import STANDARD_GRAVITY, UNITS

MotionKey = Literal["motion", "vertical"]  #: the table of a motion: along x, or vertical
#: peak above which a unit that only the case states is refused: hardly any record reaches 3 g [m/s2]
MOST_PEAK = 30.0
#: peaks of a motion that moves a container, and is not beyond almost all records [m/s2]
USUAL_PEAKS = (0.5, 20.0)
WAYS_OUT = ', or set gaps = "bridge" where the motion is meant to go straight on between these samples'


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedMotion:
    """A component of a record as the floor follows it, and its origin."""

    record: Record
    component: Component  #: as the file has it
    motion: Component  #: processed
    notes: tuple[str, ...]  #: doubts about it


def recorded_motion(case: Case, table: MotionKey) -> RecordedMotion:
    """The motion of a table of the case whose kind is "table".

    Raises:
        CaseError: its file is missing, or no motion, or its components do not belong together, or the keys do not fit.
    """
    try:
        recorded = _recorded(case, table)
        if table == "vertical" and case.motion.kind == "table":
            _require_pair(_component(case, "motion"), (recorded.record, recorded.component))
        return recorded
    except RecordError as error:
        raise CaseError(f"[{table}] {error}") from None


def _keys(case: Case, table: MotionKey) -> tuple[FloorMotionTable, FloorMotionTable]:
    """The keys of a table, and those that it shares."""
    keys: FloorMotionTable = case.vertical if table == "vertical" else case.motion
    return keys, case.motion if table == "vertical" and case.motion.kind == "table" else keys


def _component(case: Case, table: MotionKey) -> tuple[Record, Component]:
    """The record of a table, and what it takes of it."""
    keys, shared = _keys(case, table)
    beside = keys if keys.file is not None else shared  # whose keys describe the file
    record, channel = case.recorded, ""
    if record is None:
        file = case.files[f"{table}.file"]
        record = read_record(file.path, unit=beside.unit, sample_interval=beside.sample_interval_s)
        channel = file.channel
    component = record.component(
        "vertical" if table == "vertical" else "horizontal", quantity=keys.quantity, channel=channel
    )
    if beside.gaps is None:
        component.require_no_gap(record.name, WAYS_OUT)
    return record, component


def _recorded(case: Case, table: MotionKey) -> RecordedMotion:
    keys, shared = _keys(case, table)
    record, component = _component(case, table)
    scale = keys.scale
    if keys is not shared and keys.scale_to_m_s2 is None:
        scale *= _factor_to_peak(case)
    processing = Processing(
        start=keys.start_s if keys.start_s is not None else shared.start_s,
        end=keys.end_s if keys.end_s is not None else shared.end_s,
        scale=scale,
        peak=keys.scale_to_m_s2,
        baseline=keys.baseline,
    )
    made = processed(component, processing)
    notes = record.notes
    baseline = stated_baseline(
        record.name,
        component,
        processing,
        allowed=bool(keys.allow_baseline),
        way_out="take another baseline, or set allow_baseline = true (--allow-baseline)",
    )
    if baseline:
        notes += (f"{table}.baseline: {baseline}",)
    if keys.scale_to_m_s2 is None:
        peak = float(np.abs(motion_of(made)[2]).max())
        _require_plausible(record, component, peak, scale)
        notes += _peak_notes(table, component, peak, scale)
    return RecordedMotion(record=record, component=component, motion=made, notes=notes)


def _factor_to_peak(case: Case) -> float:
    """The factor by which [motion] is scaled to a peak, which holds for both components of a recording; else 1."""
    keys = case.motion
    if keys.scale_to_m_s2 is None:
        return 1.0
    made = _recorded(case, "motion")
    of_file = processed(
        made.component,
        Processing(start=keys.start_s, end=keys.end_s, baseline=keys.baseline),
    )
    return abs(keys.scale_to_m_s2) / float(np.abs(motion_of(of_file)[2]).max())


def _require_plausible(record: Record, component: Component, peak: float, scale: float) -> None:
    """Refuse accelerations that no record has, where the file does not state their unit and no factor explains them."""
    unscaled = peak / abs(scale)
    if component.unit_stated or min(peak, unscaled) <= MOST_PEAK:
        return
    meant = (
        f" If they are meant, say so: scale_to_m_s2 = {peak:.4g}" if q.PEAK_ACCELERATION.allows(peak) else ""
    )
    raise RecordError(
        f"{record.name}: its accelerations reach {unscaled:.4g} m/s2 with unit = {component.unit!r}, and hardly any "
        f"record reaches {MOST_PEAK:g} m/s2, 3 g{_other_units(component, unscaled)}; is the unit right?{meant}"
    )


def _peak_notes(table: MotionKey, component: Component, peak: float, scale: float) -> tuple[str, ...]:
    """Notes on an unusually small or large peak."""
    if USUAL_PEAKS[0] <= peak <= USUAL_PEAKS[1]:
        return ()
    size = "hardly moves a container" if peak < USUAL_PEAKS[0] else "is beyond almost all records"
    doubt = "" if component.unit_stated else _other_units(component, peak / abs(scale))
    return (
        f"{table}.file: its peak, {peak:.3g} m/s2 = {peak / STANDARD_GRAVITY:.2g} g, {size}"
        + (f"{doubt}; is the unit right?" if doubt else ""),
    )


def _other_units(component: Component, peak: float) -> str:
    """The peak if the values were of another unit that makes it a usual one."""
    number = peak / abs(component.factor)
    others = {
        unit: number * UNITS[unit].factor
        for unit in ("g", "m/s2", "gal", "mm/s2")
        if component.quantity == "acceleration" and UNITS[unit].factor != abs(component.factor)
    }
    fitting = [
        f"{peak:.3g} m/s2 if the values were {unit}"
        for unit, peak in others.items()
        if USUAL_PEAKS[0] <= peak <= USUAL_PEAKS[1]
    ]
    return f" (it would be {' or '.join(fitting)})" if fitting else ""


def _require_pair(horizontal: tuple[Record, Component], vertical: tuple[Record, Component]) -> None:
    """Refuse one component for both directions, and two that were not sampled together."""
    (of_first, first), (of_second, second) = horizontal, vertical
    if first is second:
        raise RecordError(
            f"{of_second.name}: the file has one motion, which moves the floor along x already; name the file of "
            "the vertical component"
        )
    in_one_file = of_first.name == of_second.name
    names = (f"{of_first.name} {first.name}", second.name) if in_one_file else (of_first.name, of_second.name)
    require_together((first, second), names)
