"""Units of recorded motions and how headers spell them, and what a column or component is by its name.

A unit is never guessed: the file or its user states it. One table of words for every format: a name is what remains of
it without brackets, tags, units and words such as "component".
"""

import re
from itertools import takewhile
from typing import NamedTuple

from fem.records.record import Direction, Quantity

STANDARD_GRAVITY = 9.80665  #: of a record in g (ISO 80000-3), not the gravity of the case [m/s2]


class Unit(NamedTuple):
    """The quantity of a unit, and its factor to SI."""

    quantity: Quantity
    factor: float


UNITS = {
    "m/s2": Unit("acceleration", 1.0), "g": Unit("acceleration", STANDARD_GRAVITY), "cm/s2": Unit("acceleration", 1e-2),
    "gal": Unit("acceleration", 1e-2), "mm/s2": Unit("acceleration", 1e-3),
    "mg": Unit("acceleration", 1e-3 * STANDARD_GRAVITY), "g/10": Unit("acceleration", 0.1 * STANDARD_GRAVITY),
    "m/s": Unit("velocity", 1.0), "cm/s": Unit("velocity", 1e-2), "mm/s": Unit("velocity", 1e-3),
    "m": Unit("displacement", 1.0), "cm": Unit("displacement", 1e-2), "mm": Unit("displacement", 1e-3),
}  # fmt: skip
#: units that headers are known to give and that are not read
FOREIGN = (
    "in", "ft", "in/s2", "ft/s2", "%g", "in/s", "ft/s", "counts", "volts", "v", "mv", "h", "hz", "%", "rad/s",
    "deg", "d",
)  # fmt: skip
#: units of time, and of rates, to s and 1/s
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}
RATES = {"hz": 1.0, "khz": 1e3}
SPELLED = {unit: unit for unit in (*UNITS, *FOREIGN, *TIMES, *RATES)} | {
    "gals": "gal", "g's": "g", "millis": "ms", "micros": "us", "μs": "us", "minute": "min", "minutes": "min",
    "mins": "min", "hour": "h", "hours": "h", "hr": "h", "hrs": "h", "day": "d", "days": "d", "hertz": "hz",
    "1/s": "hz", "sps": "hz", "samples/s": "hz", "points/s": "hz", "pts/s": "hz", "muestras/s": "hz", "count": "counts",
    "volt": "volts", "percent": "%", "%ofg": "%g", "percentg": "%g",
}  # fmt: skip
#: what a user may state; a file may also state the others
STATED = ("g", "m/s2", "cm/s2", "gal", "mm/s2", "m")
OTHERWISE = 'state it as unit = "g", "m/s2", "cm/s2", "gal" or "mm/s2" (displacements: "m")'
#: "in units of G", "UNIT: CM/SEC/SEC", "unit = gal(cm/s/s)"; "acceleration in g", where a quantity is in the line
UNITS_OF = re.compile(
    r"\b(?:units?|unidades|einheit)\b(?:\s+(?:of|is|are)\b)?\s*[:=]?\s*(.{1,80})", re.IGNORECASE
)
QUANTITY_IN = re.compile(r"\b(?:acc|vel|disp)[a-z]*\b.{0,60}?\bin\s+(\S{1,30})", re.IGNORECASE)


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


UPWARD = _words("up u ud u-d v ver vert vertical z updown up-down az hnz hlz bnz hgz -up +")
DOWNWARD = _words("down dwn dn d downward -z -v")
HORIZONTAL = _words(
    "n s e w ns ew sn we n-s e-w s-n w-e h h1 h2 x y ax ay l t r tr long longitudinal lon tran trans transverse "
    "transversal radial rad radl tang tangential north south east west horizontal hor horiz northsouth eastwest "
    "north-south east-west norte sur este oeste"
)
AZIMUTH = re.compile(r"[ns]?\s*(\d{1,3})\s*[ew]?(\s*deg(rees)?|°)?", re.ASCII)
#: what says nothing about a direction
PLAIN = _words(
    "a acc accel acceleration component comp channel chan direction dir motion record value ground base floor "
    "corrected uncorrected raw"
)
QUANTITIES: dict[str, Quantity] = {
    **dict.fromkeys(
        _words("a acc acce accel acceleration accelerations acel aceleracion ag"), "acceleration"
    ),
    **dict.fromkeys(_words("vel velo veloc velocity velocities geschwindigkeit"), "velocity"),
    **dict.fromkeys(_words("dis disp displ displacement displacements weg"), "displacement"),
}
TIME = _words("time times t zeit temps tiempo tempo sec secs second seconds elapsed zaman")
#: words of what is neither a time nor a motion
OTHER = {
    **dict.fromkeys(_words("period periods periode periodo tn t0"), "a period"),
    **dict.fromkeys(_words("frequency frequencies freq frequenz f hz omega"), "a frequency"),
    **dict.fromkeys(
        _words("no nr number num sample samples index idx point points row id i count # nº"), "a count"
    ),
    **dict.fromkeys(_words("sa sae se psa psv sv sd spa spectral spectrum spectra drs uhs"), "a spectrum"),
    **dict.fromkeys(_words("fourier fas fft psd dft"), "a Fourier spectrum"),
    **dict.fromkeys(_words("arias intensity ia cav husid"), "an intensity"),
    **dict.fromkeys(_words("strain stress force moment"), "a strain or a force"),
}
BRACKETS = re.compile(r"<[^<>]{0,40}>|[\[({][^\[\](){}]{0,60}(?:[\])}]|$)")


