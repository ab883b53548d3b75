"""What makes the cases of a study: points on axes times draws, and keys that follow others."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import islice, product
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, Strict, ValidationError

from fem.case.case import Case
from fem.case.overrides import keys_in_effect, with_overrides
from fem.case.strength import scaled_motion
from fem.case.tables.all_tables import TABLES
from fem.case.tables.duration import ends_at_rest, longest_time
from fem.case.tables.input_ranges import DASHPOT, HELD
from fem.case.tables.links import ROWS
from fem.case.tables.quantities import CONTACT_DAMPING, DRAWS, Quantity
from fem.case.tables.table import CaseTable
from fem.case.tables.unknown_inputs import INPUTS, ranges_of
from fem.case.uncertainty import InputChange, as_changed, drawn_values
from fem.case.validation import CaseError
from fem.results.run_result import MotionResult
from fem.run.described import doubts
from fem.study.axes import MOTION_FILE, Axis, point_of, set_axis, shape_of, with_following
from fem.study.containers import penalty_of
from fem.study.derived import FREE, Expression, number_of, with_derived
from fem.study.draws import RandomQuantity, Sampling, draw_shares, held_inputs
from fem.study.driver import LoggedRuns, StudyResult


class Item(NamedTuple):
    """One run of a study."""

    cell: int  #: of the grid, the last axis the fastest; or its number in a list
    draw: int  #: at this point; of a cell its copy, of a container its motion
    point: Mapping[str, Any]  #: what the axes or the list set
    #: what is random, relative quantities as factors; a key that is None is not set
    drawn: Mapping[str, Any] = {}
    unknown: Mapping[str, Any] = {}  #: the unknown inputs, or what a copy changes, as the log has them
    more: Mapping[str, Any] = {}  #: that these set, over all other keys


class CaseMaker:
    """Makes `base.with_values(values)`, at a tenth of the cost, and the cases of a study.

    Only the tables that change and the rules of the whole case are checked again; a case that breaks one is made the
    long way, which names the error. `derived` keys follow others; `relative` ones are drawn as factors on the value
    that they have anyway.
    """

    def __init__(
        self, base: Case, derived: Mapping[str, Expression] = {}, relative: Collection[str] = ()
    ) -> None:
        self.base, self._kinds, self._derived, self._relative = base, base.kinds, derived, relative
        #: by the keys that are set: what does not change, and the content of the tables that do
        self._templates: dict[tuple[str, ...], tuple[dict[str, Any], dict[str, dict[str, Any]]]] = {}

    def case(self, item: Item) -> Case:
        """The case of a run; CaseError for a bad one, and where a key to be computed from others has no value."""
        return self({**self.values(item.point, item.drawn), **item.more})

    def values(self, point: Mapping[str, Any], drawn: Mapping[str, Any] = {}) -> dict[str, Any]:
        """All keys that a run sets before what is unknown, derived ones included; raises as `case`."""
        values = dict(point)
        for key, value in drawn.items():
            if key in self._relative:
                value *= number_of(key, values, self.base)
            if value is not None:
                values[key] = value
        complete = with_derived(values, self._derived, self.base)
        return {key: value for key, value in complete.items() if not key.startswith(FREE)}

    def __call__(self, values: Mapping[str, Any]) -> Case:
        """The base with dotted keys set; alternatives are replaced. CaseError as for a case file."""
        given = values
        values = keys_in_effect(values, self._kinds)
        keys = tuple(values)
        if any(key.rpartition(".")[0] in ROWS for key in keys):  # all rows of a table change
            return self.base.with_values(given)
        if keys not in self._templates:
            data = with_overrides(self.base.given(), values)
            names = {key.rpartition(".")[0] for key in values} - {""}
            kept = {key: value for key, value in data.items() if key not in TABLES and key not in ROWS}
            kept |= {name: rows for name in ROWS if (rows := getattr(self.base, name))}
            kept |= {name: getattr(self.base, name) for name in TABLES if name not in names}
            self._templates[keys] = kept, {name: data[name] for name in names}
        fixed, touched = self._templates[keys]
        heading: dict[str, Any] = {}
        content = {name: dict(given) for name, given in touched.items()}
        for dotted, value in values.items():
            table, _, key = dotted.rpartition(".")
            (content[table] if table else heading)[key] = value
        try:
            tables = {name: TABLES[name].model_validate(given) for name, given in content.items()}
            return Case.model_validate(fixed | heading | tables).from_origin(self.base.origin_with(given))
        except ValidationError:
            return self.base.with_values(given)


#: tables and keys on which the container depends, or how it is computed: see `container_cache.container_key`
OF_THE_CONTAINER = (
    "gravity_m_s2",
    "container.",
    "support.",
    "solver.model",
    "solver.elastic_modes",
    "solver.element_size_m",
    "solver.order",
    "output.stop_when_overturned",
)


class MapChoice(CaseTable):
    """Which axes span the maps."""

    x: str | None = Field(default=None, description="key of an axis; default: one with the most values")
    y: str | None = Field(default=None, description="key of another axis")
    fixed: dict[str, Any] = Field(
        default={}, description="values at which further axes are held; the others have a panel each"
    )


SHARE = Quantity(least=0.0, most=0.5, advice="0.02 is two per cent")
FRICTION_STEP = Quantity(least=0.0, most=1.0, advice="0.02 is usual")
PHASE_STEP = Quantity(unit="rad", least=0.0, most=math.pi, advice="one turn is 2 pi")
CLOSE = Quantity(least=0.0, advice="rotation over the slenderness angle")
SMALL = 0.0  #: of a range


class Perturbation(CaseTable):
    """Which cells are perturbed, and how much."""

    cells: Literal["auto", "near", "all", "none"] = Field(
        default="auto",
        description='"auto": a coarse grid of all cells, then around what changes, none for the full model | '
        '"near" a change of outcome only | "all" | "none"',
    )
    amplitude_share: Annotated[float, SHARE] = Field(
        default=0.02, description="of the floor's amplitude, up and down"
    )
    mu: Annotated[float, FRICTION_STEP] = Field(
        default=0.02,
        description="added to and taken from both coefficients of friction, of the floor and of loose joints",
    )
    phase_rad: Annotated[float, PHASE_STEP] = Field(
        default=0.3142, description="added to and taken from the phase; a twentieth of a turn"
    )
    contact_damping_ratios: list[Annotated[float, CONTACT_DAMPING]] = Field(
        default=[0.5, 1.0, 2.0], description="tried in place of the cell's own"
    )
    draws: Annotated[int, Strict(), DRAWS] | None = Field(
        default=None,
        description="copies in which all unknown inputs are drawn at once; default: a quarter of [uncertainty] draws",
    )
    close: Annotated[float, CLOSE] = Field(
        default=0.5, description="rotation ratio above which a standing cell counts as near"
    )

    def changes(self, case: Case) -> Iterator[InputChange]:
        """What each copy of a case changes; what is small counts as a small share of a range."""
        small = partial(InputChange, kind="one", share=SMALL)
        for factor in (1.0 - self.amplitude_share, 1.0 + self.amplitude_share):
            scaled = scaled_motion(case, factor)
            if scaled and factor != 1.0:
                yield small(values=scaled)
        frictions = {"contact": {"mu_static": case.contact.mu_static, "mu_kinetic": case.contact.mu_kinetic}}
        if case.container.is_loose:
            frictions["joints"] = case.joint_friction
        for table, own in frictions.items():
            for step in (-self.mu, self.mu) if self.mu else ():
                moved = {key: max(0.0, own[key] + step) for key in ("mu_static", "mu_kinetic")}
                # fifteen digits: 0.4 + 0.02 is 0.42
                yield small(values={f"{table}.{key}": float(f"{value:.15g}") for key, value in moved.items()})
        if case.motion.kind == "harmonic" and self.phase_rad > 0.0:
            for step in (-self.phase_rad, self.phase_rad):
                phase = math.remainder(case.motion.phase_rad + step, 2.0 * math.pi)
                yield small(values={"motion.phase_rad": phase})
        stated = "contact_damping_ratios" in self.model_fields_set
        varies = stated or case.uncertainty.damping_ratio not in HELD
        for ratio in self.contact_damping_ratios if varies and not case.floor.is_slab else ():
            if case.contact.damping_ratio not in (None, ratio):
                yield InputChange(kind="one", values={DASHPOT: ratio}, share=1.0)


RESOLUTION = Quantity(above=0.0, most=1.0, advice="0.01 is one per cent")


class Threshold(CaseTable):
    """Along which axis changes of outcome are located, and how precisely."""

    axis: str = Field(description="the key of one of the axes", examples=["motion.peak_acceleration_m_s2"])
    resolution: Annotated[float, RESOLUTION] = Field(
        default=0.01, description="largest width of a bracket, relative to the value"
    )
    inner: Annotated[int, Quantity(least=1, most=100)] = Field(
        default=3, description="values tried within a bracket at a time"
    )


@dataclass(frozen=True, kw_only=True)
class DesignResult(StudyResult):
    """What the result of a study on axes says of what was asked."""

    title: str = ""
    case: str = ""  #: name of the base case
    model: str = ""
    duration_s: float | str = "auto"
    motion_covered: str | None = None  #: the part of the motion that the runs cover, where they end before it
    axes: tuple[Axis, ...]
    derived: dict[str, str] = field(default_factory=dict)
    held: str = ""  #: of the unknown inputs, in words
    limit_slip_m: float | None = None  #: beyond which a run does not stand, and counts as one that overturned


#: unknown inputs that the file does not vary: drawn over [uncertainty] of the case, or held
Unknown = Literal["drawn", "held"]
TRIED = 64  #: cases that are built to find bad values before anything is computed
STREAM = 1  #: of random numbers of the unknown inputs


@dataclass(frozen=True, kw_only=True, eq=False)
class Design:
    """A base case, points on axes, what is random at a point, and keys that follow."""

    name: str  #: stem of the file, or name of the shipped study
    text: str = ""  #: of the file
    title: str = ""
    base: Case  #: with the keys of [set]
    axes: tuple[Axis, ...] = ()
    random: tuple[RandomQuantity, ...] = ()
    unknown_inputs: Unknown = "held"
    derived: Mapping[str, Expression] = field(default_factory=dict)  #: each behind what it refers to
    limit_slip_m: float | None = None  #: beyond which a run does not stand

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of each axis."""
        return shape_of(self.axes)

    @property
    def count(self) -> int:
        """Points."""
        return math.prod(self.shape)

    def point(self, cell: int) -> dict[str, Any]:
        """Values of the axes at a point, by key."""
        return point_of(self.axes, cell)

    def item(self, cell: int) -> Item:
        """The run of a point, where nothing is drawn."""
        return Item(cell, 0, with_following(self.axes, self.point(cell)))

    @cached_property
    def make(self) -> CaseMaker:
        """Makes the cases of runs; picklable, and small."""
        relative = frozenset(quantity.key for quantity in self.random if quantity.spread.relative)
        return CaseMaker(self.base.without_fields(), self.derived, relative)

    def case(self, cell: int) -> Case:
        """The case of a point."""
        return self.make.case(self.item(cell))

    @property
    def axis_keys(self) -> tuple[str, ...]:
        """Keys of the axes."""
        return tuple(axis.key for axis in self.axes)

    @property
    def varied(self) -> set[str]:
        """Keys that vary by themselves: of the axes, and what is random."""
        return {*self.axis_keys, *(quantity.key for quantity in self.random)}

    @property
    def motions(self) -> Axis | None:
        """The set of motions, on an axis or drawn; None where there is one motion."""
        return set_axis([*self.axes, *filter(None, (one.choices for one in self.random))])

    @cached_property
    def unknown(self) -> tuple[str, ...]:
        """Keys of the unknown inputs that are drawn over their ranges in [uncertainty] of the case.

        What the file varies itself, by [axes], [random] or [derived], stays as it is there.
        """
        if self.unknown_inputs == "held":
            return ()
        ranges = (interval for case in self.cases for interval in ranges_of(case, penalty_of(case)))
        drawn = {interval.key for interval in ranges if interval.drawn is not None}
        return tuple(key for key in INPUTS if key in drawn - {*self.varied, *self.derived})

    @property
    def runs(self) -> Callable[..., LoggedRuns[Item]]:
        """Some runs of this study and their log: `LoggedRuns` that need no more than that."""
        return partial(LoggedRuns[Item], make=self.make.case, model_of=self.model_of)

    @property
    def held(self) -> str:
        """What is held fixed of the unknown inputs that are not drawn, in words."""
        return held_inputs(self.cases, {*self.varied, *self.unknown})

    @property
    def asked(self) -> dict[str, Any]:
        """What a `DesignResult` says of this study, but for the motion that is covered."""
        return {
            "title": self.title,
            "case": self.base.name,
            "model": self.base.solver.model,
            "duration_s": longest_time(self.base) if not ends_at_rest(self.base) else "auto",
            "axes": self.axes,
            "derived": {key: expression.text for key, expression in self.derived.items()},
            "held": self.held,
            "limit_slip_m": self.limit_slip_m,
            "warnings": self.warnings,
        }

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a run tells of a mass centre that stays behind: of the last corner where one does, else of the base."""
        before = len(self.base.overrides)
        for case in reversed(self.cases):  # a mass centre of [set] stays where an axis moves the height
            own = replace(case.origin_with({}), overrides=case.overrides[before:])
            if said := doubts(MotionResult(), case.from_origin(own)):
                return said
        return doubts(MotionResult(), self.base)

    def corners(
        self, *, listed: bool = False, drawn: Sequence[tuple[Any, ...]] | None = None
    ) -> Iterator[Item]:
        """Runs at the ends of each axis; of what is random at these values, or in the middle and at the ends.

        `listed`: at every value of an axis that the file lists.
        """
        steps = (1 if listed and axis.scale == "list" else len(axis.values) - 1 or 1 for axis in self.axes)
        ends = [axis.values[::step] for axis, step in zip(self.axes, steps, strict=True)]
        shares = np.array([0.5, 0.0, 1.0])
        drawn = drawn or [*zip(*(one.values(shares) for one in self.random), strict=True)] or [()]
        for corner, values in product(product(*ends), drawn):
            point = with_following(self.axes, dict(zip(self.axis_keys, corner, strict=True)))
            own = dict(zip((one.key for one in self.random), values, strict=True))
            yield Item(0, 0, point, with_following(filter(None, (one.choices for one in self.random)), own))

    @cached_property
    def cases(self) -> list[Case]:
        """The cases of the corners, those that can be made."""
        cases = []
        for item in self.corners():
            with suppress(CaseError):
                cases.append(self.make.case(item))
        return cases

    def tried(self, items: Iterable[Item], tables: str, words: Callable[[Any], str]) -> Iterator[Case]:
        """The cases of the first of some runs; CaseError for one that cannot be used, with what makes it."""
        for item in islice(items, TRIED):
            try:
                yield self.make.case(item)
            except CaseError as error:
                values = (
                    pair for pair in (*item.point.items(), *item.drawn.items()) if pair[0] in self.varied
                )
                where = ", ".join(
                    f"{key} = {one if isinstance(one, str) else words(one)}" for key, one in values
                )
                raise CaseError(f"{error}\n{tables}: {where}") from None

    def model_of(self, item: Item) -> str:
        """The model of a run."""
        return str({**item.point, **item.drawn}.get("solver.model", self.base.solver.model))

    def by_container(self, cells: Iterable[int]) -> list[Item]:
        """The runs of some points, in an order in which those of one container are neighbours."""
        return sorted(map(self.item, cells), key=lambda item: (self.container_of(item), item.cell))

    def container_of(self, item: Item) -> str:
        """Equal for runs that have the same container."""
        if not any(key.startswith(OF_THE_CONTAINER) for key in (*self.varied, *self.derived)):
            return ""
        values = item.point
        with suppress(CaseError):  # a derived key without a value: the row will have the reason
            values = self.make.values(values)
        return repr([value for key, value in values.items() if key.startswith(OF_THE_CONTAINER)])


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep(Design):
    """What a sweep file asks for."""

    perturbation: Perturbation
    threshold: Threshold | None
    maps: MapChoice

    @property
    def has_copies(self) -> bool:
        """Whether its cells have copies."""
        chosen = self.perturbation.cells
        return chosen != "none" and (chosen != "auto" or self.base.solver.model != "full")


@dataclass(frozen=True, kw_only=True, eq=False)
class Ensemble(Design):
    """What an ensemble file asks for."""

    random: tuple[RandomQuantity, ...] = field()  # without the default of `Design`
    unknown_inputs: Unknown = "drawn"
    draws: int  #: at each point
    seed: int
    sampling: Sampling
    replicates: int  #: 1 for independent draws; of a set of motions one for each
    confidence: float
    probability: float  #: of overturning, to which the points are compared

    def draws_at(self, cell: int) -> list[Item]:
        """The draws of a point; each motion of a set is drawn equally often, and is a replicate.

        The unknown inputs have random numbers of their own, so what is drawn by [random] does not depend on them.
        """
        spread = [quantity for quantity in self.random if quantity.key != MOTION_FILE]
        own = {"seed": self.seed, "cell": cell, "draws": self.draws, "replicates": self.replicates}
        shares_of = partial(draw_shares, self.sampling, **own)
        shares = shares_of(dimensions=len(spread)) if spread else np.empty((self.draws, 0))
        columns: dict[str, Sequence[Any]] = {
            quantity.key: quantity.values(shares[:, k]) for k, quantity in enumerate(spread)
        }
        each = self.draws // self.replicates
        if axis := self.motions:
            sets = {axis.key: axis.values, **axis.following}
            columns |= {key: [value for value in row for _ in range(each)] for key, row in sets.items()}
        point, rows = self.point(cell), zip(*columns.values(), strict=True)
        draws = [Item(cell, k, point, dict(zip(columns, row, strict=True))) for k, row in enumerate(rows)]
        if not self.unknown:
            return draws
        for k, row in enumerate(shares_of(dimensions=len(self.unknown), stream=STREAM).tolist()):
            try:
                case = self.make.case(draws[k])
                ranges = ranges_of(case, penalty_of(case))
            except ValueError:  # one that cannot be made has no unknown inputs
                continue
            share = dict(zip(self.unknown, row, strict=True))
            drawn = [interval for interval in ranges if interval.key in share]
            unknown = drawn_values(drawn, [share[interval.key] for interval in drawn])
            more = as_changed(case, unknown) if unknown and case.container.is_loose else unknown
            draws[k] = draws[k]._replace(unknown=unknown, more=more)
        return draws
