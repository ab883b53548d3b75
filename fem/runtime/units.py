"""Units for people, and the text of a number in them, alone or with its range.

Where a range is wider than a tenth, number and ends have two significant figures; more would not be known.
"""

import math
from dataclasses import dataclass, replace

Reach = tuple[float, float]

WIDE = 0.1  #: width of a range over its larger end, from which two figures are enough
FEW, MANY = 2, 4  #: significant figures
FAR_BELOW = 10.0  #: of the longer unit in thousandths: ends below it keep the unit, each end then has its own
INVISIBLE = 1e-9  #: in the units of people: smaller numbers are rounding


@dataclass(frozen=True, kw_only=True)
class DisplayUnit:
    """A unit in which people read a quantity."""

    name: str = ""
    factor: float = 1.0  #: from SI to this unit
    least: float = 0.0  #: sizes below it [SI] are shown as that limit
    figures: int = MANY  #: significant figures, without trailing zeros where they are four
    whole: bool = False  #: it counts
    full: bool = False  #: no digit before the point is rounded off
    #: the unit a thousand times as large, for sizes from there on; tables of one unit keep this one
    long: str = ""

    def text(
        self,
        value: float | None,
        reach: Reach | None = None,
        *,
        figures: int | None = None,
        bare: bool = False,
    ) -> str:
        """A number with its range and unit, such as "0.22 (0.0013 to 0.40) kN"; empty where there is none.

        Args:
            value: in SI.
            reach: the [low, high] that it has; None: the number alone.
            figures: of a number whose range is narrow; None: those of the unit.
            bare: without the unit.
        """
        if value is None:
            return ""
        kept = figures_of(reach, figures or self.figures)
        if self.long and not bare and self.factor * max(map(abs, ends := (value, *(reach or ())))) >= 1e3:
            if self.factor * min(map(abs, ends)) >= FAR_BELOW:
                longer = replace(self, name=self.long, factor=1e-3 * self.factor, long="")
                return longer.text(value, reach, figures=figures)
            number, *of_range = (self.text(end, figures=kept) for end in ends)
            return f"{number} ({' to '.join(of_range)})"
        low, high = (self.in_figures(end, kept) for end in reach or (value, value))
        number = self.in_figures(value, kept)
        words = number if low == high else f"{number} ({low} to {high})"
        return words if bare else f"{words} {self.name}".rstrip()

    def range_text(self, reach: Reach) -> str:
        """A range alone, such as "0.6 to 32 kN"; its one number where the ends are shown alike."""
        low, high = (self.in_figures(end, figures_of(reach, self.figures)) for end in reach)
        if 0.0 <= reach[0] < self.least < reach[1]:
            return f"up to {high} {self.name}".rstrip()
        return f"{low if low == high else f'{low} to {high}'} {self.name}".rstrip()

    def in_figures(self, value: float, figures: int) -> str:
        """A number [SI] with so many significant figures, or the limit that it is below."""
        if self.full:
            figures = max(figures, len(str(int(abs(self.factor * value)))))
        return f"{value:.0f}" if self.whole else in_figures(value, figures, self.factor, self.least)


def figures_of(reach: Reach | None, many: int = MANY) -> int:
    """Significant figures that a number of such a range has."""
    if reach is None:
        return many
    return FEW if reach[1] - reach[0] > WIDE * max(map(abs, reach)) else many


def in_unit(value: float, factor: float) -> float:
    """A number times a factor; half a digit, as in 53.955, is then rounded alike on all machines."""
    return float(f"{factor * value:.12g}")


def finite(value: float) -> float | None:
    """A number, as JSON has it; None for an infinite one and none."""
    return value if math.isfinite(value) else None


def in_figures(value: float, figures: int, factor: float = 1.0, least: float = 0.0) -> str:
    """A number with so many significant figures, without an exponent where it has at most six digits."""
    number = in_unit(value, factor)
    if abs(number) < INVISIBLE:
        return "0"
    if abs(value) < least:
        return f"< {factor * least:g}"
    digits = figures - 1 - math.floor(math.log10(abs(float(f"{number:.{figures - 1}e}"))))
    if not -4 <= digits - figures + 1 <= 5 and abs(number) < 1e-4:
        return f"{number:.{figures - 1}e}"
    words = f"{round(number, digits):.{max(digits, 0)}f}"
    return words.rstrip("0").rstrip(".") if figures == MANY and "." in words else words


def plain_number(value: float, figures: int = 3) -> str:
    """A number without a unit and without trailing zeros: 1350 for 1.35e+03."""
    return f"{float(f'{value:.{figures}g}'):.{max(figures, 6)}g}"


def visible_number(value: float | None, factor: float = 1.0, form: str = ".4g") -> str:
    """A number in a table on a screen; 0 where it is rounding, a hyphen where there is none."""
    if value is None:
        return "-"
    number = in_unit(value, factor)
    return "0" if abs(number) < INVISIBLE else format(number, form)


COUNT, WHOLE, SECONDS = DisplayUnit(), DisplayUnit(whole=True), DisplayUnit(name="s")
MILLIMETRES = DisplayUnit(name="mm", factor=1e3, least=1e-5, long="m")
METRES = DisplayUnit(name="m")
SHORT_MILLIMETRES = replace(MILLIMETRES, figures=3)
#: what loose boxes slip at impacts is less known than that: their joints' dashpots decide it
JOINT_MILLIMETRES = replace(SHORT_MILLIMETRES, least=1e-3)
DEGREES = DisplayUnit(name="degrees", factor=math.degrees(1.0), least=math.radians(0.01), figures=3)
#: of a rotation to the slenderness angle; a tenth of what counts as rocking
RATIO = DisplayUnit(least=1e-3, figures=3)
PERCENT = DisplayUnit(name="%", factor=100.0, least=1e-3, figures=FEW, full=True)
KILONEWTONS = DisplayUnit(name="kN", factor=1e-3, least=10.0)
VELOCITY, ACCELERATION = DisplayUnit(name="m/s", least=1e-5), DisplayUnit(name="m/s2")
MEGAPASCALS = DisplayUnit(name="MPa", factor=1e-6)
