"""A case file with every key: value, unit and meaning, ready to be changed.

It is generated from the tables, so that no key is missing and no default is wrong.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic.fields import FieldInfo

from fem.case.case import Case
from fem.case.tables.all_tables import TABLES, CaseHeading
from fem.case.tables.container_tables import BoxTable
from fem.case.tables.links import ROWS
from fem.case.tables.table import CaseTable
from fem.case.toml import toml_value
from fem.case.validation import known_keys, quantity_of

COMMENT_COLUMN = 34


def case_template(case: Case) -> str:
    """A commented case file with all keys; those that `case` does not set are comments.

    Args:
        case: gives the values; the file reads back to an equal case.
    """
    resolved = case.resolved()
    # What is not in a resolved case, so that it keeps its hash:
    resolved.setdefault("vertical", {"kind": case.vertical.kind})
    resolved["container"].setdefault("joints", case.container.joints)
    lines = [
        "# Every key of a case file, with its meaning and [unit]. Keys in comments are alternatives.",
        "",
    ]
    lines += _key_lines(known_keys(CaseHeading), resolved)
    for name, table in TABLES.items():
        lines += ["", f"{'' if name in resolved else '# '}[{name}]  # {_first_line(table.__doc__)}"]
        fields, values = known_keys(table), resolved.get(name, {})
        boxes = values.pop("box", ())
        lines += _key_lines({key: field for key, field in fields.items() if key != "box"}, values)
        if "box" in fields:
            lines += _row_lines("container.box", BoxTable, boxes)
    for name, table in ROWS.items():
        lines += _row_lines(name, table, resolved.get(name, ()))
    return "\n".join(lines) + "\n"


def _row_lines(name: str, table: type[CaseTable], rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Tables of which a case may have several; in comments where it has none."""
    heading = f"[[{name}]]  # {_first_line(table.__doc__)}"
    lines = []
    for values in rows or ({},):
        lines += ["", heading if values else f"# {heading}"]
        lines += _key_lines(known_keys(table), values)
    return lines


def _key_lines(fields: Mapping[str, FieldInfo], values: Mapping[str, Any]) -> list[str]:
    lines = []
    for key, field in fields.items():
        in_use = key in values
        example = field.examples[0] if field.examples else field.get_default()
        value = values[key] if in_use else example
        assignment = f"{'' if in_use else '# '}{key} = {toml_value(value)}"
        quantity = quantity_of(field.annotation, field.metadata)
        unit = f" [{quantity.unit}]" if quantity and quantity.unit else ""
        lines.append(f"{assignment:<{COMMENT_COLUMN}} # {field.description}{unit}")
    return lines


def _first_line(text: str | None) -> str:
    return (text or "").strip().partition("\n")[0].rstrip(".")
