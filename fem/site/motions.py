"""The motions of a site: made or read, on the ground and on the floor of a building; as files and as typed results."""

import hashlib
import importlib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from fem.case.data_files import split_channel
from fem.case.plausible import doubts
from fem.case.tables.problem import outside_the_folder, stays_in_the_folder
from fem.case.validation import CaseError, told_as
from fem.records.files import read_record
from fem.records.processing import Processing, stated_baseline
from fem.records.record import Component, Direction, Record, RecordError, cut_together
from fem.records.spectrum import response_spectrum
from fem.runtime.arrays import FloatArray
from fem.runtime.own_files import place_in
from fem.runtime.user_files import leads_out, read_own, real_path
from fem.seismic.action import LAST_PERIOD_ANNEX_A_S, LAST_PERIOD_S, FloorSpectrum, MotionTarget, SiteAction
from fem.seismic.artificial import artificial_set
from fem.seismic.floor import HIGHEST_HZ, ONE_MODE_TO_S, PERIOD_FACTORS, floor_motion, one_mode, storey_modes
from fem.seismic.ground_motion import GroundMotion, write_at2, write_csv
from fem.seismic.motion_set import SHORTEST_SHOWN_S, MotionSetCheck, periods_of_check
from fem.site.request import SiteRequest
from fem.site.result import (
    MOTIONS,
    FloorResult,
    MotionSet,
    SetCheck,
    SiteActionResult,
    SiteBody,
    SiteMotion,
)
from fem.site.tables import BuildingTable

UNEVEN = 1e-3  #: largest difference of two intervals of a record that is sampled evenly, over the interval
COARSEST_S = 0.5 * SHORTEST_SHOWN_S  #: step that describes the shortest period of the check of a set
RIGID_PERIOD_S = 0.01  #: of an oscillator that moves with its floor
MATCHED = Processing(baseline="zero-end")  #: what matching does to a record besides
BASELINE = "take another record, or set allow_baseline = true"  #: where one is refused
HEADINGS = {"h": "HORIZONTAL", "v": "UP", "t": "SECOND HORIZONTAL"}
GIVEN_FLOORS = {
    True: "its motions as they were recorded or computed",
    False: "its spectrum, which the motions fit",
}


def longest_period(bodies: Sequence[SiteBody]) -> float:
    """End of the band of periods: 4 s, or 2 pi/p of the largest body where that is longer, up to 10 s."""
    periods = (2.0 * math.pi / body.frequency_parameter_1_s for body in bodies)
    return min(max(LAST_PERIOD_S, *periods), LAST_PERIOD_ANNEX_A_S)


def ground_motions(
    request: SiteRequest, longest: float, *, allow_outside: bool = False
) -> list[GroundMotion]:
    """The set of motions of the ground, scaled or matched where it is recorded; or of a given floor.

    Raises:
        CaseError: a record that is missing, outside the folder, no motion, or not independent of another.
    """
    table, target = request.motions, request.floor_target or request.action
    if table.source == "artificial":
        with told_as("[motions] "):
            return artificial_set(
                target,
                count=table.count,
                seed=table.seed,
                stationary=table.stationary_s,
                longest=longest,
                vertical=table.vertical,
                second=table.second_component,
            )
    records = [
        _record(request, number, names, allow_outside)
        for number, names in enumerate(table.files or [], start=1)
    ]
    for one, other in combinations(records, 2):  # the motions of a set count as independent of one another
        if one.event and one.event.casefold() == other.event.casefold():
            raise CaseError(
                f"[motions] files: {one.origin} and {other.origin} are records of one event, {one.event}; the motions "
                "of a set must be independent, so take one of them"
            )
    if table.source == "floor":
        return records
    # loaded where it is used: its import of scipy.signal takes as long as thirty runs
    matched = importlib.import_module("fem.seismic.matched")
    fitted: list[GroundMotion] = (
        matched.scaled_records(records, target, longest=longest)
        if table.source == "records"
        else matched.matched_records(records, target, longest=longest, second=table.second_component)
    )
    return fitted


