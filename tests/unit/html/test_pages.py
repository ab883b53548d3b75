"""A page holds everything it shows, lets nothing in, and takes text from users as text."""

import base64
import hashlib
import json
import re
import typing
from dataclasses import fields, replace

import pytest
from jinja2 import ChoiceLoader, DictLoader
from markupsafe import Markup

from fem.html import page as pages
from fem.html import sections
from fem.html.page import Page, html_of, svg_element
from fem.html.sections import (
    MOST_ROWS,
    NUMBER,
    Cell,
    Choice,
    Column,
    PageSection,
    Table,
    TableRow,
    table_of,
)

HOSTILE = "</script><script>alert(1)</script><!-- & \u2028"


@pytest.fixture
def page():
    """A page of one section."""
    return Page(kind="Report", title=HOSTILE, name="x", sections=[PageSection("Found", "found", [HOSTILE])])


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
    assert f"default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src 'sha256-{digest}'" in (
        text.replace("&#39;", "'")
    )
    assert f"<script>{script}</script>" in text


@pytest.mark.parametrize("block", typing.get_args(sections.Block), ids=lambda kind: kind.__name__)
def test_every_kind_of_block_is_set_and_its_texts_are_escaped(page, block, monkeypatch):
    loaders = [pages._environment().loader, DictLoader({"own.html.j2": "<p>{{ words }}</p>"})]
    monkeypatch.setattr(pages._environment(), "loader", ChoiceLoader(loaders))
    texts = {"title": "<t>", "text": "<t>", "label": "<t>", "note": "<t>", "svg": Markup("<svg></svg>")}
    texts |= {"rows": [("<t>", "a")], "lines": ["<t>"], "blocks": ["<t>"]}
    texts |= {"quantities": [Choice(1, "<t>")], "across": (), "name": "n", "look": ""}
    texts |= {"head": [Cell("<t>")], "summary": "<t>", "template": "own.html.j2", "values": {"words": "<t>"}}
    if block is str:
        made = "<t>"
    else:
        made = block(**{one.name: texts[one.name] for one in fields(block) if one.name in texts})
    if block is Table:
        made = replace(made, rows=[TableRow([Cell("<t>", span=2)])])
    text = html_of(replace(page, sections=[made]))
    assert "<t>" not in text
    assert "&lt;t&gt;" in text


def test_a_section_with_nothing_in_it_is_left_out(page):
    assert "Found" not in html_of(replace(page, sections=[PageSection("Found", "found", [])]))


def test_a_table_has_a_row_for_each_item_and_says_what_it_leaves_out():
    columns = [
        Column("number", str, NUMBER),
        Column("square", lambda k: Cell(f"{k * k}", "fail" if k > 2 else "")),
        Column("nothing", lambda k: "", optional=True),
    ]
    table = table_of(
        "t", columns, range(MOST_ROWS + 5), row_look=lambda k: "given" if k == 0 else "", file="t.csv"
    )
    assert [cell.text for cell in table.head] == ["number", "square"]
    assert len(table.rows) == MOST_ROWS
    assert table.rows[0] == TableRow([Cell("0", NUMBER), Cell("0")], "given")
    assert table.rows[3].cells[1] == Cell("9", "fail")
    assert table.left_out == "5 more rows are in t.csv."


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
