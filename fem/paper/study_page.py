"""The report of a study: its page, made anew from the folder in which it was conducted."""

import json
from pathlib import Path

from fem.html.page import Signature
from fem.paper.page import study_page
from fem.results.run_folder import FolderError

RESULT, FIGURES = "study.json", "figures"


def study_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page, as the text of an HTML file.

    Args:
        folder: of the study, finished or not.
        signature: author, checker, revision.

    Raises:
        FolderError: `study.json` is missing, damaged, or not that of a study.
    """
    path = folder / RESULT
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        svgs = {one.stem: one.read_text(encoding="utf-8") for one in (folder / FIGURES).glob("*.svg")}
        return study_page(document, svgs, signature=signature)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise FolderError(
            f"{path}: damaged, or not the result of a study ({error}); make it anew with "
            "python -m fem study seed --force"
        ) from None
