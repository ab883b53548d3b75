"""The figures of a run: what it shows in numbers, each declared once.

A field is a key of `run.json`. Its `Shown` says in which words and unit people read it, and where: as a column of the
tables of studies, in the rows of the runs of a site, as a range over the band, as a row of the summary, on maps. A new
quantity is recorded by the stepper (`contact.stepping`) and declared here; one that follows from several records is
put together in `fem.run.verdict`. SI units, named in the keys; rotation > 0 toward +x, slip > 0 moves the
container to +x.
"""

# ruff: noqa: RUF009 - the rule is against a value that all objects share; `shown` returns a `field`, which is none

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, field, fields
from enum import Flag, auto
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Generic,
    ParamSpec,
    TypeVar,
    get_args,
    get_origin,
    get_type_hints,
)

from fem.results.json_block import JsonBlock
from fem.results.outcome import Outcome
from fem.runtime import units
from fem.runtime.units import JOINT_MILLIMETRES as JOINT_MM
from fem.runtime.units import MILLIMETRES as MM
from fem.runtime.units import SHORT_MILLIMETRES as SHORT_MM

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_P = ParamSpec("_P")
ValueT = TypeVar("ValueT")  #: a float of a run; [low, high] over a band


class Place(Flag):
    """Where a figure stands."""

    KEY = auto()  #: every row of a run that a study compares
    RUNS = auto()  #: the rows of the runs of a site
    COLUMN = auto()  #: the tables of studies
    BAND = auto()  #: the members of a band, and its ranges
    SUMMARY = auto()  #: a row of the summary and the page of a run
    MAP = auto()  #: the map on the page of a sweep
    BRIEF = auto()  #: of the summary, what the terminal shows after a run


KEY, RUNS, COLUMN, BAND, SUMMARY, MAP, BRIEF = Place
NOWHERE = Place(0)  #: what is no figure of a run
TABLES, READ = RUNS | COLUMN | BAND, SUMMARY | MAP


@dataclass(frozen=True)
class Shown:
    """How people are shown a figure, and where."""

    words: str
    unit: units.DisplayUnit
    places: Place = NOWHERE
    of: str = ""  #: what the stepper records of it: a field of the (lowest) "joint" or of the "track"
    _: KW_ONLY
    head: str = ""  #: over a narrow column; empty: the words
    map_words: str = ""  #: on a map; empty: the words
    below: str = ""  #: the figure that it follows in a summary; empty: the one declared before
    lowest: bool = False  #: of a loose stack, that of its lowest box
    impact: bool = False  #: an impact decides
    struck: bool = False  #: spring and dashpot of what is struck decide
    window: str = ""  #: key of `Numerics`: the time over which it is a mean
    cutoff: str = ""  #: key of `Numerics`: that of the filter in place of a mean
    column: str = ""  #: of a box: with the numbers of all boxes

    @property
    def on_map(self) -> str:
        """The words for it on a map."""
        return self.map_words or self.words

    def text(self, value: float | None, reach: units.Reach | None = None, *, bare: bool = False) -> str:
        """The figure with its range and unit; empty where there is none."""
        return self.unit.text(value, reach, bare=bare)


def _field_with(how: Callable[_P, Shown]) -> Callable[_P, Any]:
    return lambda *args, **named: field(default=None, metadata={"shown": how(*args, **named)})


#: a field that a run may lack, and how people are shown it: what `Shown` takes
shown = _field_with(Shown)


@dataclass(frozen=True, kw_only=True)
class BoxFigures(JsonBlock, Generic[ValueT]):
    """What one box of a loose stack shows; slip and opening over what is below it."""

    #: largest |rotation|
    max_rotation_rad: Annotated[
        ValueT, Shown("rotation", units.DEGREES, BAND, "joint.max_rotation", column="box_rotations_rad")
    ]
    #: largest |slip|
    max_slip_m: Annotated[ValueT, Shown("slip", JOINT_MM, BAND, "joint.max_slip", column="box_slips_m")]
    #: signed, at the end
    residual_slip_m: Annotated[ValueT | None, Shown("slip left", JOINT_MM, BAND, "joint.slip")] = None
    max_opening_m: Annotated[
        ValueT, Shown("opening", SHORT_MM, BAND, "joint.max_opening", column="box_openings_m")
    ]


