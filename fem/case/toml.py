"""Write the flat tables of a case as TOML that reads back to the same values, bit for bit."""

import json
from collections.abc import Mapping
from decimal import Decimal
from typing import Any


def toml_value(value: object) -> str:
    """A scalar, or a list of scalars, as TOML 1.0; a float keeps all its digits.

    Raises:
        TypeError: for anything but a bool, an int, a finite or infinite float, a string, or a list of these.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, float):
        return _float(float(value))
    if isinstance(value, str):
        # JSON escapes what TOML wants escaped, except the delete character.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list):
        return f"[{', '.join(map(toml_value, value))}]"
    raise TypeError(f"no TOML scalar: {type(value).__name__}")


def _float(value: float) -> str:
    """The shortest digits that read back to the same number; large ones with an exponent."""
    if 1e6 <= abs(value) < float("inf"):
        return format(Decimal(repr(value)).normalize(), "e")
    return repr(value)


def toml_document(tables: Mapping[str, Any]) -> str:
    """Scalars first, then one table after another.

    Args:
        tables: key -> scalar, or table name -> mapping of keys to scalars.
    """
    top = [f"{key} = {toml_value(value)}" for key, value in tables.items() if not isinstance(value, Mapping)]
    blocks = ["\n".join(top)] if top else []
    for name, content in tables.items():
        if isinstance(content, Mapping):
            blocks.append(
                "\n".join([f"[{name}]", *(f"{key} = {toml_value(v)}" for key, v in content.items())])
            )
    return "\n\n".join(blocks) + "\n"
