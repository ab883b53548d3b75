"""Change single keys of a case: `table.key=value` from the command line, or dotted keys of a sweep.

A key that is one of a group of alternatives replaces the others: `motion.peak_acceleration_m_s2` replaces the amplitude
of a case given by amplitude and frequency. Of a record it is the peak to which it is scaled, `motion.scale_to_m_s2`.
"""

import re
import tomllib
from collections.abc import Mapping
from copy import deepcopy
from typing import Any

from fem.case.tables.all_tables import TABLES
from fem.case.tables.floors import PENALTY_KEYS, PRESET_KEYS, SLAB_KEYS
from fem.case.tables.links import ROWS
from fem.case.validation import CaseError, did_you_mean

DOTTED_KEY = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)?")
SIDES = ("container.width_m", "container.depth_m")
FREQUENCIES = ("angular_frequency_rad_s", "frequency_Hz")
#: of a record: the key that replaces another one
OF_A_RECORD = {
    f"{table}.peak_acceleration_m_s2": f"{table}.scale_to_m_s2" for table in ("motion", "vertical")
}


def parse_override(text: str) -> tuple[str, Any]:
    """Dotted key and value of one `--set`; what is no TOML value is plain text.

    Raises:
        CaseError: the key or the value is missing.
    """
    key, equals, value = text.partition("=")
    key, value = key.strip(), value.strip()
    if not equals or not value or not DOTTED_KEY.fullmatch(key):
        raise CaseError(
            f"--set {text!r}: not of the form table.key=value, for instance --set contact.mu_static=0.3"
        )
    try:
        parsed = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        return key, value
    return key, parsed["value"] if len(parsed) == 1 else value


