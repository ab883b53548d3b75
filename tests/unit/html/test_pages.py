"""A page holds everything it shows, lets nothing in, and takes text from users as text."""

import base64
import hashlib
import json
import re

import pytest
from jinja2 import UndefinedError

from fem.html import page as pages
from fem.html.page import render_page, svg_element

HOSTILE = "</script><script>alert(1)</script><!-- & \u2028"


@pytest.fixture
def template(monkeypatch):
    """A page of one line, with what the base template brings."""
    source = (
        '{% extends "page.html.j2" %}{% block title %}{{ name }}{% endblock %}'
        "{% block print_footer %}{{ name | css_string }}{% endblock %}"
        "{% block content %}<p>{{ name }}</p>{% endblock %}"
    )
    loader = pages._environment().loader
    original = type(loader).get_source

    def get_source(self, environment, name):
        return (source, None, lambda: True) if name == "one_line" else original(self, environment, name)

    monkeypatch.setattr(type(loader), "get_source", get_source)
    return "one_line"


def test_text_from_users_stays_text_in_the_page_in_data_and_in_the_style_sheet(template):
    page = render_page(template, name=HOSTILE, data={"case": {"name": HOSTILE}})
    assert "<script>alert" not in page
    assert page.count("<script") == page.count("</script>") == 1
    (text,) = re.findall(r'<script type="application/json" id="case">(.*?)</script>', page)
    assert json.loads(text) == {"name": HOSTILE}
    footer = re.search(r"@bottom-left { content: (.*?); } }", page)
    assert footer is not None
    assert set(footer[1]) <= set('"\\ 0123456789abcdefscriptal')


def test_only_the_scripts_of_the_page_may_run_and_nothing_may_be_loaded(template, monkeypatch):
    script = "document.title = 'a < b';"
    monkeypatch.setattr(
        pages, "template_text", lambda name: pages.Markup(script if name.endswith(".js") else "")
    )
    page = render_page(template, name="x", scripts=["one.js"])
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src 'sha256-{digest}'" in (
        page.replace("&#39;", "'")
    )
    assert f"<script>{script}</script>" in page


def test_a_page_without_something_it_asks_for_is_not_made(template):
    with pytest.raises(UndefinedError):
        render_page(template)


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
