"""The motions of a site as files and as typed results: action, checks of the set, every motion, the floor."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path

import numpy as np

from fem.records.spectrum import response_spectrum
from fem.runtime.arrays import FloatArray
from fem.seismic.action import SiteAction
from fem.seismic.floor import HIGHEST_HZ, ONE_MODE_TO_S
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.motion_files import write_at2, write_csv
from fem.seismic.motion_set import MotionSetCheck
from fem.site.request import SiteRequest
from fem.site.result import MOTIONS, FloorResult, MotionSet, SetCheck, SiteActionResult, SiteMotion
from fem.site.tables import BuildingTable

HEADINGS = {"h": "HORIZONTAL", "v": "UP", "t": "SECOND HORIZONTAL"}
GIVEN_FLOORS = {
    True: "its motions as they were recorded or computed",
    False: "its spectrum, which the motions fit",
}


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
    (folder / MOTIONS).mkdir(parents=True, exist_ok=True)
    described = []
    for number, motion in enumerate(ground, start=1):
        files = write_csv_files(folder, motion, motion.name)
        for letter, component in motion.lettered.items():
            name = f"{MOTIONS}/{motion.name}_{letter}.at2"
            heading = f"UNANCHORED, , {motion.name}, {HEADINGS[letter]}"
            write_at2(folder / name, motion.step, component, heading)
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
                sha256=tuple(hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in files),
            )
        )
    return described


def write_csv_files(folder: Path, motion: GroundMotion, stem: str) -> list[str]:
    """Write the components of a motion for the runs; returns the names in the folder of results."""
    (folder / MOTIONS).mkdir(parents=True, exist_ok=True)
    files = {f"{MOTIONS}/{stem}_{letter}.csv": component for letter, component in motion.lettered.items()}
    for name, component in files.items():
        write_csv(folder / name, motion.step, component)
    return list(files)


def floor_result(
    request: SiteRequest, floors: Mapping[float | None, Sequence[GroundMotion]], checked: MotionSetCheck
) -> FloorResult | None:
    """What the motions are on the floor of a building, or on a given floor: means over the set; None on the ground."""
    if request.on_given_floor:
        given, upward = floors[None], [floor.vertical for floor in floors[None] if floor.vertical is not None]
        return FloorResult(
            building=GIVEN_FLOORS[request.motions.source == "floor"],
            peak_m_s2=float(np.mean([entry.peak for entry in given])),
            peak_velocity_m_s=float(np.mean([entry.intensities["h"].peak_velocity_m_s for entry in given])),
            mean_m_s2=_numbers(checked.horizontal.mean),
            vertical_peak_m_s2=float(np.mean([np.abs(a).max() for a in upward])) if upward else None,
            vertical_mean_m_s2=_numbers(checked.vertical.mean) if checked.vertical else (),
        )
    if request.building is None or None in floors:
        return None
    varied = {period: motions for period, motions in floors.items() if period is not None}
    peaks = {
        period: float(np.mean([motion.peak for motion in motions])) for period, motions in varied.items()
    }
    worst = max(peaks, key=lambda period: peaks[period])
    motions = varied[worst]
    spectra = [
        response_spectrum(motion.step, motion.horizontal, checked.periods).pseudo_acceleration_m_s2
        for motion in motions
    ]
    return FloorResult(
        z_over_h=request.building.z_over_h,
        building=_modes_in_words(request.building),
        building_periods_s=tuple(varied),
        damping_ratio=request.building.damping_ratio,
        peak_m_s2=peaks[worst],
        peak_velocity_m_s=float(np.mean([motion.intensities["h"].peak_velocity_m_s for motion in motions])),
        mean_m_s2=_numbers(np.mean(spectra, axis=0)),
    )


def _modes_in_words(building: BuildingTable) -> str:
    """The model of a building."""
    if building.storeys is None:
        beyond = building.building_period_s > ONE_MODE_TO_S
        return (
            f"one mode, linear over the height, good for low, stiff buildings up to {ONE_MODE_TO_S:g} s"
            f"{', which this one exceeds' if beyond else ''}; no model of the structure as 4.3.5.1 (2)P asks for it"
        )
    shape = "equal storeys that shear" if building.kind == "shear" else "one stiffness in bending"
    return f"{building.storeys} storeys, {shape}, all modes up to {HIGHEST_HZ:g} Hz"


def _numbers(values: FloatArray) -> tuple[float, ...]:
    return tuple(values.tolist())
