"""A sweep of ten cells that several tests compute, other sweeps from their texts, and tables for comparison."""

import csv
from pathlib import Path

from fem.study.design import Sweep
from fem.study.file import load_sweep
from fem.study.table import fields_of

SMALL = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"floor.kind" = "rigid"
"solver.duration_s" = 2.0
"uncertainty.draws" = 8
[axes]
"motion.angular_frequency_rad_s" = { from = 2.0, to = 6.0, count = 2 }
"motion.peak_acceleration_m_s2" = { from = 2.0, to = 14.0, count = 5 }
[derived]
"contact.mu_kinetic" = "0.5 * contact.mu_static"
"""


def sweep_in(folder: Path, text: str = SMALL, name: str = "small") -> Sweep:
    """The sweep of a text, whose file is written to a folder."""
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return load_sweep(path)


def rows_of(path: Path) -> list[dict[str, str]]:
    """The rows of a table with a header."""
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


def rows_without_wall(folder, name="table.csv"):
    """The fields of a table, but for the wall time."""
    header, *rows = (fields_of(line) for line in (folder / name).read_text().splitlines())
    wall = header.index("wall_s")
    return [fields[:wall] + fields[wall + 1 :] for fields in (header, *rows)]
