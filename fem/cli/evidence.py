"""What `verify` and `validate` share: a suite computed into a document and a page, and its table printed."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from fem.cli.console import ELSEWHERE_OUT
from fem.results.disk import BYTES_BESIDE
from fem.results.errors import require_writable, writing_into
from fem.results.files import to_json, write_atomically

FAILED = 3


def compute_into(out: Path, name: str, compute: Callable[[], Any], pages: Any, *, as_json: bool) -> int:
    """Write NAME.json and NAME.html, print the document or the table; the exit code, 3 where a finding fails."""
    require_writable(out, ELSEWHERE_OUT, BYTES_BESIDE)
    with writing_into(out, ELSEWHERE_OUT):
        out.mkdir(parents=True, exist_ok=True)
    result = compute()
    document, page = to_json(result.to_dict()), out / f"{name}.html"
    with writing_into(out, ELSEWHERE_OUT):
        write_atomically(out / f"{name}.json", document)
        write_atomically(page, pages.page_of(result))
    print(document.rstrip() if as_json else "\n".join([*pages.lines_of(result), f"{page} {pages.SHOWS}"]))
    return FAILED if result.failures else 0
