"""The tables of a site file, one frozen model each: keys, units, defaults and what they mean."""

from dataclasses import replace
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Field, Strict

from fem.case.tables import quantities as q
from fem.case.tables.problem import Rule, file_beside, one_of, refused
from fem.case.tables.quantities import Quantity
from fem.case.tables.table import CaseTable, case_key, optional_key
from fem.seismic.artificial import LEAST_STATIONARY_S, MOST_STATIONARY_S
from fem.seismic.floor import (
    LEAST_DAMPING,
    MOST_DAMPING,
    ONE_MODE_REFUSED_S,
    ONE_MODE_TO_S,
    is_a_floor,
    nearest_floor,
)
from fem.seismic.motion_set import LEAST_MOTIONS

IMPORTANCE = Quantity(
    least=0.5, most=2.0, advice="EN 1998-1:2004, 4.2.5 has 0.8 to 1.4; 4.3.5.3 has 1.5 for toxic content"
)
REFERENCE = Quantity(unit="m/s2", above=0.0, below=30.0, typical=1.6, slips={"g": 9.81, "cm/s2": 0.01})
VERTICAL_RATIO = Quantity(above=0.0, below=10.0, advice="EN 1998-1:2004, table 3.4 has 0.45 and 0.9")
TOPOGRAPHY = Quantity(
    least=1.0,
    most=2.0,
    advice="as remembered, not checked against its text: 1 below 15 degrees or 30 m of height; at least 1.2 near the "
    "top of cliffs, slopes and ridges, 1.4 on narrow ridges steeper than 30 degrees, 20 % more on loose ground",
)
SPECTRAL = Quantity(unit="m/s2", above=0.0, below=100.0, slips={"g": 9.81})
SPECTRUM_POINT = Quantity(above=0.0, below=1000.0)
SPECTRUM_PERIOD = Quantity(unit="s", above=0.0, most=4.0, advice="T_B, T_C, T_D are 0.05 to 2 s")
LEVEL = Quantity(least=0.0, most=1.0, advice="0 is the foundation, 1 the roof")
BUILDING_PERIOD = Quantity(
    unit="s", least=0.02, most=10.0, advice="T_1 of the building in this direction; about 0.1 s a storey"
)
DAMPING = Quantity(least=LEAST_DAMPING, most=MOST_DAMPING, typical=0.05, slips={"per cent": 0.01})
STATIONARY = Quantity(
    unit="s",
    least=LEAST_STATIONARY_S,
    most=MOST_STATIONARY_S,
    advice="EN 1998-1:2004, 3.2.3.1.2 (3) asks for 10 s at least",
)
SHARE = Quantity(above=0.0, most=1.0, advice="0.5 to 1 is usual")
SECOND = Quantity(least=0.0, most=1.5, advice="1 is the same spectrum in both directions")
ROTATION_RATIO = Quantity(above=0.0, most=1.0, advice="0.5 is usual; 1 is on the point of falling")
SLIP = Quantity(unit="m", above=0.0, most=100.0, typical=0.1, slips={"millimetres": 1e-3})
MOST_MOTIONS = 100
#: the rules of thumb divide by it, so there is no container without friction
SOME_FRICTION = replace(q.FRICTION, least=None, above=0.0)
FrictionRange = Annotated[list[Annotated[float, SOME_FRICTION]], Field(min_length=1, max_length=2)]
ShareRange = Annotated[list[Annotated[float, SHARE]], Field(min_length=1, max_length=2)]
OfSource = Annotated[str, Field(max_length=500)]
SpectrumPoints = Annotated[list[Annotated[float, SPECTRUM_POINT]], Field(min_length=2)] | None
Corners = Annotated[list[Annotated[float, SPECTRUM_PERIOD]], Field(min_length=3, max_length=3)] | None