def motion_target(request: SiteRequest, motions: Sequence[GroundMotion], longest: float) -> MotionTarget:
    """What the set is compared with, and what further motions fit: the site, a given floor, or its motions' mean.

    Args:
        motions: of the set; longest: end of the band of periods [s].
    """
    if request.motions.source != "floor":
        return request.floor_target or request.action
    periods = periods_of_check(longest)
    along = [(motion.step, motion.horizontal) for motion in motions]
    upward = [(motion.step, motion.vertical) for motion in motions if motion.vertical is not None]
    return FloorSpectrum(
        periods=(RIGID_PERIOD_S, *periods.tolist()),
        accelerations=(_mean_peak(values for _, values in along), *_mean_spectrum(along, periods)),
        vertical_accelerations=(_mean_peak(values for _, values in upward), *_mean_spectrum(upward, periods))
        if upward
        else (),
        ground=request.action,
    )


def _mean_peak(components: Iterable[FloatArray]) -> float:
    return float(np.mean([np.abs(values).max() for values in components]))


def _mean_spectrum(components: Iterable[tuple[float, FloatArray]], periods: FloatArray) -> tuple[float, ...]:
    """Of components with their steps, at 5 % damping."""
    spectra = [response_spectrum(*component, periods) for component in components]
    return _numbers(np.mean(spectra, axis=0))


def floor_motions(
    request: SiteRequest, ground: Sequence[GroundMotion]
) -> dict[float | None, list[GroundMotion]]:
    """Motions of the floor on which the container stands, by the period of the building; None: the ground."""
    building = request.building
    if building is None or building.z_over_h == 0.0:
        return {None: list(ground)}
    return {
        period: [on_floor(building, motion, period) for motion in ground]
        for period in (float(f"{factor * building.building_period_s:.9g}") for factor in PERIOD_FACTORS)
    }


def on_floor(building: BuildingTable | None, ground: GroundMotion, period: float | None) -> GroundMotion:
    """A motion of the ground on the floor of a building of this longest period; None: on the ground."""
    if building is None or period is None:
        return ground
    height, storeys = building.z_over_h, building.storeys
    if storeys is None:
        modes = one_mode(height_ratio=height, period=period)
    else:
        modes = storey_modes(storeys=storeys, kind=building.kind, height_ratio=height, period=period)
    return floor_motion(ground, modes, damping_ratio=building.damping_ratio)


def _record(request: SiteRequest, number: int, names: Sequence[str], allow_outside: bool) -> GroundMotion:
    records, components = list[Record](), list[Component]()
    given = dict(zip("hvt", names, strict=False))
    if not request.motions.vertical:
        given.pop("v", None)
    with told_as("[motions] files: ", of=RecordError):
        for letter, name in given.items():
            record, channel = _read(request, name, allow_outside)
            records.append(record)
            direction: Direction = "vertical" if letter == "v" else "horizontal"
            components.append(record.component(direction, quantity="acceleration", channel=channel))
        for record, component in zip(records, components, strict=True):
            component.require_no_gap(record.name)
        components, cut = cut_together(components, [record.name for record in records])
        noted = [cut] if cut else []
        for record, component in zip(records, components, strict=True):
            scaled = request.motions.source != "floor"
            said = doubts(record.name, component, component, scale=1.0, confirmed=scaled)
            noted += [f"{record.name}: {note}" for note in (*component.notes, *said)]
    notes = (*noted, *_baselines_in_words(request, given, records, components))
    if len(set(map(id, components))) < len(components):
        raise CaseError(f"[motions] files: a component of {records[0].name} is named for two directions")
    step, values = _even(components)
    by_letter = dict(zip(given, values, strict=True))
    return GroundMotion(
        name=f"motion_{number:02d}",
        step=step,
        horizontal=by_letter["h"],
        vertical=by_letter.get("v"),
        second=by_letter.get("t"),
        origin=", ".join(dict.fromkeys(record.name for record in records)),
        notes=notes,
        event=" ".join(f"{records[0].event} {records[0].date}".split()),
    )