@dataclass(frozen=True, kw_only=True)
class BoxResult(BoxFigures[float]):
    """One box of a loose stack."""

    fell: bool = False


@dataclass(frozen=True, kw_only=True)
class Figures(JsonBlock, Generic[ValueT]):
    """The figures that a run has, or a band as [low, high]; None where one was not reached or is not known."""

    #: largest |rotation|
    max_rotation_rad: ValueT | None = shown("largest rotation", units.DEGREES, COLUMN | SUMMARY | BRIEF)
    #: largest |rotation| over the slenderness angle
    rotation_ratio: ValueT | None = shown("rotation ratio", units.RATIO, TABLES | KEY | MAP)
    #: largest |slip|
    max_slip_m: ValueT | None = shown(
        "largest slip", MM, TABLES | READ | BRIEF | KEY, "joint.max_slip", head="slip", lowest=True
    )
    #: at the end
    residual_slip_m: ValueT | None = shown(
        "slip at the end",
        MM,
        TABLES | READ | BRIEF,
        "joint.slip",
        head="residual",
        map_words="slip left at the end",
        lowest=True,
    )
    #: the part of the slip at the end that was moved while nothing touched the floor
    slip_in_air_m: ValueT | None = shown(
        "slip moved in the air", MM, COLUMN | BAND | SUMMARY, "joint.slip_in_air", lowest=True
    )
    #: of the time with a rotation above 0.01 of the slenderness angle, the share without any contact force
    flight_share: ValueT | None = shown("in the air while it rocks", units.RATIO, COLUMN | BAND | READ)
    #: over the last full cycle of a harmonic drive
    slip_peak_to_peak_m: ValueT | None = shown("slip, peak to peak", MM, COLUMN)
    #: total
    slip_travel_m: ValueT | None = shown(
        "path of slip", MM, COLUMN | BAND | SUMMARY, "joint.slip_travel", lowest=True
    )
    #: largest |velocity| of the slip, while every loaded point slides
    max_slip_velocity_m_s: ValueT | None = shown(
        "largest sliding velocity",
        units.VELOCITY,
        TABLES | READ,
        "joint.max_slip_velocity",
        head="velocity",
        lowest=True,
    )
    max_uplift_m: ValueT | None = shown(
        "largest uplift", MM, TABLES | READ | BRIEF, "track.max_uplift", head="uplift", lowest=True
    )
    #: permanent, where the floor is crushed; None: it does not crush. It holds `valid`, and is no prediction
    max_indentation_m: ValueT | None = shown("indentation of the floor", MM, BAND)
    #: no corner has sunk in further than the law of its contact holds
    valid: bool | None = shown("valid", units.COUNT, COLUMN)
    #: rotation at the end; None of what overturned, or turns about one side
    tilt_rad: ValueT | None = shown("tilt at the end", units.DEGREES, COLUMN | BAND | SUMMARY, lowest=True)
    impacts: int | None = shown(
        "impacts", units.WHOLE, COLUMN | READ, "track.impacts", below="first_uplift_s"
    )
    #: a base gap opens
    first_opening_s: ValueT | None = shown("first opening", units.SECONDS, COLUMN, "track.first_opening")
    #: a side carries nothing
    first_uplift_s: ValueT | None = shown("first uplift", units.SECONDS, COLUMN | READ, "track.first_uplift")
    first_impact_s: ValueT | None = shown("first impact", units.SECONDS, COLUMN, "track.first_impact")
    overturned_at_s: ValueT | None = shown(
        "overturned at", units.SECONDS, COLUMN | MAP, "track.overturned_at"
    )
    #: it rocked and stands again at the end
    restored: bool | None = shown("restored", units.COUNT, COLUMN)
    restitution_first: ValueT | None = shown("restitution, first impact", units.COUNT, COLUMN | SUMMARY)
    max_corner_force_N: ValueT | None = shown(
        "largest corner force",
        units.KILONEWTONS,
        COLUMN | BAND | READ | BRIEF,
        "track.max_corner_force",
        below="max_uplift_m",
        impact=True,
        window="corner_force_window_s",
    )
    #: relative to the floor
    max_top_displacement_m: ValueT | None = shown("displacement of the top", MM, COLUMN | BAND | SUMMARY)
    #: of the contents
    max_acceleration_m_s2: ValueT | None = shown(
        "acceleration of the contents",
        units.ACCELERATION,
        COLUMN | BAND | READ,
        impact=True,
        window="acceleration_window_s",
        cutoff="contents_filter_Hz",
    )
    #: None of a rigid container
    max_von_mises_Pa: ValueT | None = shown(
        "von Mises stress", units.MEGAPASCALS, COLUMN | BAND | READ, impact=True
    )
    #: largest of all joints and sides; of short members of a band that change one input
    bolt_tension_N: ValueT | None = shown("tension of the bolts", units.KILONEWTONS, BAND)
    #: largest of all joints; likewise
    bolt_shear_N: ValueT | None = shown("shear of the bolts", units.KILONEWTONS, BAND)


