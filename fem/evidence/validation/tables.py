"""Tables of measured numbers in `fem/evidence/validation/data`; the comment of each names its source and licence."""

import csv
from importlib import resources


def measured_table(name: str) -> list[dict[str, str]]:
    """Rows of a table, by column."""
    text = resources.files("fem.evidence.validation").joinpath("data", name).read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