def _baselines_in_words(
    request: SiteRequest, letters: Iterable[str], records: Sequence[Record], components: Sequence[Component]
) -> tuple[str, ...]:
    """What the baseline that matching removes changes in a record, component by component.

    Raises:
        CaseError: it changes a peak too much and is not allowed.
    """
    table, notes = request.motions, dict[str, None]()
    if table.source != "matched":
        return ()
    for letter, record, component in zip(letters, records, components, strict=True):
        if letter == "t" and table.second_component == 0.0:
            continue
        with told_as("[motions] files: ", of=RecordError):
            change = stated_baseline(
                record.name, component, MATCHED, allowed=bool(table.allow_baseline), way_out=BASELINE
            )
        if change:
            notes[f"{record.name}: matching removes a baseline; {change}"] = None
    return tuple(notes)


def _read(request: SiteRequest, name: str, allow_outside: bool) -> tuple[Record, str]:
    if not allow_outside and not stays_in_the_folder(name):
        raise CaseError(f"[motions] files {outside_the_folder(name)}; or allow it with --allow-outside")
    path, channel = split_channel(request.origin.folder, name)
    if not allow_outside and leads_out(request.origin.folder, path):
        raise CaseError(
            f"[motions] files: {name!r} leads out of {real_path(request.origin.folder)}; allow it with --allow-outside"
        )
    table = request.motions
    return read_record(path, unit=table.unit, sample_interval=table.sample_interval_s), channel


def _even(components: Sequence[Component]) -> tuple[float, list[FloatArray]]:
    """Step and values of components at even times; linear between samples that are uneven or too far apart."""
    times = components[0].times
    steps = np.diff(times)
    step = float(np.median(steps))
    if np.ptp(steps) <= UNEVEN * step and step <= COARSEST_S:
        return step, [component.values for component in components]
    step = min(float(steps.min()), COARSEST_S)
    even = times[0] + np.arange(math.floor((times[-1] - times[0]) / step * (1.0 + 1e-12)) + 1) * step
    return step, [np.asarray(np.interp(even, component.times, component.values)) for component in components]


def action_result(action: SiteAction, checked: MotionSetCheck) -> SiteActionResult:
    """The action, and the spectra of the set beside its targets."""
    shape, vertical = action.shape, checked.vertical
    return SiteActionResult(
        source=shape.source,
        reference_acceleration_m_s2=action.reference_acceleration,
        importance_factor=action.importance_factor,
        element_importance_factor=action.element_importance_factor,
        topographic_factor=action.topographic_factor,
        ag_m_s2=action.ground_acceleration,
        soil_factor=shape.soil_factor,
        ag_S_m_s2=action.surface_acceleration,
        avg_m_s2=action.vertical_acceleration,
        vertical_ratio=shape.vertical_ratio,
        corner_periods_s=shape.corner_periods,
        vertical_corner_periods_s=shape.vertical_corner_periods,
        displacement_m=action.ground_displacement,
        periods_s=_numbers(checked.periods),
        target_m_s2=_numbers(checked.horizontal.target),
        mean_m_s2=_numbers(checked.horizontal.mean),
        vertical_target_m_s2=_numbers(vertical.target) if vertical else (),
        vertical_mean_m_s2=_numbers(vertical.mean) if vertical else (),
    )


def set_result(
    request: SiteRequest,
    checked: MotionSetCheck,
    ground: Sequence[GroundMotion],
    described: Sequence[SiteMotion],
) -> MotionSet:
    """The set of motions and its checks."""
    table, vertical = request.motions, checked.vertical
    return MotionSet(
        source=table.source,
        count=checked.count,
        seed=table.seed if table.source == "artificial" else None,
        stationary_s=checked.stationary,
        band_s=checked.band,
        mean_pga_m_s2=checked.mean_peak,
        least_ratio=checked.least_ratio,
        least_ratio_period_s=checked.least_ratio_period,
        vertical_least_ratio=checked.vertical_least_ratio,
        vertical_least_ratio_period_s=checked.vertical_least_ratio_period,
        largest_correlation=checked.largest_correlation,
        valid=checked.valid,
        reasons=checked.reasons,
        notes=tuple(dict.fromkeys(note for motion in ground for note in motion.notes)),
        checks=tuple(
            SetCheck(**{key.name: getattr(requirement, key.name) for key in fields(SetCheck)})
            for requirement in checked.requirements
            if table.source != "floor" or not requirement.fits  # motions of a floor fit no target
        ),
        motions=tuple(
            replace(
                motion,
                spectrum_m_s2=_numbers(checked.horizontal.motions[k]),
                vertical_spectrum_m_s2=_numbers(vertical.motions[k]) if vertical else (),
            )
            for k, motion in enumerate(described)
        ),
    )


