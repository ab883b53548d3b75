"""The key that `size` varies: what is looked for, and the values of the scan."""

import math
from dataclasses import replace

from fem.case.tables.quantities import Quantity
from fem.case.validation import CaseError, did_you_mean, known_keys, quantity_of
from fem.site_check.bodies import body_of
from fem.site_check.bracket import SizeAxis, Wanted, spaced
from fem.site_check.file import TABLES, SiteRequest
from fem.study.axes import AxisError, field_of
from fem.study.derived import value_in
from mesh.errors import MeshError

COUNT = 13  #: values of the scan
MOST_COUNT = 200
WIDER = 3.0  #: the scan reaches from the value in the file over this to this times it
SIDES = ("container.width_m", "container.depth_m")
BOXES, FRICTION, FLOOR = "container.boxes", "contact.mu_static", "building.z_over_h"
NEAR = 1e-3  #: of a step, within which an end of the range is a value: 0.666667 is the second floor of three
#: key -> what is looked for, and words for it; other keys: the window of their values
KNOWN: dict[str, tuple[Wanted, str]] = {
    "container.width_m": ("least", "width"),
    "container.depth_m": ("least", "depth"),
    BOXES: ("largest", "number of boxes"),
    FRICTION: ("window", "static friction"),
    "site.reference_acceleration_m_s2": ("largest", "reference acceleration"),
    "site.importance_factor": ("largest", "importance factor"),
    "site.element_importance_factor": ("largest", "importance factor of the element"),
    "site.soil_factor": ("largest", "soil factor"),
    "site.vertical_ratio": ("largest", "vertical ratio"),
    FLOOR: ("largest", "height in the building"),
}
#: ends of the scan where the value in the file says little
RANGES = {FRICTION: (0.05, 1.0), BOXES: (1.0, 12.0), FLOOR: (0.0, 1.0)}


def size_axis(
    request: SiteRequest,
    key: str,
    *,
    low: float | None = None,
    high: float | None = None,
    count: int | None = None,
) -> SizeAxis:
    """The axis of a key of the site file or of its container.

    Args:
        request: what is asked, with the value that the range starts from.
        key: dotted, such as `container.width_m`.
        low, high: ends of the scan; None: as suits the key, the upper one no further than a container can be built.
        count: values of the scan; None: 13. Every number of boxes, and every floor of a building of storeys, is tried.

    Raises:
        CaseError: no such key, one without a number, a range that does not rise or that the key cannot have, or at an
            end of which the containers cannot be built.
    """
    quantity, value = _quantity(key), _value(request, key)
    steps = _steps(request, key)
    last_is_usual = high is None
    if low is None or high is None:
        begin, end = RANGES.get(key) or _around(key, value, quantity)
        low, high = begin if low is None else low, end if high is None else high
    if not low < high:
        raise CaseError(f"--from {low:g} --to {high:g}: the range of {key} must rise")
    if key.startswith("site.") and request.on_given_floor:
        raise CaseError(
            f"--over {key}: the horizontal motion of the floor is given, which [site] does not change"
        )
    for name, bound in (("--from", low), ("--to", high)):
        try:
            quantity.check(bound)
        except ValueError as error:
            raise CaseError(f"{name}: {key} {error}") from None
    if count is not None and not 2 <= count <= MOST_COUNT:
        raise CaseError(f"--count must be 2 to {MOST_COUNT}, got {count}")
    values = spaced(low, high, count or COUNT)
    if steps is not None:
        first, last = math.ceil(low * steps - NEAR), math.floor(high * steps + NEAR)
        values = tuple(number / steps for number in range(first, last + 1))
        if len(values) < 2:
            raise CaseError(f"--from {low:g} --to {high:g}: {key} has fewer than two values there")
    wanted, words = KNOWN.get(key, ("window", key))
    axis = SizeAxis(
        key=key, words=words, unit=quantity.unit, wanted=wanted, values=values, whole=steps is not None
    )
    while last_is_usual and len(values) > 2 and not _is_built(request, axis, values[-1]):
        values = values[:-1]
    for bound in (values[0], values[-1]):
        _build(request, axis, bound)  # refused before anything is computed
    return replace(axis, values=values)


def at(request: SiteRequest, axis: SizeAxis, value: float) -> SiteRequest:
    """The request at a value of the axis; of a square container the other side follows.

    Raises:
        CaseError: the value cannot be used.
    """
    changed = request.with_value(axis.key, round(value) if axis.key == BOXES else value)
    for key in followers(request, axis.key):
        changed = changed.with_value(key, value)
    return changed


def _build(request: SiteRequest, axis: SizeAxis, value: float) -> None:
    """Build the containers at a value, to see that it can be done.

    Raises:
        CaseError: it cannot.
    """
    try:
        for variant in at(request, axis, value).variants:
            body_of(variant)
    except (CaseError, MeshError) as error:
        raise CaseError(f"--over {axis.key}: at {value:.4g} {axis.unit}".rstrip() + f" {error}") from None


def _is_built(request: SiteRequest, axis: SizeAxis, value: float) -> bool:
    try:
        _build(request, axis, value)
    except CaseError:
        return False
    return True


def followers(request: SiteRequest, key: str) -> tuple[str, ...]:
    """Keys that take the same value: the other side of a container that is as deep as wide."""
    box = request.container.container
    square = key in SIDES and box.width_m == box.depth_m
    return tuple(side for side in SIDES if square and side != key)


def _steps(request: SiteRequest, key: str) -> int | None:
    """Values of a key from 0 to 1, where it has no others between: whole numbers, floors; None: it has all."""
    if key == FLOOR and request.building is not None:
        return request.building.storeys
    return 1 if key == BOXES else None


def _quantity(key: str) -> Quantity:
    """The quantity of a key; only numbers can vary."""
    table, _, name = key.partition(".")
    if table in TABLES:
        fields = known_keys(TABLES[table])
        if name not in fields:
            near = did_you_mean(name, fields)
            raise CaseError(f"--over {key}: no such key of a site file{'; ' + near if near else ''}")
        field = fields[name]
    else:
        try:
            field = field_of(key)
        except AxisError as error:
            raise CaseError(f"--over {key}: {error}") from None
    quantity = quantity_of(field.annotation, field.metadata)
    if quantity is None or "list" in str(field.annotation):
        raise CaseError(f"--over {key}: it holds no single number; try one of {', '.join(KNOWN)}")
    return quantity


def _value(request: SiteRequest, key: str) -> float | None:
    """The value in the files; None where there is none."""
    table, _, name = key.partition(".")
    if table not in TABLES:
        return value_in(request.container, key, {})
    content = getattr(request, table)
    if content is None:
        raise CaseError(f"--over {key}: the site file has no [{table}]")
    given = getattr(content, name)
    return None if given is None else float(given)


def _around(key: str, value: float | None, quantity: Quantity) -> tuple[float, float]:
    """From a third to three times the value in the file, within what the key can have."""
    if not value or value < 0.0:
        raise CaseError(f"--over {key}: the files give no value to start from; give --from and --to")
    least = quantity.least if quantity.least is not None else 0.0
    most = quantity.most if quantity.most is not None else math.inf
    return max(value / WIDER, least), min(value * WIDER, most)