def unit_spelled(text: str) -> str | None:
    """The unit that a header spells, such as CM/SEC/SEC, m s-2, m_s2 or gal(cm/s/s); None for an unknown unit."""
    word = text.strip(" \t[](){}.,;:").partition("(")[0].casefold().replace("²", "2").replace("−", "-")
    word = re.sub(r"\s+|\*\*|\^|\*|·", "", word) if "_" not in word else word.replace("_", "/", 1)
    word = re.sub(r"se[cg](ond|undo)?s?", "s", word)
    word = word.replace("/s/s", "/s2").replace("s-2", "/s2").replace("s-1", "/s").replace("//", "/")
    return SPELLED.get(word)


def units_in_words(line: str) -> list[str | None]:
    """The units that a line states in words, two at most, in their order."""
    if match := UNITS_OF.search(line):
        words = [
            word for word in re.split(r"[\s,;]+", match[1]) if word.casefold() not in ("", "and", "in", "of")
        ]
        return [*takewhile(bool, map(unit_spelled, words[:2]))]
    match = QUANTITY_IN.search(line)
    unit = unit_spelled(match[1]) if match else None
    return [unit] if unit in UNITS or unit in FOREIGN else []


class Name(NamedTuple):
    """What a name says."""

    word: str = ""  #: the known word in it
    is_time: bool = False
    other: str = ""  #: what it is where it is neither time nor motion, such as "a period"
    quantity: Quantity | None = None
    direction: Direction | None = None
    sense: float = 1.0  #: -1 where it is positive downward


def named(text: str) -> Name:
    """What the name of a column says."""
    bare = BRACKETS.sub("", text).strip(" \t'\".:").casefold()
    words = [word for word in re.split(r"[\s_,;:./]+", bare) if word]
    for length in (2, 1):  # no unit has more words, such as m_s2
        if len(words) > length and unit_spelled("_".join(words[-length:])) in (*UNITS, *TIMES):
            words = words[:-length]
            bare = "_".join(words)
            break
    joined = "".join(words)
    quantity = next((QUANTITIES[word] for word in words if word in QUANTITIES), None)
    is_time = joined in TIME or any(word in TIME and len(word) > 1 for word in words)
    for word in (*words, joined):
        # "i", "f" and the like are words of their own, but the ends of others; "sample time" is a time
        alone = len(word) > 1 or words[:1] == [word]
        if (meaning := OTHER.get(word)) and alone and not (is_time and meaning == "a count"):
            return Name(word=word, other=meaning)
    if is_time:
        return Name(word="t" if joined == "t" else "time", is_time=True)
    direction, sense = direction_of(bare)
    word = next((word for word in words if word in QUANTITIES), "")
    return Name(word=bare if direction else word, quantity=quantity, direction=direction, sense=sense)


def direction_of(text: str) -> tuple[Direction | None, float]:
    """Direction by a name, and the factor that makes a vertical component positive upward: -1 of "down".

    Brackets, and words that say nothing, are cut off; a number up to 360 is an azimuth in degrees. None where the name
    gives none.
    """
    bare = BRACKETS.sub(" ", text).strip(" \t'\".:,;").casefold()
    words = [word for word in re.split(r"[\s_,;:.]+", bare) if word and word not in PLAIN]
    for name in (bare, *([" ".join(words), "".join(words)] if words else [])):
        if name in UPWARD:
            return "vertical", 1.0
        if name in DOWNWARD:
            return "vertical", -1.0
        azimuth = AZIMUTH.fullmatch(name)
        if name in HORIZONTAL or (azimuth and int(azimuth[1]) <= 360):
            return "horizontal", 1.0
        if stream := stream_direction(name):
            return stream, 1.0
    return None, 1.0


def stream_direction(code: str) -> Direction | None:
    """Direction by the code of a stream, such as HNE or HNZ."""
    match = re.fullmatch(r"[bcdefghlmsuv][nlghj]([zne123rtxy])", code.casefold())
    if match is None:
        return None
    return "vertical" if match[1] == "z" else "horizontal"