def write_ground(folder: Path, ground: Sequence[GroundMotion]) -> list[SiteMotion]:
    """Write the motions of the ground as CSV and as AT2, and describe them, apart from their spectra."""
    described = []
    for number, motion in enumerate(ground, start=1):
        files = write_csv_files(folder, motion, motion.name)
        for letter, component in motion.lettered.items():
            name = f"{MOTIONS}/{motion.name}_{letter}.at2"
            heading = f"UNANCHORED, , {motion.name}, {HEADINGS[letter]}"
            write_at2(place_in(folder, name), motion.step, component, heading)
            files.append(name)
        measures, ends = motion.intensities, motion.ends
        described.append(
            SiteMotion(
                number=number,
                origin=motion.origin,
                scale=motion.factor,
                pga_m_s2=measures["h"].peak_acceleration_m_s2,
                pgv_m_s=measures["h"].peak_velocity_m_s,
                pgd_m=measures["h"].peak_displacement_m,
                d5_95_s=measures["h"].significant_s,
                vertical_pga_m_s2=measures["v"].peak_acceleration_m_s2 if "v" in measures else None,
                end_velocity_m_s=ends[0],
                end_displacement_m=ends[1],
                spectrum_m_s2=(),
                files=tuple(files),
                sha256=tuple(hashlib.sha256(read_own(folder / name)).hexdigest() for name in files),
            )
        )
    return described


def write_csv_files(folder: Path, motion: GroundMotion, stem: str) -> list[str]:
    """Write the components of a motion for the runs; returns the names in the folder of results."""
    files = {f"{MOTIONS}/{stem}_{letter}.csv": component for letter, component in motion.lettered.items()}
    for name, component in files.items():
        write_csv(place_in(folder, name), motion.step, component)
    return list(files)


def floor_result(
    request: SiteRequest, floors: Mapping[float | None, Sequence[GroundMotion]], checked: MotionSetCheck
) -> FloorResult | None:
    """What the motions are on the floor of a building, or on a given floor: means over the set; None on the ground."""
    if request.on_given_floor:
        given, upward = floors[None], [one.vertical for one in floors[None] if one.vertical is not None]
        return FloorResult(
            building=GIVEN_FLOORS[request.motions.source == "floor"],
            peak_m_s2=_mean_peak(one.horizontal for one in given),
            peak_velocity_m_s=float(np.mean([one.intensities["h"].peak_velocity_m_s for one in given])),
            mean_m_s2=_numbers(checked.horizontal.mean),
            vertical_peak_m_s2=_mean_peak(upward) if upward else None,
            vertical_mean_m_s2=_numbers(checked.vertical.mean) if checked.vertical else (),
        )
    periods = tuple(period for period in floors if period is not None)
    if (building := request.building) is None or not periods:
        return None
    shape = "equal storeys that shear" if building.kind == "shear" else "one stiffness in bending"
    modes = f"{building.storeys} storeys, {shape}, all modes up to {HIGHEST_HZ:g} Hz"
    if building.storeys is None:
        beyond = ", which this one exceeds" * (building.building_period_s > ONE_MODE_TO_S)
        modes = (
            f"one mode, linear over the height, good for low, stiff buildings up to {ONE_MODE_TO_S:g} s{beyond}; no "
            "model of the structure as 4.3.5.1 (2)P asks for it"
        )
    motions = max(floors.values(), key=lambda varied: _mean_peak(one.horizontal for one in varied))
    return FloorResult(
        z_over_h=building.z_over_h,
        building=modes,
        building_periods_s=periods,
        damping_ratio=building.damping_ratio,
        peak_m_s2=_mean_peak(one.horizontal for one in motions),
        peak_velocity_m_s=float(np.mean([one.intensities["h"].peak_velocity_m_s for one in motions])),
        mean_m_s2=_mean_spectrum([(one.step, one.horizontal) for one in motions], checked.periods),
    )


def _numbers(values: FloatArray) -> tuple[float, ...]:
    return tuple(values.tolist())