#: keys of [site] that a spectrum needs, and those that it has of its own
NEEDED = {
    "EN1998-1": ("ground", "reference_acceleration_m_s2"),
    "DIN-NA-2011": ("ground", "zone", "vertical_ratio"),
    "second-generation": ("plateau_m_s2", "one_second_m_s2", "end_periods_s", "vertical_ratio"),
    "custom": (
        "reference_acceleration_m_s2",
        "soil_factor",
        "corner_periods_s",
        "vertical_ratio",
        "vertical_corner_periods_s",
    ),
}
OF_SPECTRA = ("type", "ground", "zone", *NEEDED["custom"], *NEEDED["second-generation"][:3])
WHY = {
    "vertical_ratio": "a_vg/a_g, which the annex in force gives",
    "zone": "1, 2 or 3",
    "ground": 'such as "D", or "C-R" in Germany',
    "reference_acceleration_m_s2": "a_gR of the site",
}


def _missing(site: Any) -> str:
    missing = [key for key in NEEDED[site.spectrum] if getattr(site, key) is None]
    keys = ", ".join(f"{key} ({WHY[key]})" if key in WHY else key for key in missing)
    return f'= "{site.spectrum}" needs {keys}' if missing else ""


def _foreign(site: Any) -> str:
    own = {*NEEDED[site.spectrum], *(("type",) if site.spectrum == "EN1998-1" else ())}
    foreign = [key for key in OF_SPECTRA if key not in own and getattr(site, key) is not None]
    way_out = f'{", ".join(foreign)}; take the key out, or choose spectrum = "custom"'
    return f'= "{site.spectrum}" has its own {way_out}' if foreign else ""


def _rising_periods(key: str) -> Rule:
    def rising(site: Any) -> bool:
        return all(low < high for low, high in pairwise(getattr(site, key) or ()))

    return Rule(f"site.{key}", rising, f"must rise, got {{{key}}}")


def _rises(key: str) -> Rule:
    return Rule(
        f"friction.{key}",
        lambda table: len(getattr(table, key)) == 1 or getattr(table, key)[0] <= getattr(table, key)[-1],
        lambda table: f"must be [low, high], got {getattr(table, key)}; put the smaller number first",
    )


class SiteTable(CaseTable):
    """The action: the elastic spectra of the site and their factors."""

    spectrum: Literal["EN1998-1", "DIN-NA-2011", "second-generation", "custom"] = case_key(
        '"EN1998-1" | "DIN-NA-2011" (superseded in 2021 and 2023) | "custom": parameters of another annex, given below '
        '| "second-generation": of the form of EN 1998-1-1:2024, S_alpha and S_beta given below',
        "EN1998-1",
    )
    type: Annotated[int, Strict(), Quantity(least=1, most=2)] | None = optional_key(
        "of the spectrum, EN1998-1 only: 1, or 2 where the hazard is from magnitudes up to 5.5 (default 1)", 1
    )
    ground: str | None = optional_key('"A" to "E"; DIN-NA-2011: "C-R" and the like', "D")
    zone: Annotated[int, Strict(), Quantity(least=1, most=3)] | None = optional_key(
        "DIN-NA-2011 only: 1, 2, 3", 3
    )
    reference_acceleration_m_s2: Annotated[float, REFERENCE] | None = optional_key(
        "a_gR on rock; DIN-NA-2011: from the zone", 1.6
    )
    importance_factor: Annotated[float, IMPORTANCE] = case_key("gamma_I (4.2.5)", 1.0)
    element_importance_factor: Annotated[float, IMPORTANCE] | None = optional_key(
        "gamma_a (4.3.5.3); left out: 1.5 for toxic or explosive contents, else 1", 1.5
    )
    topographic_factor: Annotated[float, TOPOGRAPHY] = case_key(
        "S_T near cliffs and on ridges (EN 1998-5:2004, Annex A)", 1.0
    )
    soil_factor: Annotated[float, q.SOIL_FACTOR] | None = optional_key("S, custom only", 1.35)
    corner_periods_s: Corners = optional_key("[T_B, T_C, T_D], custom only", [0.2, 0.8, 2.0])
    vertical_ratio: Annotated[float, VERTICAL_RATIO] | None = optional_key(
        "a_vg/a_g, custom and DIN-NA-2011; f_vh, second-generation", 0.9
    )
    vertical_corner_periods_s: Corners = optional_key("of the vertical, custom only", [0.05, 0.15, 1.0])

    plateau_m_s2: Annotated[float, SPECTRAL] | None = optional_key(
        "S_alpha at the surface, site factors in it, second-generation only", 6.32
    )
    one_second_m_s2: Annotated[float, SPECTRAL] | None = optional_key(
        "S_beta at the surface, second-generation only; T_C is S_beta/S_alpha", 3.37
    )
    end_periods_s: Corners = optional_key("[T_A, T_B, T_D], second-generation only", [0.02, 0.1, 2.0])
    plateau_over_peak: Annotated[float, Quantity(above=1.0, below=10.0)] = case_key(
        "F_A, second-generation", 2.5
    )

    rules = (
        refused("site.spectrum", _missing),
        refused("site.spectrum", _foreign),
        _rising_periods("corner_periods_s"),
        _rising_periods("vertical_corner_periods_s"),
    )


