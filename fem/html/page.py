"""Pages: one self-contained HTML file each, without network and without other files.

A page has a template that reads like it and extends `page.html.j2`. Text from users is escaped everywhere: in the page,
in JSON inside a script element, in a style sheet. The content security policy of the page forbids the browser to load
anything and to run any script but those of the page.
"""

import base64
import datetime as dt
import hashlib
import json
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache, partial
from importlib import metadata
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined, UndefinedError
from jinja2.bccache import Bucket
from markupsafe import Markup, escape

from fem.html.units import (
    ABSENT,
    degrees,
    figure_cell,
    figure_head,
    formula_markup,
    millimetres,
    number,
    quantity,
    ratio,
    short,
    typeset,
)
from fem.results.figures import FIGURES
from fem.results.json_block import JsonBlock
from fem.runtime.own_files import kept_folder

TEMPLATES = Path(__file__).parent / "templates"

#: the tag of an element that drawings of matplotlib never hold; a comment begins like one
FOREIGN = re.compile(
    r"<(?!/|!--|(?:svg|g|defs|clipPath|path|pattern|rect|circle|line|polyline|polygon|use|text|tspan|image|style|title"
    r"|desc|metadata|rdf:RDF|cc:Work|cc:Agent|dc:(?:type|format|date|creator|title))[\s/>])[^\s/>]*"
)
#: what templates set values with: numbers and units of `fem.html.units`, symbols, and columns of declared figures
FILTERS = {
    "cell": lambda value, figure: figure_cell(figure, value),
    "degrees": degrees,
    "drawing": lambda text, label, prefix: svg_element(text, label=label, prefix=prefix),
    "figure_of": FIGURES.__getitem__,
    "form": format,
    "formula": formula_markup,
    "head": lambda figure: f"#{figure_head(figure)}",
    "mm": millimetres,
    "number": number,
    "quantity": quantity,
    "ratio": ratio,
    "short": short,
    "svg": lambda text, name: svg_element(text, label=name.replace("-", " "), prefix=name),
    "symbols": partial(formula_markup, prose=True),
    "two": lambda value, figure: (
        ABSENT if value is None else typeset(figure.unit.text(value, figures=2, bare=True))
    ),
    "typeset": typeset,
    "used": lambda value, figures: "∞" if value is None else number(value, figures=figures),
}


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """A figure as SVG."""

    name: str
    title: str
    cursor: dict[str, Any] | None  #: where a cursor moves over it, see `cursor_axes`
    svg: str  #: the text of the file


def require_drawing(text: str) -> None:
    """Refuse what is no drawing.

    Raises:
        ValueError: no SVG, or elements in it that no drawing has.
    """
    _, start, inside = text.partition("<svg")
    if not start:
        raise ValueError("no drawing")
    if foreign := FOREIGN.search(inside):
        raise ValueError(f"a drawing must not hold {foreign[0]}>")


@dataclass(frozen=True, kw_only=True)
class Signature(JsonBlock):
    """Project and persons of a page; may be filled in later."""

    project: str = ""
    company: str = ""
    number: str = ""  #: of the document
    revision: str = ""
    author: str = ""
    checker: str = ""

    @property
    def heading(self) -> str:
        """The line above the title, and at the head of every printed sheet; empty where nothing is known."""
        return " · ".join(part for part in (self.company, self.project, self.number) if part)

    def completed(self, document: Mapping[str, str | None]) -> "Signature":
        """Completed from the table [document] of a case."""
        return replace(
            self, **{key: text for key, text in document.items() if text and not getattr(self, key)}
        )


@dataclass(frozen=True, kw_only=True)
class Page:
    """What one file shows."""

    kind: str  #: above the title
    title: str
    name: str  #: of what it shows; a copy of the page is named after it
    content: str = ""  #: markup, of a page without a template of its own
    introduction: str = ""  #: markup under its title
    signature: Signature | None = None  #: None of a page that nobody signs
    hash: str = ""  #: of what it shows, at the foot of every printed sheet
    scripts: Sequence[str] = ()  #: file names of the scripts that run in it, in order
    #: what they read, by the id of the element of type application/json that holds it
    data: Mapping[str, Any] = field(default_factory=dict)


