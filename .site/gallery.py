"""What the gallery shows of a finished result: its page, its sentence, a picture of how the page begins."""

import html
import os
import re
import subprocess
import tempfile
from pathlib import Path

import fem
from fem.report.printing import find_browser

ROOT = Path(__file__).parents[1]
GALLERY = ROOT / "outputs/gallery"
#: an entry of a page: its command, and the name of its folder in outputs
ENTRY = re.compile(r"```sh\npython -m fem (.*?)\n```\n\n<a href=\"\.\./gallery/(.*?)\.html\">", re.DOTALL)
LINK = re.compile(r"<a href=\"\.\./gallery/(.*?)\.html\">(.*?)</a>")
#: pages that commands make by themselves; `report` makes the others
OWN = ("explorer.html", "study.html", "manual.html", "report.html")
WIDTH, HEIGHT = 1100, 690  #: of a picture


def pages_of(folder: Path) -> list[Path]:
    """The pages that a folder of results has."""
    return [folder / name for name in OWN if (folder / name).is_file()]


def said_in(folder: Path) -> str:
    """What a result says first, of a run with the static rule beside it; empty where a page says it with numbers."""
    try:
        result = fem.open_run(folder).result
    except ValueError:
        return ""
    card = result.get("verdict", {}).get("card")
    said = f"{card[0]} {card[-1]}" if card else result.get("answer") or ""
    return said and f"{said[0].upper()}{said[1:].rstrip('.')}."


def picture_of(page: Path) -> None:
    """Draw how a page begins into a PNG beside it, where there is a browser."""
    browser = find_browser()
    if browser is None:
        return
    with tempfile.TemporaryDirectory() as profile:
        flags = ["--headless", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={profile}"]
        flags += ["--no-sandbox"] if os.geteuid() == 0 else []
        flags += [f"--window-size={WIDTH},{HEIGHT}", f"--screenshot={page.with_suffix('.png')}"]
        subprocess.run([browser, *flags, page.as_uri()], capture_output=True, check=True, timeout=120)


def shown(text: str) -> str:
    """A page with its links into the gallery as pictures and sentences; a link to what is not there is left out."""
    return LINK.sub(_figure, text)


def _figure(link: re.Match[str]) -> str:
    name, words = link.groups()
    page = GALLERY / f"{name}.html"
    if not page.is_file():
        return "*Not computed here: the command makes it.*"
    said = html.escape((GALLERY / f"{name}.txt").read_text(encoding="utf-8"))
    picture = f'<img src="../gallery/{name}.png" alt="How the page begins." style="border: 1px solid #bbb">'
    drawn = picture if page.with_suffix(".png").is_file() else ""
    link_to = f'<a href="../gallery/{name}.html">'
    return f"<figure>\n{link_to}{drawn}</a>\n<figcaption>{said} {link_to}{words}</a></figcaption>\n</figure>"
