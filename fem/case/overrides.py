"""Change single keys of a case: `table.key=value` from the command line, or dotted keys of a sweep.

A key that is one of a group of alternatives replaces the others: `motion.peak_acceleration_m_s2` replaces the amplitude
of a case given by amplitude and frequency. Of a record it is the peak to which it is scaled, `motion.scale_to_m_s2`.
"""

import re
import tomllib
from collections.abc import Collection, Mapping
from contextlib import suppress
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
    """Dotted key and value of one `--set`; what is no TOML value is plain text. CaseError: one of them is missing."""
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
    """A copy of a case's data with dotted keys set, alternatives replaced; CaseError: a key names no table."""
    changed = deepcopy(dict(data))
    tables = {f"{table}.kind": "table" for table in ("motion", "vertical") if f"{table}.file" in overrides}
    if "floor.preset" in overrides:
        tables["floor.kind"] = "slab"
    # who names a record wants it to move the floor, who names a floor to stand on it
    overrides = keys_in_effect(tables | dict(overrides), kinds_of(data))
    for dotted, value in overrides.items():
        table, dot, key = dotted.rpartition(".")
        if not dot and key in TABLES:
            raise CaseError(f"--set {dotted}: [{key}] is a table; set one of its keys, --set {key}.KEY=VALUE")
        if not dot:
            changed[key] = deepcopy(value)  # its rows may be changed below
        elif table in ROWS:
            if not (rows := changed.get(table)):
                raise CaseError(f"--set {dotted}: the case has no [[{table}]] to change; give it one")
            for row in rows if isinstance(rows, list | tuple) else ():
                if isinstance(row, dict):  # else refused when the case is read
                    row[key] = value
        elif table in TABLES:
            changed.setdefault(table, {})
            _table(changed, table)[key] = value
        else:
            known = f"{did_you_mean(table, TABLES)} (known: {', '.join(TABLES)})"
            raise CaseError(f"--set {dotted}: unknown table [{table}]{known}")
    _replace_alternatives(changed, overrides.keys())
    box, floor, support = (_table(changed, name) for name in ("container", "floor", "support"))
    if "floor.corner_patch_m" not in overrides and isinstance(patch := floor.get("corner_patch_m"), list):
        # a patch that was as long as the wall is thick, or as wide as the container deep, stays so
        sides = [
            (each.get("wall_m"), each.get("depth_m", each.get("width_m")))
            for each in (_table(data, "container"), box)
        ]
        floor["corner_patch_m"] = [
            new if side is not None and side == was else side
            for side, was, new in zip(patch, *sides, strict=False)
        ]
    if "support.casting_m" not in overrides and not overrides.keys().isdisjoint(SIDES):
        # castings that a narrower or less deep base has no room for become as large as half of it
        with suppress(KeyError, TypeError, ValueError):  # refused when the case is read
            width, depth, inset = support["casting_m"]
            half = 0.5 * (box.get("depth_m") or box["width_m"])
            support["casting_m"] = [min(width, 0.5 * box["width_m"] - inset), min(depth, half), inset]
    return changed


def _table(data: Mapping[str, Any], name: str) -> dict[str, Any]:
    """A table of a case's data; an empty one that belongs to nothing where it is none, which is refused later."""
    content = data.get(name)
    return content if isinstance(content, dict) else {}


def keys_in_effect(values: Mapping[str, Any], kinds: Mapping[str, object]) -> Mapping[str, Any]:
    """The values by the keys that they set: the peak of a record is what it is scaled to; of two, the last holds.

    `kinds`: of the motions of the case, by table, before the values are set; see `kinds_of`.
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


def _replace_alternatives(data: dict[str, Any], explicit: Collection[str]) -> None:
    """Remove what the keys just set replace; keys that were set together stay."""

    def drop(table: str, *keys: str) -> None:
        for key in keys:
            if f"{table}.{key}" not in explicit:
                _table(data, table).pop(key, None)

    def drop_others(table: str, *keys: str) -> None:
        if any(f"{table}.{key}" in explicit for key in keys):
            drop(table, *keys)

    drop_others("container", "weight_N", "mass_kg", "density_kg_m3")
    drop_others("container", "boxes", "box")
    support, floor = _table(data, "support"), _table(data, "floor")
    if "container.shape" in explicit and _table(data, "container").get("shape") == "cylinder":
        drop("container", "post_m", "corner_post_N", "depth_m")  # it has neither edges nor another depth
        drop("support", "casting_m")
    # feet and a flat base have no castings with their posts and no patch of a corner; nor has a patch castings
    no_corners = "support.kind" in explicit and support.get("kind") != "corners"
    if no_corners or "support.casting_m" in explicit:
        drop("floor", "corner_patch_m")
    if no_corners or ("floor.corner_patch_m" in explicit and "casting_m" in support):
        drop("support", "casting_m")
        drop("container", "corner_post_N")
    # another floor takes nothing of the former one; a numerical penalty replaces a slab
    another = "floor.kind" in explicit
    if not any(key.startswith("floor.") for key in explicit) and any(
        f"contact.{key}" in explicit for key in PENALTY_KEYS
    ):
        floor["kind"], another = "rigid", True
    if another and floor.get("kind") == "rigid":
        drop("floor", *SLAB_KEYS)
    if another and floor.get("kind") == "slab":
        drop("contact", *PENALTY_KEYS)
    if "floor.preset" in explicit:
        drop("floor", *PRESET_KEYS)
    strengths = ("amplitude_m", "peak_acceleration_m_s2")
    for table in ("motion", "vertical"):
        drop_others(table, *FREQUENCIES)
        drop_others(table, "scale", "scale_to_m_s2")
        if all(f"{table}.{key}" in explicit for key in strengths):
            drop(table, *FREQUENCIES)
        elif any(key in _table(data, table) for key in FREQUENCIES):
            drop_others(table, *strengths)


def naming_overrides(lines: list[str], overrides: Mapping[str, Any]) -> list[str]:
    """Reasons why a case cannot be used, with each override named on the line of its key, else on a line of its own."""
    words = {}
    for dotted, value in overrides.items():
        text = str(value)[:80]
        words[dotted] = f"--set {dotted}={text if text.isprintable() else repr(text)}"
    named = []
    unnamed = dict(words)
    for line in lines:
        for dotted, given in words.items():
            table, _, key = dotted.rpartition(".")
            place = f"[{table}] {key} " if table else f" {key} "
            if place in line or f"[{table}] unknown key {key!r}" in line:
                line += f" ({given})"
                unnamed.pop(dotted, None)
        named.append(line)
    if unnamed and not any("(--set " in line for line in named):
        named.append("with " + " ".join(unnamed.values()))
    return named
