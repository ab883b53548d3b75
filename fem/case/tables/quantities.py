"""The physical quantities of a case file: unit, allowed range, and common slips.

Every number of a case file is SI and carries its unit in its key. A number outside its range is refused with the range,
the value, the unit and, where it would fit in another common unit (mm, kN, GPa, degrees, per cent), with that guess.
The ranges include every container that the program can compute; they catch slips and do not judge a design.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass, field
from functools import partial
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema


@dataclass(frozen=True)
class Quantity:
    """A finite number with its unit and range, as metadata of an annotated `float`."""

    unit: str = ""  #: SI unit as printed; empty for a pure number
    least: float | None = None  #: smallest value allowed
    most: float | None = None  #: largest value allowed
    _: KW_ONLY
    above: float | None = None  #: every value allowed is greater than this
    below: float | None = None  #: every value allowed is less than this
    typical: float | None = None  #: an ordinary magnitude, to choose between guesses
    #: other unit -> what one of it is in SI
    slips: Mapping[str, float] = field(default_factory=dict, hash=False)
    advice: str = ""  #: for a value out of range that is no slip

    def allows(self, value: float) -> bool:
        """Whether the value is a finite number within the range."""
        return (
            (not isinstance(value, float) or math.isfinite(value))
            and (self.least is None or value >= self.least)
            and (self.above is None or value > self.above)
            and (self.most is None or value <= self.most)
            and (self.below is None or value < self.below)
        )

    @property
    def range_in_words(self) -> str:
        """The range in words, without its unit."""
        if self.least is not None and self.most is not None:
            return (
                f"{self.least:g}" if self.least == self.most else f"between {self.least:g} and {self.most:g}"
            )
        bounds = {
            "at least": self.least,
            "positive" if self.above == 0.0 else "more than": self.above,
            "at most": self.most,
            "less than": self.below,
        }
        words = (f"{word} {bound:g}" for word, bound in bounds.items() if bound is not None)
        return " and ".join(words).replace("positive 0", "positive")

    def guess(self, value: float, accept: Callable[[float], bool] | None = None) -> str:
        """The unit that the value was probably meant in, as a question, or an empty string.

        It is the unit of `slips` that brings the value into the range (and into `accept`) and nearest to `typical`.
        """
        if self.typical is None or value == 0.0 or not math.isfinite(value):
            return ""
        candidates = [(name, value * factor) for name, factor in self.slips.items()]
        fitting = [
            (abs(math.log10(abs(converted) / self.typical)), name, converted)
            for name, converted in candidates
            if self.allows(converted) and (accept is None or accept(converted))
        ]
        if not fitting:
            return ""
        _, name, converted = min(fitting)
        return f"looks like {name}: {with_unit(converted, self.unit)}?"

    def check(self, value: float) -> float:
        """Return the value; raises ValueError with range, value, unit and a way out."""
        if self.allows(value):
            return value
        way_out = self.guess(value) or self.advice
        required = f"{self.range_in_words} {self.unit}".strip()
        reason = f"must be {required}, got {with_unit(value, self.unit)}"
        raise ValueError(f"{reason}; {way_out}" if way_out else reason)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Check the number after pydantic's own strict reading of it."""
        return core_schema.no_info_after_validator_function(self.check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Range and unit for the JSON schema of the case file."""
        bounds = {
            "minimum": self.least,
            "exclusiveMinimum": self.above,
            "maximum": self.most,
            "exclusiveMaximum": self.below,
            "x-unit": self.unit or None,
        }
        return {**handler(schema), **{name: value for name, value in bounds.items() if value is not None}}


def with_unit(value: object, unit: str) -> str:
    """A value for a message: numbers short, text in quotes, with its unit."""
    text = f"{value:.7g}" if isinstance(value, float) else repr(value)
    text = text if len(text) <= 80 else f"{text[:76]} ..."
    return f"{text} {unit}" if unit else text


MILLI_AND_CENTI = {"millimetres": 1e-3, "centimetres": 1e-2}
DEGREES = {"degrees": math.pi / 180.0}
GAL = {"gal (cm/s2)": 1e-2, "mm/s2": 1e-3}
PER_CENT = {"per cent": 1e-2}
TONNES = {"t/m3 (g/cm3)": 1e3}
SLOW, MILLISECONDS = {"mm/s": 1e-3}, {"milliseconds": 1e-3}
LOADS = {"kilonewtons": 1e3, "tonnes": 9.81e3}
PASCALS = {"GPa (kN/mm2)": 1e9, "MPa (N/mm2)": 1e6}
metres = partial(Quantity, "m", slips=MILLI_AND_CENTI)

LENGTH = metres(1e-3, 100.0, typical=1.0)
WALL = metres(1e-6, 50.0, typical=0.01)
CASTING = metres(0.0, 10.0, typical=0.17)
POST = metres(1e-4, 10.0, typical=0.05)
CORNER_FORCE = Quantity("N", 1.0, 1e12, typical=5e5, slips=LOADS)
CAMBER = metres(0.0, 1.0, typical=5e-3)
FOOT = metres(1e-6, 100.0, typical=0.1)
ELEMENT_SIZE = metres(1e-5, 100.0, typical=0.1)
OFFSET = metres(-100.0, 100.0, typical=0.1)
GRAVITY = Quantity("m/s2", 1e-2, 100.0, typical=9.81, slips={"cm/s2": 1e-2, "mm/s2": 1e-3})
WEIGHT = Quantity("N", above=0.0, typical=25e3, slips={"kilonewtons": 1e3, "meganewtons": 1e6})
MASS = Quantity("kg", above=0.0, typical=2.5e3, slips={"tonnes": 1e3})
# From the lightest foam to heavier than osmium: the mean of walls, fill and what is empty.
DENSITY = Quantity("kg/m3", 5.0, 25e3, typical=2e3, slips=TONNES)
WALL_DENSITY = Quantity("kg/m3", 50.0, 25e3, typical=7850.0, slips=TONNES)
STIFFNESS = Quantity("Pa", 1e6, 1e13, typical=2.1e11, slips=PASCALS | {"kN/cm2": 1e7})
POISSON = Quantity("", 0.0, 0.5, advice="steel has 0.3")
MATERIAL_DAMPING = Quantity(least=0.0, below=1.0, typical=0.02, slips=PER_CENT)
ROCKING_DAMPING = Quantity(least=0.0, below=1.0, typical=0.05, slips=PER_CENT)
CONTACT_DAMPING = Quantity("", 0.0, 1e3, advice="2 is usual")
RESTITUTION = Quantity("", 0.5, 2.0, typical=1.0, slips=PER_CENT, advice="measured on concrete: 0.93 to 1.05")
LINK_HEIGHT = metres(0.0, 1e3, typical=0.5)
GAP = metres(0.0, 1e3, typical=0.05, advice="a gap below 0 would overlap at the start")
LINK_STIFFNESS = Quantity(
    "N/m", 1.0, 1e12, typical=1e7, slips={"kN/m": 1e3, "kN/mm": 1e6}, advice="1e8 is a kerb"
)
LINK_FORCE = Quantity("N", 1.0, 1e12, typical=1e5, slips=LOADS, advice="what holds nothing is left out")
STOP_RESTITUTION = Quantity(
    "",
    0.005,
    1.0,
    typical=0.5,
    slips=PER_CENT,
    advice="below that take damping_ratio = 10, which leaves 0.25 % of the velocity",
)
FRICTION = Quantity("", 0.0, 5.0, typical=0.4, slips=PER_CENT, advice="steel on concrete has 0.3 to 0.4")
SLIP_VELOCITY = Quantity(
    "m/s", 1e-9, 1.0, typical=1e-3, slips=SLOW, advice="about 1e-3 of the largest slip velocity is usual"
)
PENALTY = Quantity("Pa/m", 1.0, 1e20, advice='"auto" chooses it')
FLOOR_STIFFNESS = Quantity("Pa", 1e5, 1e12, typical=3e10, slips=PASCALS, advice="concrete has 3e10")
# 0.5 is a fluid: no shear, and the half-space does not yield at all
FLOOR_POISSON = Quantity(least=0.0, below=0.5, advice="concrete has 0.2, rubber 0.49")
BEARING_STRENGTH = Quantity(
    "Pa", 1e4, 1e11, typical=5e7, slips=PASCALS | {"kN/m2 (kPa)": 1e3}, advice="concrete has 2.5e7 to 1e8"
)
PATCH = metres(1e-4, 100.0, typical=0.02)
SLOPE = Quantity("per cent", -60.0, 60.0, advice="1 to 2 is usual for drainage, 40 to 60 in tilt tests")
EFFECTIVE_WIDTH = Quantity("", 0.5, 1.0, advice="0.97 to 1 is usual")
DRAWS = Quantity("", 0, 1024, advice="32 is usual")
RATIO = Quantity("", 1e-6, 1e3, advice="1 is usual")
WEAKENING = Quantity("m", 0.0, 0.1, typical=1e-4, slips={"micrometres": 1e-6, "millimetres": 1e-3})
STRIBECK_VELOCITY = Quantity("m/s", 0.0, 10.0, typical=0.1, slips=SLOW, advice="0.3 is a slow fall")
AMPLITUDE = metres(0.0, 10.0, typical=0.05)
PEAK_ACCELERATION = Quantity("m/s2", -100.0, 100.0, typical=4.0, slips=GAL)
ANGULAR_FREQUENCY = Quantity(
    "rad/s", 0.0628, 628.4, advice="0.01 to 100 Hz; a frequency f in Hz is 2 pi f in rad/s"
)
FREQUENCY = Quantity("Hz", 0.01, 100.0, advice="a period T in s is a frequency 1/T in Hz")
PHASE = Quantity("rad", -6.2832, 6.2832, typical=1.0, slips=DEGREES, advice="one turn is 2 pi")
CYCLES = Quantity(above=0.0, most=1e7)
RAMP_CYCLES = Quantity("", 0.0, 1e7)
PULSE_DURATION = Quantity("s", 1e-9, 1e4, advice="milliseconds are 1e-3 s")
DELAY = Quantity("s", 0.0, 1e4)
SAMPLE_INTERVAL = Quantity("s", 1e-6, 10.0, typical=0.005, slips=MILLISECONDS, advice="0.005 is usual")
RECORD_TIME = Quantity("s", -1e6, 1e6)
SCALE = Quantity("", -1e6, 1e6)
ROTATION = Quantity(
    "rad",
    above=-math.pi / 2,
    below=math.pi / 2,
    typical=0.1,
    slips=DEGREES,
    advice="at a quarter turn the container lies on its side",
)
ANGULAR_VELOCITY = Quantity("rad/s", -100.0, 100.0, typical=0.5, slips=DEGREES)
VELOCITY = Quantity("m/s", -100.0, 100.0, typical=0.5, slips=SLOW)
GROUND_ACCELERATION = Quantity("m/s2", 0.0, 50.0, typical=1.6, slips=GAL)
SOIL_FACTOR = Quantity("", 0.1, 5.0, advice="EN 1998-1:2004, Table 3.2 has 1.0 to 1.8")
CORNER_PERIOD = Quantity(
    "s", above=0.0, most=10.0, advice="EN 1998-1:2004, Tables 3.2 and 3.3 have 0.25 to 0.8"
)
BEHAVIOUR_FACTOR = Quantity("", 1.0, 10.0, advice="1.0 is elastic, 1.5 is usual")
IMPORTANCE_FACTOR = Quantity("", 0.1, 5.0, advice="EN 1998-1:2004, 4.2.5 has 0.8 to 1.4")
WIND = Quantity("Pa", above=0.0, most=1e4, typical=650.0, slips={"kN/m2": 1e3})
GAMMA_MU = Quantity("", 1.0, 3.0, advice="1.3 is usual for scaffolds")
SPECTRAL_RADIUS = Quantity("", 0.0, 1.0, advice="0.5 is usual; 1 does not damp")
NEWMARK_BETA = Quantity(above=0.0, most=1.0, advice="1/4 is the average acceleration")
NEWMARK_GAMMA = Quantity("", 0.5, 1.5, advice="1/2 is of second order and does not damp")
ENERGY_TOLERANCE = Quantity("", 1e-3, 30.0, advice="1 is usual, 10 is enough for maps")
SLIP_LIMIT = Quantity("m", 0.0, 100.0, advice="a clearance such as 0.1")
STEP = Quantity("s", 1e-9, 10.0, advice='"auto" chooses it')
DURATION = Quantity("s", 1e-3, 1e4, typical=20.0, slips=MILLISECONDS)
SAMPLING = Quantity("s", 1e-7, 1e4)
CONTENTS_FILTER = Quantity("Hz", 1.0, 1000.0, advice="33 is usual")
FRAME_INTERVAL = Quantity("s", 0.0, 1e4, advice="0 writes no fields")

NEIGHBOUR = Quantity("", 1, 5)
BOXES = Quantity("", 1, 50)
MODE_COUNT = Quantity("", 0, 1000)
ORDER = Quantity("", 1, 2, advice="1 is bilinear, 2 quadratic")
SCHEMA = Quantity("", 1, 1, advice="this program reads schema 1")