def html_of(
    page: Page,
    template: str = "page.html.j2",
    filters: Mapping[str, Callable[..., Any]] | None = None,
    **shown: Any,
) -> str:
    """The text of the file.

    Args:
        page: what it shows.
        template: of `fem/html/templates`.
        filters: that it has beside `FILTERS`.
        shown: results and functions that it names.

    Raises:
        KeyError: a result lacks what the template names.
    """
    environment = _environment().overlay()
    environment.filters = {**environment.filters, **(filters or {})}
    signed = ("signature.js",) if page.signature else ()
    scripts = [template_text(name) for name in (*page.scripts, *signed)]
    hashes = (base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts)
    version = metadata.version("unanchored")
    try:
        return environment.get_template(template).render(
            shown,
            page=page,
            signature=page.signature,
            style=template_text("page.css"),
            scripts=scripts,
            script_policy=" ".join(f"'sha256-{digest}'" for digest in hashes) or "'none'",
            data={name: _json_in_page(value) for name, value in page.data.items()},
            foot=f"unanchored {version}   {page.hash[:12]}".rstrip(),
            version=version,
            today=dt.date.today().isoformat(),
        )
    except UndefinedError as error:
        raise KeyError(str(error)) from None  # of a damaged result, like any key that is missing


def text_of(template: str, macro: str = "", **shown: Any) -> str:
    """A text for a terminal, by a template of `fem/html/templates` or by one of its macros."""
    source = _environment(autoescape=False).get_template(template)
    return str(getattr(source.make_module(shown), macro)() if macro else source.render(shown)).rstrip()


@cache
def template_text(name: str) -> Markup:
    """A style sheet or script of `fem/html/templates`, for a page."""
    return Markup((TEMPLATES / name).read_text(encoding="utf-8"))  # our own file, never a user's


def svg_element(text: str, *, label: str, prefix: str) -> Markup:
    """The `svg` element of a drawing, for a page with others.

    Args:
        text: an SVG file, as matplotlib or this program writes it; its own texts are escaped.
        label: what it shows, for those who cannot see it.
        prefix: put before every id in it, so that two drawings of a page share none.

    Raises:
        ValueError: it is no drawing, or holds something else.
    """
    require_drawing(text)
    element = text[text.index("<svg") :]
    element = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}-", element)
    return Markup(element.replace("<svg", f'<svg role="img" aria-label="{escape(label)}"', 1))


class _KeptTemplates(FileSystemBytecodeCache):
    """Templates as compiled by an earlier process; jinja compares their text."""

    def load_bytecode(self, bucket: Bucket) -> None:
        with suppress(Exception):  # a damaged file is none
            super().load_bytecode(bucket)

    def dump_bytecode(self, bucket: Bucket) -> None:
        with suppress(OSError):
            super().dump_bytecode(bucket)


@cache
def _environment(*, autoescape: bool = True) -> Environment:
    kept = kept_folder(f"templates-jinja{metadata.version('jinja2')}")
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        # what is compiled with and without escaping differs
        bytecode_cache=None if kept is None else _KeptTemplates(str(kept), f"{autoescape}-%s"),
        autoescape=autoescape,
        undefined=StrictUndefined,
        optimized=False,  # most templates are set once, and folding constants takes longer than that
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= FILTERS | {"css_string": _css_string, "form": format}
    return environment


def _json_in_page(value: Any) -> Markup:
    """JSON that no element of a page can end: neither `</script>` nor a comment can stand in it."""
    text = json.dumps(value, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
    for sign in "<>&\u2028\u2029":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return Markup(text)  # escaped above


def _css_string(text: str) -> Markup:
    """Text as a CSS string: everything but letters and digits by its code point, which would swallow a space."""
    signs = (sign if sign.isalnum() else f"\\{ord(sign):06x}" for sign in text)
    return Markup(f'"{"".join(signs)}"')  # escaped here
