"""A page as a PDF, printed by a browser of the Chromium family where there is one."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from fem.results.errors import OutputError
from fem.runtime.own_files import copy_file

#: names of the program, in the order of trying; on Windows and macOS it stands where it is installed
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge")
PLACES = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    r"C:\Program Files\Google\Chrome\Application\chrome.exe",
    r"C:\Program Files (x86)\Microsoft\Edge\Application\msedge.exe",
)
TIME_LIMIT_S = 120.0
BY_HAND = (
    "open the page in a browser and print it to a file (A4, no scaling); Chromium or Chrome would do it here"
)


class PrintingError(OutputError):
    """The page could not be printed."""


def find_browser() -> str | None:
    """The browser that prints; None where none is found."""
    return next((path for name in (*NAMES, *PLACES) if (path := shutil.which(name))), None)


def print_page(page: Path) -> Path | None:
    """Print an HTML file to a PDF beside it; None where there is no browser.

    Raises:
        PrintingError: the browser ended without a PDF, or did not end.
    """
    browser = find_browser()
    if browser is None:
        return None
    target = page.with_suffix(".pdf")
    with tempfile.TemporaryDirectory() as profile:
        printed = Path(profile) / "page.pdf"
        command = [
            browser,
            "--headless",
            "--disable-gpu",
            "--no-pdf-header-footer",
            f"--user-data-dir={profile}",
            f"--print-to-pdf={printed}",
            page.resolve().as_uri(),
        ]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            command.insert(1, "--no-sandbox")  # which does not work for root; the page is our own
        try:
            subprocess.run(command, capture_output=True, timeout=TIME_LIMIT_S, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise PrintingError(f"{page}: {browser} did not print it ({error}); {BY_HAND}") from None
        if not printed.is_file():
            raise PrintingError(f"{page}: {browser} printed nothing; {BY_HAND}")
        copy_file(printed, target)
    return target