def with_overrides(data: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """A copy of a case's data with dotted keys set, alternatives replaced.

    Raises:
        CaseError: a key names no table of a case file.
    """
    changed = deepcopy(dict(data))
    tables = {f"{table}.kind": "table" for table in ("motion", "vertical") if f"{table}.file" in overrides}
    if "floor.preset" in overrides:
        tables["floor.kind"] = "slab"
    # who names a record wants it to move the floor, who names a floor to stand on it
    overrides = keys_in_effect(tables | dict(overrides), kinds_of(data))
    for dotted, value in overrides.items():
        table, dot, key = dotted.rpartition(".")
        if not dot:
            if key in TABLES:
                raise CaseError(
                    f"--set {dotted}: [{key}] is a table; set one of its keys, --set {key}.KEY=VALUE"
                )
            changed[key] = deepcopy(value)  # its rows may be changed below
            continue
        if table in ROWS:
            rows = changed.get(table)
            if not rows:
                raise CaseError(f"--set {dotted}: the case has no [[{table}]] to change; give it one")
            for row in rows if isinstance(rows, list | tuple) else ():
                if isinstance(row, dict):  # else refused when the case is read
                    row[key] = value
            continue
        if table not in TABLES:
            near = did_you_mean(table, TABLES)
            known = ", ".join(TABLES)
            raise CaseError(
                f"--set {dotted}: unknown table [{table}]{'; ' + near if near else ''} (known: {known})"
            )
        content = changed.setdefault(table, {})
        if isinstance(content, dict):  # else refused when the case is read
            content[key] = value
    _replace_alternatives(changed, overrides.keys())
    if "floor.corner_patch_m" not in overrides:
        _keep_patch_under_wall(changed, data)
    if "support.casting_m" not in overrides and not overrides.keys().isdisjoint(SIDES):
        _keep_castings_under_base(changed)
    return changed


def keys_in_effect(values: Mapping[str, Any], kinds: Mapping[str, object]) -> Mapping[str, Any]:
    """The values by the keys that they set: the peak of a record is what it is scaled to; of two, the last holds.

    Args:
        values: by dotted key.
        kinds: of the motions of the case, by table, before the values are set; see `kinds_of`.
    """
    if values.keys().isdisjoint(OF_A_RECORD):
        return values
    kinds = {table: values.get(f"{table}.kind", kinds.get(table)) for table in ("motion", "vertical")}
    return {
        OF_A_RECORD[key] if key in OF_A_RECORD and kinds[key.partition(".")[0]] == "table" else key: value
        for key, value in values.items()
    }


def kinds_of(data: Mapping[str, Any]) -> dict[str, object]:
    """The kinds of the motions in a case's data, by table."""
    tables = {name: data.get(name) for name in ("motion", "vertical")}
    return {name: table.get("kind") for name, table in tables.items() if isinstance(table, Mapping)}


def _replace_alternatives(data: dict[str, Any], dotted: Any) -> None:
    """Remove the alternatives of the keys just set; keys that were set together stay."""
    container = data.get("container")
    if isinstance(container, dict):
        for group in (("weight_N", "mass_kg", "density_kg_m3"), ("boxes", "box")):
            _drop_others(container, group, _keys_set("container", dotted))
    _replace_support(data, dotted)
    _replace_floor(data, dotted)
    for table in ("motion", "vertical"):
        motion, explicit = data.get(table), _keys_set(table, dotted)
        if not isinstance(motion, dict):
            continue
        _drop_others(motion, FREQUENCIES, explicit)
        _drop_others(motion, ("scale", "scale_to_m_s2"), explicit)
        strengths = {"amplitude_m", "peak_acceleration_m_s2"}
        if strengths <= explicit:
            for key in FREQUENCIES:
                if key not in explicit:
                    motion.pop(key, None)
        elif any(key in motion for key in FREQUENCIES):
            _drop_others(motion, ("amplitude_m", "peak_acceleration_m_s2"), explicit)


def _replace_support(data: dict[str, Any], dotted: Any) -> None:
    """Feet and a flat base have no castings with their posts and no patch of a corner; nor has a patch castings."""
    for key in ("floor", "support", "container"):
        if not isinstance(data.get(key), dict | None):
            return
    floor, support, container = (data.get(key) or {} for key in ("floor", "support", "container"))
    of_floor, of_support = _keys_set("floor", dotted), _keys_set("support", dotted)
    of_container = _keys_set("container", dotted)
    if "shape" in of_container and container["shape"] == "cylinder":  # it has neither edges nor another depth
        _drop(container, ("post_m", "corner_post_N", "depth_m"), of_container)
        _drop(support, ("casting_m",), of_support)
    no_corners = "kind" in of_support and support["kind"] != "corners"
    if no_corners or "casting_m" in of_support:
        _drop(floor, ("corner_patch_m",), of_floor)
    if no_corners or ("corner_patch_m" in of_floor and "casting_m" in support):
        _drop(support, ("casting_m",), of_support)
        _drop(container, ("corner_post_N",), of_container)


def _replace_floor(data: dict[str, Any], dotted: Any) -> None:
    """Another floor takes nothing of the former one: kind, preset; a numerical penalty replaces a slab."""
    floor, contact, explicit = data.get("floor"), data.get("contact"), _keys_set("floor", dotted)
    if not isinstance(floor, dict):
        return
    if not explicit and not _keys_set("contact", dotted).isdisjoint(PENALTY_KEYS):
        floor["kind"], explicit = "rigid", {"kind"}
    if "kind" in explicit and floor.get("kind") == "rigid":
        _drop(floor, SLAB_KEYS, explicit)
    if "kind" in explicit and floor.get("kind") == "slab" and isinstance(contact, dict):
        _drop(contact, PENALTY_KEYS, _keys_set("contact", dotted))
    if "preset" in explicit:
        _drop(floor, PRESET_KEYS, explicit)


def _keep_patch_under_wall(data: dict[str, Any], former: Mapping[str, Any]) -> None:
    """A patch that was as long as the wall is thick, or as wide as the container deep, stays so."""
    floor, box, old = data.get("floor"), data.get("container"), former.get("container")
    patch = floor.get("corner_patch_m") if isinstance(floor, dict) else None
    if not (
        isinstance(floor, dict)
        and isinstance(box, dict)
        and isinstance(old, Mapping)
        and isinstance(patch, list)
    ):
        return
    sides = [(sizes.get("wall_m"), sizes.get("depth_m", sizes.get("width_m"))) for sizes in (old, box)]
    floor["corner_patch_m"] = [
        new if side is not None and side == was else side
        for side, was, new in zip(patch, *sides, strict=False)
    ]


def _keep_castings_under_base(data: dict[str, Any]) -> None:
    """Castings that a narrower or less deep base has no room for become as large as half of it."""
    box, support = data.get("container"), data.get("support")
    casting = support.get("casting_m") if isinstance(support, dict) else None
    if not (
        isinstance(box, dict)
        and isinstance(support, dict)
        and isinstance(casting, list)
        and len(casting) == 3
    ):
        return
    try:
        width, half = 0.5 * box["width_m"] - casting[2], 0.5 * (box.get("depth_m") or box["width_m"])
        support["casting_m"] = [min(casting[0], width), min(casting[1], half), casting[2]]
    except (KeyError, TypeError):
        return  # refused when the case is read


def _keys_set(table: str, dotted: Any) -> set[str]:
    return {key.partition(".")[2] for key in dotted if key.startswith(f"{table}.")}


def _drop_others(table: dict[str, Any], group: tuple[str, ...], explicit: set[str]) -> None:
    if not explicit.isdisjoint(group):
        _drop(table, group, explicit)


def _drop(table: dict[str, Any], group: tuple[str, ...], kept: set[str]) -> None:
    for key in group:
        if key not in kept:
            table.pop(key, None)


def naming_overrides(lines: list[str], overrides: Mapping[str, Any]) -> list[str]:
    """Reasons why a case cannot be used, with each override named on the line of its key, else on a line of its own."""
    named = []
    unnamed = dict(overrides)
    for line in lines:
        for dotted, value in overrides.items():
            table, _, key = dotted.rpartition(".")
            if (
                f"[{table}] {key} " if table else f" {key} "
            ) in line or f"[{table}] unknown key {key!r}" in line:
                line += f" ({_as_override(dotted, value)})"
                unnamed.pop(dotted, None)
        named.append(line)
    if unnamed and not any("(--set " in line for line in named):
        named.append("with " + " ".join(_as_override(dotted, value) for dotted, value in unnamed.items()))
    return named


def _as_override(dotted: str, value: object) -> str:
    text = str(value)[:80]
    return f"--set {dotted}={text if text.isprintable() else repr(text)}"