OF_LINKS = COLUMN | BAND | READ


@dataclass(frozen=True, kw_only=True)
class LinkFigures(JsonBlock, Generic[ValueT]):
    """What stops, ties and neighbours do, all of a kind together; None of a container without them."""

    stop_force_N: ValueT | None = shown("largest force on a stop", units.KILONEWTONS, OF_LINKS, struck=True)
    tie_force_N: ValueT | None = shown("largest force in a tie", units.KILONEWTONS, OF_LINKS)
    neighbour_force_N: ValueT | None = shown(
        "largest force between containers", units.KILONEWTONS, OF_LINKS, struck=True
    )
    #: how often a gap or slack was used up
    link_hits: ValueT | None = shown("hits on stops, ties and neighbours", units.WHOLE, OF_LINKS)
    #: with which one was used up
    link_velocity_m_s: ValueT | None = shown("largest closing velocity", units.VELOCITY, OF_LINKS)
    #: the first that broke
    link_broken_at_s: ValueT | None = shown("first stop or tie broken at", units.SECONDS, OF_LINKS)
    #: of those that are whole; the least
    link_slack_m: ValueT | None = shown("least gap or slack left", MM, OF_LINKS)
    #: over its own slenderness angle
    neighbour_rotation_ratio: ValueT | None = shown("rotation ratio of the neighbours", units.RATIO, OF_LINKS)


@dataclass(frozen=True, kw_only=True)
class HeldFigures(JsonBlock, Generic[ValueT]):
    """What one neighbour, stop or tie does; None of what it has not."""

    max_force_N: ValueT | None = None
    hits: ValueT | None = None
    largest_closing_velocity_m_s: ValueT | None = None
    gap_left_m: ValueT | None = None
    broken_at_s: ValueT | None = None
    rotation_ratio: ValueT | None = None  #: of a neighbour that stands
    max_slip_m: ValueT | None = None  #: of a neighbour, over the floor


JOINT_SLIP = Shown(
    *("largest slip between boxes", JOINT_MM, COLUMN | MAP),
    head="between boxes",
    map_words="largest slip between loose boxes",
)
JOINT_OPENING = Shown(
    "largest opening between boxes", MM, COLUMN | MAP, map_words="largest opening between loose boxes"
)


@dataclass(frozen=True, kw_only=True)
class RunOutcome(JsonBlock):
    """What happened in one run."""

    outcome: Outcome | None = None  #: None where the run failed


@dataclass(frozen=True, kw_only=True)
class RunFigures(
    LinkFigures[float], Figures[float], RunOutcome
):  # of several bases the last comes first in a file
    """The outcome of one run with its figures."""

    boxes: tuple[BoxResult, ...] | None = None  #: of a loose stack, from the floor up
    #: the first box of a loose stack that fell, from 1 at the floor
    fell_box: int | None = shown("first box that fell", units.COUNT, COLUMN | MAP)
    #: the container of a row that overturned first: "container" or "neighbour 2"
    fell_in_row: str | None = shown("first of the row to overturn", units.COUNT, COLUMN)
    #: of the containers of a row: of that of the case, then of its neighbours
    row_outcomes: str | None = shown("outcomes along the row", units.COUNT, COLUMN)

    @property
    def turned(self) -> float:
        """Largest |rotation| over the slenderness angle; 0 where none is known."""
        return self.rotation_ratio or 0.0

    @property
    def slipped(self) -> float:
        """Largest |slip|; 0 where none is known [m]."""
        return self.max_slip_m or 0.0

    @property
    def slipped_most(self) -> float:
        """Largest |slip|, of a loose stack that of any box over what is below it [m]."""
        return max((box.max_slip_m for box in self.boxes or ()), default=self.slipped)

    @property
    def max_joint_slip_m(self) -> Annotated[float | None, JOINT_SLIP]:
        """Largest slip of a box on another, of a loose stack."""
        return max((box.max_slip_m for box in (self.boxes or ())[1:]), default=None)

    @property
    def max_joint_opening_m(self) -> Annotated[float | None, JOINT_OPENING]:
        """Largest opening of a box from another, of a loose stack."""
        return max((box.max_opening_m for box in (self.boxes or ())[1:]), default=None)

    def figures(self, place: Place) -> dict[str, Any]:
        """Its figures of a place, by key."""
        return {key: getattr(self, key) for key in keys_of(place)}


