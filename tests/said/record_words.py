"""How a file of a motion is understood, or why it is refused, for what a line of a transcript makes.

The line is written with the writers of `record_files`: `read(peer(FIRST / G, "UP"), take="horizontal")`.
"""

from pathlib import Path

import numpy as np
import record_files
from record_files import synthetic_motion

from fem.case.plausible import doubts
from fem.records.files import read_record
from fem.records.processing import Processing, processed
from fem.records.record import Component, Record, RecordError

FIRST, SECOND, THIRD = synthetic_motion(401)
WHOLE = FIRST[:400]  #: two seconds, as files of K-NET are cut
ROWS = "0,0.3\n0.05,0.8\n0.1,-0.8\n0.15,0.7\n0.2,0.5\n"
COLUMN = "".join(f"{value:.7f}\n" for value in FIRST)
SHAKE, TIMES = FIRST - FIRST.mean(), 0.005 * np.arange(401)


def read(text, *changes, take="", quantity="acceleration", channel="", **told):
    """A file with texts replaced, one after the other; or its component in a direction."""
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert old in text, old
        text = text.replace(old, new)
    path = Path("motion.txt")
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    record = read_record(path, **told)
    if take:
        return described(record.component(take, quantity=quantity, channel=channel))
    return in_words(record)


def in_words(record: Record) -> str:
    said = (record.format, record.event, record.station, record.date, *record.notes)
    return "\n".join([", ".join(filter(None, said)), *map(described, record.components)])


def described(one: Component) -> str:
    stated = f"{one.unit} {'as it says' if one.unit_stated else 'as told'}"
    times = f"{one.times.size} samples, {one.step:.4g} s{'' if one.time_stated else ' as nobody says'}"
    values = " ".join(f"{value:.4g}" for value in one.values[:6])
    return "; ".join([f"  {one.described}", stated, times, values, *one.notes])


def judged(times, values, *, baseline="none", **stated):
    """Doubts of a motion."""
    found = Component(times=times, readings=values, **stated)
    made = processed(found, Processing(baseline=baseline))
    return "\n".join(doubts("motion.txt", found, made, scale=1.0, confirmed=False)) or "no doubts"


def recorded(asked):
    try:
        return str(eval(asked, vars(record_files) | globals()))  # a line of this folder
    except RecordError as error:
        return str(error)
