"""The recorded motions of a case: read from its files and processed as its keys say."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fem.case.case import Case
from fem.case.plausible import USUAL_PEAKS, doubts
from fem.case.tables.motion_tables import FloorMotionTable
from fem.case.validation import told_as
from fem.records.files import read_record
from fem.records.processing import Processing, motion_of, processed, stated_baseline, trimmed
from fem.records.record import Component, Record, RecordError, cut_together
from fem.records.units import STANDARD_GRAVITY

MotionKey = Literal["motion", "vertical"]  #: the table of a motion: along x, or vertical
TABLES: tuple[MotionKey, ...] = ("motion", "vertical")
WAYS_OUT = ', or set gaps = "bridge" where the motion is meant to go straight on between these samples'


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedMotion:
    """A component of a record as the floor follows it, and its origin."""

    record: Record
    component: Component  #: the part taken, as the file has it
    motion: Component  #: processed
    notes: tuple[str, ...]  #: doubts about it


def recorded_motion(case: Case, table: MotionKey) -> RecordedMotion:
    """The motion of a table of the case whose kind is "table".

    CaseError: its file is missing, is no motion, or does not fit its keys.
    """
    with told_as(f"[{table}] ", of=RecordError):
        return _recorded(case, table)


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


def _part(case: Case, table: MotionKey, component: Component) -> Component:
    """The part of a component that is taken."""
    keys, shared = _keys(case, table)
    start = keys.start_s if keys.start_s is not None else shared.start_s
    return trimmed(component, start, keys.end_s if keys.end_s is not None else shared.end_s)


def _shared(case: Case, table: MotionKey) -> tuple[Component, list[str]]:
    (record, component), (upright, other) = (_component(case, key) for key in TABLES)
    if component is other:
        raise RecordError(
            f"{upright.name}: the file has one motion, which moves the floor along x already; name the file of the "
            "vertical component"
        )
    same = record.name == upright.name
    names = [
        f"{of.name} {one.name}" if same else of.name for of, one in ((record, component), (upright, other))
    ]
    parts = [_part(case, key, one) for key, one in zip(TABLES, (component, other), strict=True)]
    parts, note = cut_together(parts, names)
    return parts[TABLES.index(table)], [note] if note else []


def _recorded(case: Case, table: MotionKey) -> RecordedMotion:
    keys, shared = _keys(case, table)
    record, component = _component(case, table)
    part, notes = None, list[str]()
    if case.motion.kind == case.vertical.kind == "table":
        try:
            part, notes = _shared(case, table)
        except RecordError:
            if table == "vertical":  # which the message is about
                raise
    component, scale = part or _part(case, table, component), keys.scale
    if keys is not shared and keys.scale_to_m_s2 is None and case.motion.scale_to_m_s2 is not None:
        # [motion] is scaled to a peak: its factor holds for both components of a recording
        of_file = processed(_recorded(case, "motion").component, Processing(baseline=case.motion.baseline))
        scale *= abs(case.motion.scale_to_m_s2) / float(np.abs(motion_of(of_file)[2]).max())
    processing = Processing(scale=scale, peak=keys.scale_to_m_s2, baseline=keys.baseline)
    made = processed(component, processing)
    notes = [*record.notes, *component.notes, *notes]
    baseline = stated_baseline(
        record.name,
        component,
        processing,
        allowed=bool(keys.allow_baseline),
        way_out="take another baseline, or set allow_baseline = true (--allow-baseline)",
    )
    if baseline:
        notes.append(f"{table}.baseline: {baseline}")
    confirmed = keys.scale_to_m_s2 is not None
    if confirmed and (peak := abs(keys.scale_to_m_s2 or 0.0)) < USUAL_PEAKS[0] <= peak * STANDARD_GRAVITY:
        in_g = f"{peak:.3g} m/s2 = {peak / STANDARD_GRAVITY:.2g} g"
        notes.append(f"{table}.scale_to_m_s2: {in_g}; is it in g, {peak * STANDARD_GRAVITY:.3g} m/s2?")
    of_motion = doubts(record.name, component, made, scale=scale, confirmed=confirmed)
    notes += [f"{table}.file: {note}" for note in of_motion]
    return RecordedMotion(record=record, component=component, motion=made, notes=tuple(notes))