#: of a motion of the floor
PGA, PGV = Shown("PGA", units.ACCELERATION), Shown("PGV", units.VELOCITY)
PGD, DURATION = Shown("PGD", MM), Shown("D5-95", units.SECONDS)


def _hints(kind: type) -> dict[str, Any]:
    """Fields of a class, then its properties, with their types."""
    derived = {key: var.fget for key, var in vars(kind).items() if isinstance(var, property)}
    of_derived = {
        key: get_type_hints(quantity, include_extras=True)["return"] for key, quantity in derived.items()
    }
    return get_type_hints(kind, include_extras=True) | of_derived


def declared_in(kind: "type[DataclassInstance]") -> dict[str, Shown]:
    """How people are shown what a class holds, by key: by its field, else by its type."""
    own = {one.name: one.metadata.get("shown") for one in fields(kind)}
    said = {
        key: own.get(key) or next((arg for arg in get_args(hint) if isinstance(arg, Shown)), None)
        for key, hint in _hints(kind).items()
    }
    return {key: how for key, how in said.items() if how is not None}


def types_of(kind: type) -> dict[str, type]:
    """The types of what a class holds, by key: those of its own row of a table."""
    return {key: _plain(hint) for key, hint in _hints(kind).items()}


def _plain(hint: Any) -> type:
    """`X` of `X | None` and of annotated types; float of a number in general, tuple of several."""
    if get_origin(hint) is tuple:
        return tuple
    if parts := get_args(hint):
        return _plain(parts[0])
    return hint if isinstance(hint, type) else float


#: by key, in the order of the columns of tables
FIGURES = declared_in(RunFigures)
#: of each box of a loose stack
BOX_FIGURES = declared_in(BoxFigures)
#: what falls first of several that stand on or beside one another
FELL_FIRST = ("fell_box", "fell_in_row")
#: of what not every run has
WHERE_GIVEN = frozenset(declared_in(LinkFigures)) | {*FELL_FIRST, "row_outcomes", "boxes", "links"}
#: keys of the two figures that studies limit and rank by: how far a container turns, and how far it slips
TURNED, SLIPPED = "rotation_ratio", "max_slip_m"


def keys_of(place: Place) -> tuple[str, ...]:
    """The keys of the figures of a place, in the order of the columns of tables."""
    return tuple(key for key, figure in FIGURES.items() if place in figure.places)


def columns_of(place: Place) -> dict[str, type]:
    """The figures of a place as columns of a table."""
    types = types_of(RunFigures)
    return {key: types[key] for key in keys_of(place)}


def figures_of(place: Place) -> dict[str, Shown]:
    """The figures of a place, by key."""
    return {key: FIGURES[key] for key in keys_of(place)}


def keys_beside(place: Place) -> frozenset[str]:
    """The keys of all other figures."""
    return frozenset(FIGURES) - {*keys_of(place)}


#: scalars of a verdict, as columns of a table; None where they do not apply
SCALARS = {"outcome": str} | columns_of(COLUMN)
#: columns with one number for each box of a loose stack, from the floor up, by what they hold of it
BOXES = {figure.column: key for key, figure in BOX_FIGURES.items() if figure.column}
#: of a run in the tables of studies
RUN_COLUMNS = SCALARS | dict.fromkeys(BOXES, tuple)


def summary_order() -> list[str]:
    """The keys of the figures of a summary, in the order of reading."""
    keys = list(FIGURES)
    for key, figure in FIGURES.items():
        if figure.below:
            keys.remove(key)
            keys.insert(keys.index(figure.below) + 1, key)
    return [key for key in keys if SUMMARY in FIGURES[key].places]
