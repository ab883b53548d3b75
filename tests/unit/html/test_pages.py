"""A page holds everything it shows, lets nothing in, and takes text from users as text."""

import base64
import hashlib
import json
import re
from dataclasses import replace

import pytest

from fem.html import page as pages
from fem.html.page import Page, html_of, svg_element

HOSTILE = "</script><script>alert(1)</script><!-- & \u2028"


@pytest.fixture
def page():
    return Page(kind="Report", title=HOSTILE, name="x", content=HOSTILE)


def test_text_from_users_stays_text_in_the_page_in_data_and_in_the_style_sheet(page):
    text = html_of(replace(page, hash=HOSTILE, data={"case": {"name": HOSTILE}}))
    assert "<script>alert" not in text
    assert text.count("<script") == text.count("</script>") == 1
    (held,) = re.findall(r'<script type="application/json" id="case">(.*?)</script>', text)
    assert json.loads(held) == {"name": HOSTILE}
    footer = re.search(r"@bottom-left { content: (.*?); } }", text)
    assert footer is not None
    assert re.fullmatch(r'"[\\\w]*"', footer[1])


def test_only_the_scripts_of_the_page_may_run_and_nothing_may_be_loaded(page, monkeypatch):
    script = "document.title = 'a < b';"
    monkeypatch.setattr(
        pages, "template_text", lambda name: pages.Markup(script if name.endswith(".js") else "")
    )
    text = html_of(replace(page, scripts=["one.js"]))
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = f"default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src 'sha256-{digest}'"
    assert policy in text.replace("&#39;", "'")
    assert f"<script>{script}</script>" in text


@pytest.mark.parametrize(("mode", "used"), [(0o755, True), (0o775, True), (0o777, False)])
@pytest.mark.parametrize("damage", [lambda code: b"garbage", lambda code: code[: len(code) // 2]])
def test_templates_kept_by_an_earlier_process_change_no_page(page, tmp_path, monkeypatch, mode, used, damage):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    pages._environment.cache_clear()
    text = html_of(page)
    kept = {file: file.read_bytes() for file in tmp_path.glob("unanchored/templates-*/*")}
    assert kept
    for file, code in kept.items():
        file.write_bytes(damage(code))
        file.parent.chmod(mode)
    pages._environment.cache_clear()
    assert html_of(page) == text
    assert [file.read_bytes() == code for file, code in kept.items()] == [used] * len(kept)
    pages._environment.cache_clear()


def test_drawings_of_one_page_share_no_ids():
    drawing = '<?xml version="1.0"?>\n<svg><g id="a"/><use href="#a" clip-path="url(#b)"/></svg>'
    element = svg_element(drawing, label='a "plot" < b', prefix="one")
    assert element == (
        '<svg role="img" aria-label="a &#34;plot&#34; &lt; b"><g id="one-a"/>'
        '<use href="#one-a" clip-path="url(#one-b)"/></svg>'
    )


@pytest.mark.parametrize(
    "inside", ["<script>alert(1)</script>", "</svg><h1>stands</h1>", "<a href='x'/>", "<!x", "<gx>"]
)
def test_what_is_no_drawing_is_not_shown_as_one(inside):
    with pytest.raises(ValueError, match="a drawing must not hold"):
        svg_element(f"<svg>{inside}</svg>", label="x", prefix="y")