class BuildingTable(CaseTable):
    """The building on a floor of which the container stands; left out: it stands on the ground."""

    z_over_h: Annotated[float, LEVEL] = case_key(
        "height of the floor over that of the building, both above the foundation", example=1.0
    )
    building_period_s: Annotated[float, BUILDING_PERIOD] = case_key(
        "T_1 in the direction of the motion; it is varied by plus and minus 15 %", example=0.5
    )
    storeys: Annotated[int, Strict(), Quantity(least=1, most=200)] | None = optional_key(
        "equal masses at equal heights, all modes up to 33 Hz; left out: one mode, good for low, stiff buildings "
        f"up to T_1 = {ONE_MODE_TO_S:g} s",
        5,
    )
    kind: Literal["shear", "cantilever"] = case_key(
        '"shear": equal storeys | "cantilever": bending of one stiffness; with storeys', "shear"
    )
    damping_ratio: Annotated[float, DAMPING] = case_key("of the building, of every mode", 0.05)

    rules = (
        Rule(
            "building.building_period_s",
            lambda building: (
                building.storeys is not None
                or building.z_over_h == 0.0
                or building.building_period_s <= ONE_MODE_REFUSED_S
            ),
            f"= {{building_period_s}} s needs storeys: one mode stands for low, stiff buildings, up to "
            f"{ONE_MODE_TO_S:g} s, and is refused beyond {ONE_MODE_REFUSED_S:g} s, where the floors of a building "
            "move with its higher modes",
        ),
        Rule(
            "building.z_over_h",
            lambda building: building.storeys is None or is_a_floor(building.storeys, building.z_over_h),
            lambda building: (
                f"= {building.z_over_h:g} is no floor of {building.storeys} storeys; a floor is at "
                f"{nearest_floor(building.storeys, building.z_over_h):.4g}"
            ),
        ),
        Rule(
            "building.kind",
            lambda building: building.storeys is not None or building.kind == "shear",
            "has no effect without storeys",
        ),
    )


class FloorSpectrumTable(CaseTable):
    """The spectrum of the floor on which the container stands, for the action of [site]; in place of [building]."""

    period_s: SpectrumPoints = optional_key("rising, from 0.05 s or less", [0.03, 0.2, 0.5, 4.0])
    acceleration_m_s2: SpectrumPoints = optional_key(
        "pseudo-acceleration at 5 % damping at these periods; at the first the peak of the floor",
        [3.0, 9.0, 9.0, 0.4],
    )
    vertical_acceleration_m_s2: SpectrumPoints = optional_key(
        "vertical, at the same periods; left out: that of the ground", [2.0, 5.0, 1.5, 0.1]
    )
    file: str | None = optional_key(
        "in their place, columns period_s, acceleration_m_s2 and perhaps vertical_acceleration_m_s2",
        "floor.csv",
    )

    rules = (
        one_of("floor_spectrum.period_s", "file"),
        Rule(
            "floor_spectrum.acceleration_m_s2",
            lambda floor: (
                (floor.period_s is None) == (floor.acceleration_m_s2 is None)
                and (floor.vertical_acceleration_m_s2 is None or floor.period_s is not None)
            ),
            "and period_s belong together",
        ),
        file_beside("floor_spectrum.file"),
    )


