"""The nomenclature in the README of `fem` is that of the declarations."""

from pathlib import Path

from fem.case.columns import GROUPS
from fem.results.figures import BOX_FIGURES, FIGURES

README = Path(__file__).parents[3] / "fem" / "README.md"


def nomenclature() -> str:
    """The tables of figures and of history columns, as they stand in the README."""
    figures = [f"| `{key}` | {shown.words} | {shown.unit.name or '-'} |" for key, shown in FIGURES.items()]
    figures += [
        f"| `boxes[].{key}` | {shown.words} of a loose box | {shown.unit.name or '-'} |"
        for key, shown in BOX_FIGURES.items()
    ]
    columns = [
        f"| `{column.name.replace('{}', 'N')}` | {column.unit or '-'} | {column.against or '-'} |"
        for group in GROUPS
        for column in group.columns
    ]
    return "\n".join(
        [
            "| key in `run.json` | words | shown in |",
            "|---|---|---|",
            *figures,
            "",
            "| column of `history.csv` | unit | relative to |",
            "|---|---|---|",
            *columns,
        ]
    )


def test_the_nomenclature_lists_every_quantity():
    written = README.read_text(encoding="utf-8").partition("## Nomenclature\n")[2].partition("\n## ")[0]
    assert nomenclature() in written, f"fem/README.md should hold:\n{nomenclature()}"
