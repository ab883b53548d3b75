"""Change single keys of a case: `table.key=value` from the command line, or dotted keys of a sweep.

A key that is one of a group of alternatives replaces the others: `motion.peak_acceleration_m_s2` replaces the amplitude
of a case given by amplitude and frequency.
"""

import re
import tomllib
from collections.abc import Mapping
from copy import deepcopy
from typing import Any

from fem.case.tables import TABLES
from fem.case.validation import CaseError, did_you_mean

DOTTED_KEY = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)?")
FREQUENCIES = ("angular_frequency_rad_s", "frequency_Hz")


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
    for dotted, value in overrides.items():
        table, dot, key = dotted.rpartition(".")
        if not dot:
            if key in TABLES:
                raise CaseError(
                    f"--set {dotted}: [{key}] is a table; set one of its keys, --set {key}.KEY=VALUE"
                )
            changed[key] = value
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
    return changed


def _replace_alternatives(data: dict[str, Any], dotted: Any) -> None:
    """Remove the alternatives of the keys just set; keys that were set together stay."""
    container = data.get("container")
    if isinstance(container, dict):
        _drop_others(container, ("weight_N", "mass_kg", "density_kg_m3"), _keys_set("container", dotted))
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


def _keys_set(table: str, dotted: Any) -> set[str]:
    return {key.partition(".")[2] for key in dotted if key.startswith(f"{table}.")}


def _drop_others(table: dict[str, Any], group: tuple[str, ...], explicit: set[str]) -> None:
    if explicit.isdisjoint(group):
        return
    for key in group:
        if key not in explicit:
            table.pop(key, None)