class MotionsTable(CaseTable):
    """The motions that represent the action."""

    source: Literal["artificial", "records", "matched", "floor"] = case_key(
        '"artificial" | "records": scaled | "matched": records changed by wavelets | "floor": motions of the floor on '
        "which the container stands, recorded or computed, taken as they are",
        "artificial",
    )
    count: Annotated[int, Strict(), Quantity(least=3, most=MOST_MOTIONS)] = case_key(
        "artificial motions; the mean counts from 7", 7
    )
    seed: Annotated[int, Strict(), Quantity(least=0, most=2**31 - 1)] = case_key(
        "of the artificial motions", 1
    )
    stationary_s: Annotated[float, STATIONARY] = case_key("stationary part of the artificial motions", 12.0)
    vertical: bool = case_key("whether the floor moves vertically, too", True)
    second_component: Annotated[float, SECOND] = case_key(
        "second horizontal component over the first, of artificial and matched motions: for slip in two directions; "
        "0: none",
        1.0,
    )
    files: list[list[str]] | None = optional_key(
        "records: a list of horizontal, vertical and, for slip in two directions, second horizontal component",
        [["h1.at2", "v1.at2"]],
    )
    unit: Literal["g", "m/s2", "cm/s2", "gal", "mm/s2"] | None = optional_key(
        "of records whose files do not state it", "g"
    )
    sample_interval_s: Annotated[float, Quantity(unit="s", above=0.0, most=1.0)] | None = optional_key(
        "of records of one column", 0.01
    )
    allow_baseline: Literal[True] | None = optional_key(
        "true takes matched records of which the baseline changes a peak by more than 20 %", True
    )
    further: Annotated[int, Strict(), Quantity(least=0, most=10_000)] = case_key(
        "further artificial motions, for the share that overturns; 0: none", 100
    )

    rules = (
        Rule(
            "motions.allow_baseline",
            lambda motions: motions.allow_baseline is None or motions.source == "matched",
            'has no effect with source = "{source}": a baseline is removed where records are "matched"',
        ),
        Rule(
            "motions.files",
            lambda motions: motions.source == "artificial" or bool(motions.files),
            'is missing: source = "{source}" needs the files of the records, such as [["h1.at2", "v1.at2"]]',
        ),
        Rule(
            "motions.files",
            lambda motions: motions.files is None or len(motions.files) >= LEAST_MOTIONS,
            lambda motions: f"names {len(motions.files)} motions, at least {LEAST_MOTIONS} are needed",
        ),
        Rule(
            "motions.files",
            lambda motions: (
                motions.files is None
                or all(len(names) in (1, 2, 3) and all(map(str.strip, names)) for names in motions.files)
            ),
            "must hold one to three names each: horizontal, vertical, second horizontal",
        ),
        Rule(
            "motions.files",
            lambda motions: (
                motions.source == "artificial"
                or not motions.vertical
                or motions.files is None
                or all(len(names) >= 2 for names in motions.files)
            ),
            "must name a vertical record beside every horizontal one, or take vertical = false",
        ),
    )


class FrictionTable(CaseTable):
    """The range of friction; no value is always the unfavourable one."""

    mu_static: FrictionRange = case_key("[low, high], or [value]", example=[0.3, 0.4])
    mu_kinetic_over_static: ShareRange = case_key("[low, high], or [value]", [0.5, 1.0])

    rules = (_rises("mu_static"), _rises("mu_kinetic_over_static"))


class LimitsTable(CaseTable):
    """The limits that the user gives."""

    rotation_ratio: Annotated[float, ROTATION_RATIO] = case_key(
        "largest |rotation| over the slenderness angle, by the rule", 0.5
    )
    slip_m: Annotated[float, SLIP] = case_key("largest slip of any motion: the clearance", example=0.1)
    single_rotation_ratio: Annotated[float, ROTATION_RATIO] = case_key(
        "largest of any single motion, where the mean of seven and more counts: this program's own rule", 0.8
    )


class SourcesTable(CaseTable):
    """Where the inputs come from, in words for the page, which is not signed while one is missing or a placeholder."""

    site: OfSource = case_key("hazard, ground, importance", "", example="report on the ground of 3 May 2026")
    floor: OfSource = case_key("the building, or the motion of its floor", "")
    container: OfSource = case_key("weights, dimensions, mass centre", "")
    friction: OfSource = case_key("the range of friction", "", example="tests of castings on this floor")
    limits: OfSource = case_key("limits of rotation and slip", "", example="clearances of drawing 12")
    wind: OfSource = case_key("pressure or zone of the wind", "")
