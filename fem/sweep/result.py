"""The result of a sweep as typed data: what `sweep.json` holds; its rows are in tables."""

from dataclasses import dataclass, field
from typing import Any

from fem.batch.axes import AxisResult
from fem.batch.study import StudyResult


@dataclass(frozen=True, kw_only=True)
class SweepResult(StudyResult):
    """What was asked of a sweep, and what it found."""

    sweep_hash: str  #: equal for sweeps whose rows are the same
    sweep: str = ""  #: its name
    title: str = ""
    case: str = ""  #: name of the base case
    band_hash: str | None = None  #: equal for sweeps that are perturbed and refined in the same way
    base_hash: str = ""
    model: str = ""
    duration_s: float | str = "auto"
    motion_covered: str | None = None  #: the part of the motion that the runs cover, where they end before it
    axes: tuple[AxisResult, ...]
    derived: dict[str, str] = field(default_factory=dict)
    held: str = ""  #: of the unknown inputs, in words
    perturbation: dict[str, Any] = field(default_factory=dict)
    uncertainty: dict[str, Any] = field(default_factory=dict)
    left_out: str = ""  #: by the copies, of the band of a run, in words
    limit_slip_m: float | None = None  #: beyond which a cell does not stand in the answer
    threshold: dict[str, Any] | None = None
    jobs: int = 1
    wall_s: float | None = None
    cells: int = 0
    rows: int = 0  #: cells that are there
    outcomes: dict[str, int] = field(default_factory=dict)  #: how many there are of each
    perturbed: int = 0  #: cells that have copies
    copies: int = 0
    unsure: int | None = None  #: cells; None without copies
    sure: dict[str, int] | None = None  #: how many cells are sure, regime unsure, unsure
    decided_by: dict[str, int] | None = None  #: how many unsure cells each input decides
    changes: int | None = None  #: of outcome, refined; None where none are asked for
    motions: tuple[dict[str, Any], ...] | None = None  #: measures and outcomes of each motion of a set
    motion_set: tuple[dict[str, Any], ...] | None = None  #: a row for each point of the other axes
    motion_figures: tuple[str, ...] = ()
    map_axes: dict[str, Any] = field(default_factory=dict)
    maps: tuple[str, ...] = ()
