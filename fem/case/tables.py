"""The tables of a case file, one frozen model each: keys, units, defaults and what they mean.

A key carries its unit. What stands in one field alone (type, range, unit slips) is checked by the
field's `Quantity`; what ties several keys of one table together is a rule of `case_rules`. The keys
of an option that is not chosen are checked like all others and play no part otherwise.
"""

import math
from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, Strict, model_validator

from fem.case import motion_rules as motion_rules
from fem.case import quantities as q
from fem.case import rules as rules
from fem.case.problem import BrokenRulesError, Rule


class CaseTable(BaseModel):
    """A frozen table of a case file that knows the rules tying its keys together."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)
    rules: ClassVar[tuple[Rule, ...]] = ()

    @model_validator(mode="after")
    def _obey_rules(self) -> Self:
        """Refuse a table whose keys contradict one another, with every reason at once."""
        problems = [problem for rule in self.rules if (problem := rule(self)) is not None]
        if problems:
            raise BrokenRulesError(problems)
        return self

    def idle_keys(self) -> frozenset[str]:
        """Keys that play no part because another option is chosen."""
        return frozenset()


def _follows(
    key: str, convert: Callable[[Any], Any] = lambda value: value
) -> Callable[[dict[str, Any]], Any]:
    """A default that follows another key of the same table."""
    return lambda values: convert(values[key])


class ContainerTable(CaseTable):
    """One box of the container and how many of them are bolted on one another."""

    width_m: Annotated[float, q.LENGTH] = Field(description="outer width, along x", examples=[1.1])
    height_m: Annotated[float, q.LENGTH] = Field(description="outer height of one box", examples=[1.0])
    depth_m: Annotated[float, q.LENGTH] = Field(
        default_factory=_follows("width_m"), description="outer depth, out of the plane; default: the width"
    )
    boxes: Annotated[int, Strict(), q.BOXES] = Field(default=1, description="bolted on one another")
    weight_N: Annotated[float, q.WEIGHT] | None = Field(  # noqa: N815
        default=None, description="of one box with its fill; or density_kg_m3", examples=[24525.0]
    )
    density_kg_m3: Annotated[float, q.DENSITY] | None = Field(
        default=None,
        description="mean density of one box with its fill, in place of weight_N",
        examples=[2066.0],
    )
    centroid_m: Annotated[float, q.LENGTH] = Field(
        default_factory=_follows("height_m", lambda height: 0.5 * height),
        description="height of the mass centre in the box; default: half the height",
    )
    wall_m: Annotated[float, q.WALL] | None = Field(
        default=None, description="wall thickness, shell only", examples=[0.008]
    )
    wall_density_kg_m3: Annotated[float, q.WALL_DENSITY] = Field(
        default=7850.0, description="density of the walls, shell only"
    )
    section: Literal["shell", "solid"] = Field(
        default_factory=lambda values: "solid" if values["wall_m"] is None else "shell",
        description='"shell" | "solid"; default: shell where wall_m is given',
    )
    youngs_modulus_Pa: Annotated[float, q.STIFFNESS] = Field(default=2.1e11, description="Young's modulus")  # noqa: N815
    poisson_ratio: Annotated[float, q.POISSON] = Field(default=0.3, description="Poisson's ratio")
    damping_ratio: Annotated[float, q.MATERIAL_DAMPING] = Field(
        default=0.02, description="of the first elastic mode; it grows with frequency, zeta_n = zeta f_n/f_1"
    )
    mesh_file: str | None = Field(
        default=None, description="a mesh to use in place of the structured one", examples=["container.msh"]
    )

    rules = (
        rules.one_of_weight_and_density,
        rules.shell_has_a_wall,
        rules.walls_fit_into_the_box,
        rules.box_is_neither_needle_nor_plate,
        rules.mass_centre_lies_in_the_box,
        rules.mesh_file_stays_beside_the_case,
    )

    @property
    def box_volume(self) -> float:
        """Outer volume of one box [m3]."""
        return self.width_m * self.height_m * self.depth_m

    @property
    def total_height(self) -> float:
        """Height of all boxes together [m]."""
        return self.boxes * self.height_m

    def idle_keys(self) -> frozenset[str]:
        """The walls of a solid."""
        return frozenset() if self.section == "shell" else frozenset({"wall_m", "wall_density_kg_m3"})


class SupportTable(CaseTable):
    """Where the base may touch the floor."""

    kind: Literal["corners", "feet", "flat"] = Field(
        default="corners", description='"corners" | "feet" | "flat"'
    )
    foot_m: Annotated[float, q.FOOT] = Field(
        default=0.15, description="length of each foot from its corner, feet only"
    )

    @property
    def foot(self) -> float | None:
        """Length of each foot [m]; None where the base does not stand on feet."""
        return self.foot_m if self.kind == "feet" else None

    def idle_keys(self) -> frozenset[str]:
        """The foot of a base without feet."""
        return frozenset() if self.kind == "feet" else frozenset({"foot_m"})


class ContactTable(CaseTable):
    """Friction and the penalty contact of the base with the floor."""

    mu_static: Annotated[float, q.FRICTION] = Field(
        description="coefficient of static friction", examples=[0.4]
    )
    mu_kinetic: Annotated[float, q.FRICTION] = Field(
        default_factory=_follows("mu_static"), description="of kinetic friction; default: mu_static"
    )
    friction: Literal["elastic-stick", "regularised"] = Field(
        default="elastic-stick",
        description='"elastic-stick" (regularised in displacement) | "regularised" (in velocity; it creeps)',
    )
    regularisation_velocity_m_s: Annotated[float, q.SLIP_VELOCITY] = Field(
        default=1e-3, description="of regularised friction"
    )
    normal_penalty_Pa_m: Annotated[float, q.PENALTY] | Literal["auto"] = Field(  # noqa: N815
        default="auto", description='normal stiffness of the whole base over width x depth, or "auto"'
    )
    tangential_ratio: Annotated[float, q.RATIO] = Field(
        default=1.0, description="tangential over normal penalty"
    )
    weakening_m: Annotated[float, q.WEAKENING] = Field(
        default=0.0, description="slip over which mu_static falls to mu_kinetic; 0: at once"
    )
    damping_ratio: Annotated[float, q.CONTACT_DAMPING] = Field(
        default=2.0, description="c/(2 sqrt(k m)), the whole mass m on the spring k of one corner"
    )

    rules = (rules.kinetic_friction_is_not_above_static,)

    def idle_keys(self) -> frozenset[str]:
        """The regularisation velocity of a law that is not regularised in velocity."""
        return frozenset({"regularisation_velocity_m_s"}) if self.friction == "elastic-stick" else frozenset()


class MotionTable(CaseTable):
    """How the floor moves; accelerations and displacements are positive toward +x."""

    kind: Literal["none", "harmonic", "pulse", "table"] = Field(
        description='"none" | "harmonic" | "pulse" | "table"', examples=["harmonic"]
    )
    amplitude_m: Annotated[float, q.AMPLITUDE] | None = Field(
        default=None,
        description="harmonic: exactly two of amplitude, peak acceleration and frequency",
        examples=[0.05],
    )
    peak_acceleration_m_s2: Annotated[float, q.PEAK_ACCELERATION] | None = Field(
        default=None, description="harmonic: A Omega^2; pulse: its peak, > 0 toward +x", examples=[4.0]
    )
    angular_frequency_rad_s: Annotated[float, q.ANGULAR_FREQUENCY] | None = Field(
        default=None, description="harmonic: Omega", examples=[6.928]
    )
    frequency_Hz: Annotated[float, q.FREQUENCY] | None = Field(  # noqa: N815
        default=None,
        description="harmonic: Omega/2 pi, in place of angular_frequency_rad_s",
        examples=[1.1026],
    )
    phase_rad: Annotated[float, q.PHASE] = Field(
        default=0.0, description="harmonic: x = A sin(Omega t + phase)"
    )
    ramp_cycles: Annotated[float, q.RAMP_CYCLES] = Field(
        default=0.0, description="harmonic: cycles over which the beginning and the end are tapered"
    )
    cycles: Annotated[float, q.CYCLES] | None = Field(
        default=None,
        description="harmonic: the floor stops where it comes to rest after so many cycles; default: never",
        examples=[10.0],
    )
    start: Literal["moving", "rest"] = Field(
        default="moving",
        description='"moving": the container moves with the floor at t = 0 | "rest": it does not',
    )
    shape: Literal["rectangular", "half-sine", "sine"] | None = Field(
        default=None, description='pulse: "rectangular" | "half-sine" | "sine"', examples=["half-sine"]
    )
    pulse_s: Annotated[float, q.PULSE_DURATION] | None = Field(
        default=None, description="pulse: its length", examples=[0.5]
    )
    delay_s: Annotated[float, q.DELAY] = Field(default=0.0, description="pulse: when it begins")
    file: str | None = Field(
        default=None,
        description="table: two columns, time and value, beside the case file",
        examples=["floor.csv"],
    )
    quantity: Literal["acceleration", "displacement"] | None = Field(
        default=None, description='table: "acceleration" | "displacement"', examples=["acceleration"]
    )
    unit: Literal["m/s2", "g", "m"] | None = Field(
        default=None, description='table: unit of its values, "m/s2" | "g" | "m"', examples=["m/s2"]
    )
    scale: Annotated[float, q.SCALE] = Field(default=1.0, description="table: factor on its values")
    baseline: Literal["none", "mean", "linear"] = Field(
        default="none", description='table: removed from the acceleration, "none" | "mean" | "linear"'
    )

    rules = (
        motion_rules.harmonic_is_given_by_two_of_three,
        motion_rules.harmonic_frequency_is_computable,
        motion_rules.harmonic_peak_is_not_negative,
        motion_rules.harmonic_amplitude_is_computable,
        motion_rules.harmonic_peak_is_computable,
        motion_rules.ramps_fit_into_the_cycles,
        motion_rules.tapers_take_time,
        motion_rules.pulse_is_complete,
        motion_rules.table_is_complete,
        motion_rules.table_unit_fits_its_quantity,
        motion_rules.displacements_have_no_baseline,
        motion_rules.table_is_not_scaled_away,
        motion_rules.motion_file_stays_beside_the_case,
    )

    @property
    def angular_frequency(self) -> float:
        """Omega of a harmonic motion [rad/s]; 0 for every other kind."""
        return motion_rules.harmonic_angular_frequency(self) or 0.0

    @property
    def amplitude(self) -> float:
        """A of a harmonic motion x = A sin(Omega t + phase) [m]; 0 for every other kind."""
        return motion_rules.harmonic_amplitude(self) or 0.0

    @property
    def period(self) -> float:
        """Time of one cycle of a harmonic motion [s]; infinite for every other kind."""
        return 2.0 * math.pi / self.angular_frequency if self.angular_frequency else math.inf

    def idle_keys(self) -> frozenset[str]:
        """Keys that belong to another kind of motion."""
        return frozenset(type(self).model_fields) - {"kind"} - KEYS_OF_MOTION[self.kind]


KEYS_OF_MOTION = {
    "none": frozenset[str](),
    "harmonic": frozenset(
        {
            "amplitude_m",
            "peak_acceleration_m_s2",
            "angular_frequency_rad_s",
            "frequency_Hz",
            "phase_rad",
            "ramp_cycles",
            "cycles",
            "start",
        }
    ),
    "pulse": frozenset({"shape", "peak_acceleration_m_s2", "pulse_s", "delay_s", "start"}),
    "table": frozenset({"file", "quantity", "unit", "scale", "baseline", "start"}),
}


class InitialTable(CaseTable):
    """Where the container starts, beside the motion of the floor."""

    rotation_rad: Annotated[float, q.ROTATION] = Field(
        default=0.0, description="> 0 about the right corner, < 0 about the left"
    )
    angular_velocity_rad_s: Annotated[float, q.ANGULAR_VELOCITY] = Field(
        default=0.0, description="rigid, about that corner; at rotation 0 its sign chooses the corner"
    )
    velocity_m_s: Annotated[float, q.VELOCITY] = Field(
        default=0.0, description="relative to the floor, added"
    )


class StaticTable(CaseTable):
    """The lateral force method the run is compared with, EN 1998-1:2004, 4.3.3.2."""

    ground_acceleration_m_s2: Annotated[float, q.GROUND_ACCELERATION] = Field(
        default=1.6, description="reference peak ground acceleration a_gR"
    )
    soil_factor: Annotated[float, q.SOIL_FACTOR] = Field(default=1.5, description="S")
    corner_period_s: Annotated[float, q.CORNER_PERIOD] = Field(
        default=0.8,
        description="T_C, up to which the spectrum is level; 0.8 s: ground type D, as the paper has it",
    )
    behaviour_factor: Annotated[float, q.BEHAVIOUR_FACTOR] = Field(default=1.5, description="q")
    importance_factor: Annotated[float, q.IMPORTANCE_FACTOR] = Field(default=1.0, description="gamma_I")


class SolverTable(CaseTable):
    """Which model of the container, how finely meshed, how stepped, for how long."""

    model: Literal["full", "reduced", "rigid"] = Field(
        default="reduced", description='"full" (every node) | "reduced" (elastic modes) | "rigid"'
    )
    elastic_modes: Annotated[int, Strict(), q.MODE_COUNT] = Field(
        default=20, description="kept by the reduced model"
    )
    scheme: Literal["generalised-alpha", "newmark"] = Field(
        default="generalised-alpha", description='"generalised-alpha" | "newmark"'
    )
    spectral_radius: Annotated[float, q.SPECTRAL_RADIUS] = Field(
        default=0.5, description="generalised-alpha: damping of what the step does not resolve"
    )
    newmark_beta: Annotated[float, q.NEWMARK_BETA] = Field(default=0.25, description="newmark")
    newmark_gamma: Annotated[float, q.NEWMARK_GAMMA] = Field(default=0.5, description="newmark")
    step_s: Annotated[float, q.STEP] | Literal["auto"] = Field(
        default="auto", description='largest step, or "auto"'
    )
    energy_tolerance: Annotated[float, q.ENERGY_TOLERANCE] = Field(
        default=1.0,
        description="factor on the energy that a step may lose; 10: coarser and faster, for maps",
    )
    duration_s: Annotated[float, q.DURATION] = Field(default=20.0, description="simulated time")
    element_size_m: Annotated[float, q.ELEMENT_SIZE] = Field(
        default=0.1, description="of the structured mesh; mesh lines also at wall_m and foot_m"
    )
    order: Annotated[int, Strict(), q.ORDER] = Field(
        default=2, description="of the elements: 1 bilinear, 2 quadratic"
    )

    rules = (rules.newmark_is_unconditionally_stable, rules.steps_can_be_counted)

    def idle_keys(self) -> frozenset[str]:
        """The parameters of the scheme that is not chosen."""
        if self.scheme == "newmark":
            return frozenset({"spectral_radius"})
        return frozenset({"newmark_beta", "newmark_gamma"})


class OutputTable(CaseTable):
    """What is written, and how often."""

    history_s: Annotated[float, q.SAMPLING] = Field(default=0.005, description="interval of the history")
    fields_s: Annotated[float, q.FRAME_INTERVAL] = Field(
        default=0.05, description="interval of the fields for ParaView; 0: none"
    )
    figures: bool = Field(default=True, description="draw the figures of a run, as SVG")
    stop_when_overturned: bool = Field(
        default=True, description="end the run when the container lies on its side"
    )


TABLES: dict[str, type[CaseTable]] = {
    "container": ContainerTable,
    "support": SupportTable,
    "contact": ContactTable,
    "motion": MotionTable,
    "initial": InitialTable,
    "static": StaticTable,
    "solver": SolverTable,
    "output": OutputTable,
}


class CaseHeading(CaseTable):
    """The keys of a case file that stand before its first table."""

    schema_version: Annotated[int, Strict(), q.SCHEMA] = Field(
        default=1, alias="schema", description="of this file's keys"
    )
    title: Annotated[str, Field(max_length=500)] = Field(default="", description="for people")
    gravity_m_s2: Annotated[float, q.GRAVITY] = Field(default=9.81, description="g; the seed paper takes 10")
