"""Tables of measured numbers in `tests/validation/data`; the comment of each names its source and licence."""

import csv
from pathlib import Path


def measured_table(name: str) -> list[dict[str, str]]:
    """Rows of a table, by column."""
    text = (Path(__file__).parent / "data" / name).read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
