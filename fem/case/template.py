"""A case file with every key: value, unit and meaning, ready to be changed.

It is generated from the tables, so that no key is missing and no default is wrong.
"""

from collections.abc import Mapping
from typing import Any

from pydantic.fields import FieldInfo

from fem.case.case import Case
from fem.case.tables import TABLES, CaseHeading
from fem.case.toml import toml_value
from fem.case.validation import known_keys, quantity_of

COMMENT_COLUMN = 34


def case_template(case: Case) -> str:
    """A commented case file with all keys; those that `case` does not set are comments.

    Args:
        case: gives the values; the file reads back to an equal case.
    """
    resolved = case.resolved()
    resolved.setdefault("vertical", {"kind": case.vertical.kind})  # "none" is not in a resolved case
    lines = [
        "# Every key of a case file, with its meaning and [unit]. Keys in comments are alternatives.",
        "",
    ]
    lines += _key_lines(known_keys(CaseHeading), resolved)
    for name, table in TABLES.items():
        lines += ["", f"{'' if name in resolved else '# '}[{name}]  # {_first_line(table.__doc__)}"]
        lines += _key_lines(known_keys(table), resolved.get(name, {}))
    return "\n".join(lines) + "\n"


def _key_lines(fields: Mapping[str, FieldInfo], values: Mapping[str, Any]) -> list[str]:
    lines = []
    for key, field in fields.items():
        in_use = key in values
        value = values[key] if in_use else _example(field)
        assignment = f"{'' if in_use else '# '}{key} = {toml_value(value)}"
        quantity = quantity_of(field.annotation, field.metadata)
        unit = f" [{quantity.unit}]" if quantity and quantity.unit else ""
        lines.append(f"{assignment:<{COMMENT_COLUMN}} # {field.description}{unit}")
    return lines


def _example(field: FieldInfo) -> Any:
    return field.examples[0] if field.examples else field.get_default()


def _first_line(text: str | None) -> str:
    return (text or "").strip().partition("\n")[0].rstrip(".")
