"""Tables as TOML that reads back to the same values, bit for bit."""

import json
from collections.abc import Mapping
from decimal import Decimal
from typing import Any


def toml_value(value: object) -> str:
    """A scalar, or a list of scalars, as TOML 1.0; a float keeps all its digits. TypeError: anything else."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, float):
        # the shortest digits that read back to the same number; large ones with an exponent
        large = 1e6 <= abs(value) < float("inf")
        return format(Decimal(repr(float(value))).normalize(), "e") if large else repr(float(value))
    if isinstance(value, str):
        # JSON escapes what TOML wants escaped, except the delete character.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml_value, value))}]"
    raise TypeError(f"no TOML scalar: {type(value).__name__}")


def toml_document(tables: Mapping[str, Any]) -> str:
    """Scalars first, then one table after another, each with its own tables behind it.

    Args:
        tables: key -> scalar, or table name -> mapping of keys to scalars and to sequences of such mappings, or
            such a sequence itself.
    """
    scalars = {
        key: table
        for key, table in tables.items()
        if not isinstance(table, Mapping) and not _are_tables(table)
    }
    top = [f"{key} = {toml_value(value)}" for key, value in scalars.items()]
    blocks = ["\n".join(top)] if top else []
    for name, content in tables.items():
        if isinstance(content, Mapping):
            rows = {key: value for key, value in content.items() if _are_tables(value)}
            own = {key: value for key, value in content.items() if key not in rows}
            blocks.append(_block(f"[{name}]", own))
            blocks += [_block(f"[[{name}.{key}]]", row) for key, value in rows.items() for row in value]
        elif name not in scalars:
            blocks += [_block(f"[[{name}]]", table) for table in content]
    return "\n\n".join(blocks) + "\n"


def _are_tables(value: object) -> bool:
    return isinstance(value, list | tuple) and bool(value) and isinstance(value[0], Mapping)


def _block(heading: str, content: Mapping[str, Any]) -> str:
    return "\n".join([heading, *(f"{key} = {toml_value(value)}" for key, value in content.items())])
