"""The tables [initial], [static], [wind], [limits], [solver], [output], [document]: a run, its files, who signs it."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, Strict

from fem.case.tables import quantities as q
from fem.case.tables.problem import Rule, one_of
from fem.case.tables.table import CaseTable, OneLine, case_key, optional_key


class InitialTable(CaseTable):
    """Where the container starts, beside the motion of the floor."""

    rotation_rad: Annotated[float, q.ROTATION] = case_key(
        "> 0 about the right corner, < 0 about the left", 0.0
    )
    angular_velocity_rad_s: Annotated[float, q.ANGULAR_VELOCITY] = case_key(
        "rigid, about that corner; at rotation 0 its sign chooses the corner", 0.0
    )
    velocity_m_s: Annotated[float, q.VELOCITY] = case_key("relative to the floor, added", 0.0)

    @property
    def is_pushed(self) -> bool:
        """Whether the container starts tilted or in motion."""
        return any((self.rotation_rad, self.angular_velocity_rad_s, self.velocity_m_s))


class StaticTable(CaseTable):
    """The lateral force method, EN 1998-1:2004, 4.3.3.2, beside the run; without this table it is left out."""

    ground_acceleration_m_s2: Annotated[float, q.GROUND_ACCELERATION] = case_key(
        "reference peak ground acceleration a_gR", 1.6
    )
    soil_factor: Annotated[float, q.SOIL_FACTOR] = case_key("S", 1.5)
    corner_period_s: Annotated[float, q.CORNER_PERIOD] = case_key(
        "T_C, up to which the spectrum is level; 0.8 s: ground type D, as the paper has it", 0.8
    )
    behaviour_factor: Annotated[float, q.BEHAVIOUR_FACTOR] = case_key("q", 1.5)
    importance_factor: Annotated[float, q.IMPORTANCE_FACTOR] = case_key("gamma_I", 1.0)


class WindTable(CaseTable):
    """The wind, on the lightest container: of a case, on it as it is; not combined with the earthquake."""

    peak_velocity_pressure_Pa: Annotated[float, q.WIND] | None = optional_key(
        "q_p at the top of the container", 650.0
    )
    german_zone: Annotated[int, Strict(), q.Quantity(least=1, most=4)] | None = optional_key(
        "wind zone, in place of q_p: simplified pressure", 2
    )
    german_place: Literal["inland", "coast", "North Sea islands"] = case_key(
        '"inland" | "coast" | "North Sea islands"', "inland"
    )
    terrain: Literal["0", "I", "II", "III", "IV"] | None = optional_key(
        "category of EN 1991-1-4, in place of q_p: with basic_velocity_m_s", "II"
    )
    basic_velocity_m_s: Annotated[float, q.Quantity(unit="m/s", above=0.0, most=60.0)] | None = optional_key(
        "v_b, with terrain", 25.0
    )
    gamma_mu: Annotated[float, q.GAMMA_MU] = case_key("partial factor on friction under wind", 1.0)

    rules = (
        one_of("wind.peak_velocity_pressure_Pa", "german_zone", "terrain"),
        Rule(
            "wind.basic_velocity_m_s",
            lambda wind: (wind.basic_velocity_m_s is None) == (wind.terrain is None),
            "and terrain belong together",
        ),
    )


class RunLimitsTable(CaseTable):
    """What is allowed; no run changes for it."""

    slip_m: Annotated[float | None, q.LENGTH] = optional_key(
        "slip beyond which the container leaves its place; default: its width, or the gap to a neighbour", 0.1
    )


class SolverTable(CaseTable):
    """Model of the container, mesh, time steps and duration."""

    model: Literal["full", "reduced", "rigid"] = case_key(
        '"full" (every node) | "reduced" (elastic modes) | "rigid"', "reduced"
    )
    elastic_modes: Annotated[int, Strict(), q.MODE_COUNT] = case_key("kept by the reduced model", 20)
    scheme: Literal["generalised-alpha", "newmark"] = case_key(
        '"generalised-alpha" | "newmark"', "generalised-alpha"
    )
    spectral_radius: Annotated[float, q.SPECTRAL_RADIUS] = case_key(
        "generalised-alpha: damping of what the step does not resolve",
        0.5,
        only=("scheme", "generalised-alpha"),
    )
    newmark_beta: Annotated[float, q.NEWMARK_BETA] = case_key("newmark", 0.25, only=("scheme", "newmark"))
    newmark_gamma: Annotated[float, q.NEWMARK_GAMMA] = case_key("newmark", 0.5, only=("scheme", "newmark"))
    step_s: Annotated[float, q.STEP] | Literal["auto"] = case_key('largest step, or "auto"', "auto")
    energy_tolerance: Annotated[float, q.ENERGY_TOLERANCE] = case_key(
        "factor on the energy that a step may lose; 10: coarser and faster, for maps", 1.0
    )
    duration_s: Annotated[float, q.DURATION] | Literal["auto"] = case_key(
        'simulated time, or "auto": pulse and table: their end and free motion until rest or a fall, '
        "at most 60 s more; else 20 s",
        "auto",
    )
    element_size_m: Annotated[float, q.ELEMENT_SIZE] = case_key(
        "of the structured mesh; mesh lines also at wall_m and foot_m", 0.1
    )
    order: Annotated[int, Strict(), q.ORDER] = case_key("of the elements: 1 bilinear, 2 quadratic", 2)

    rules = (
        # 2 beta >= gamma >= 1/2: stable for every step (Hughes, The Finite Element Method, 1987, 9.1.2)
        Rule(
            "solver.newmark_beta",
            lambda solver: solver.scheme != "newmark" or 2.0 * solver.newmark_beta >= solver.newmark_gamma,
            lambda solver: (
                f"must be at least newmark_gamma/2 = {solver.newmark_gamma / 2.0:g} to be stable at every step, "
                f"got {solver.newmark_beta:g}; 1/4 and 1/2 are usual"
            ),
        ),
    )


class OutputTable(CaseTable):
    """Files to write, and their intervals."""

    history_s: Annotated[float, q.SAMPLING] = case_key("interval of the history", 0.005)
    fields_s: Annotated[float, q.FRAME_INTERVAL] | Literal["auto"] = case_key(
        'interval of the fields for ParaView and films; 0: none; "auto": 0.05 or longer, so that they take 16 MB',
        "auto",
    )
    contents_filter_Hz: Annotated[float, q.CONTENTS_FILTER] = case_key(
        "acceleration of the contents: cut-off of its low-pass filter, Butterworth of two poles", 33.0
    )
    figures: bool = case_key("draw the figures of a run, as SVG", True)
    stop_when_overturned: bool = case_key("end the run when the container lies on its side", True)
    stop_when_still: bool = case_key(
        "rigid, under records: end the run when the container is at rest and what is left of them is below 0.9 of what "
        "moves it; acceleration and sway of the contents are then not followed",
        False,
    )


Text = Annotated[str | None, Field(max_length=200), OneLine]
#: a document may have the number 2417
Mark = Annotated[Text, BeforeValidator(lambda mark: str(mark) if type(mark) is int else mark)]


class DocumentTable(CaseTable):
    """What identifies the pages of a case; it is no part of the hash."""

    project: Text = optional_key("for every page", "Store of chemicals, hall 3")
    company: Text = optional_key("for every page", "Example Ltd")
    number: Mark = optional_key("of the document", "2417-ST-03")
    revision: Mark = optional_key("of the document", "A")
    author: Text = optional_key("who made it", "A. Author")
    checker: Text = optional_key("who checked it", "C. Checker")
