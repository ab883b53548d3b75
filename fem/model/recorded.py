"""The recorded motions of a case: read from its files and processed as its keys say."""

from typing import Literal

from contact.motion.table import TableMotion
from fem.case.case import Case
from fem.records.files import read_record
from fem.records.processing import Processing, processed

Direction = Literal["motion", "vertical"]  #: the table of a motion: along x, or vertical


def recorded_motion(case: Case, table: Direction) -> TableMotion:
    """The motion of a table of the case whose kind is "table".

    Raises:
        ValueError: its file is missing or no motion, or the keys do not fit it.
    """
    motion = case.vertical if table == "vertical" else case.motion
    record = read_record(case.data_files[f"{table}.file"], unit=motion.unit)
    quantity = motion.quantity or "acceleration"
    found = record.component("vertical" if table == "vertical" else "horizontal", quantity=quantity)
    made = processed(found, Processing(scale=motion.scale, baseline=motion.baseline))
    return TableMotion(times=made.times, values=made.values, quantity=quantity)
