"""The words of headers: what a column or component is by its name, its direction, and which way it is positive.

One table for every format. A name is what remains of it without brackets, tags, units and words such as "component".
"""

import re
from typing import NamedTuple

from fem.records.record import Direction, Quantity
from fem.records.units import TIMES, UNITS, unit_spelled


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
