"""The documents as pages. `.site/build` makes them, strictly, with the gallery; the sources are the READMEs."""

import sys
from importlib import metadata
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml

sys.path.insert(0, str(Path(__file__).parent))
from gallery import shown

project = "unanchored"
author = "The developers of unanchored"
copyright = author
version = release = metadata.version("unanchored").partition("+")[0]
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
source_suffix = {".md": "markdown"}
root_doc = ".site/index"
#: the READMEs where they stand, and what only the site has
include_patterns = [".site/*.md", "CHANGELOG.md", "README.md", "fem/README.md", "fem/*/*.md"]
include_patterns += [
    "outputs/keys/*.md",
    "outputs/keys/*/*.md",
    "mesh/README.md",
    "contact/*.md",
    "tests/README.md",
    "tests/*/README.md",
]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
myst_disable_syntax = ["myst_line_comment"]  # a line may begin with %
suppress_warnings = ["misc.highlighting_failure"]  # a block of TOML with dots for what is left out
autodoc_typehints = "description"
smartquotes = False  # a text in a file has straight ones
html_theme = "furo"
html_title = "unanchored"
html_copy_source = False
html_math_renderer = "mathml"


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(tex2mathml(node.astext(), as_block=False))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.math_block) -> None:
    translator.body.append(tex2mathml(node.astext(), as_block=True))
    raise nodes.SkipNode


def _show(app: Any, name: str, source: list[str]) -> None:
    source[0] = shown(source[0]) if name.startswith(".site/") else source[0]


def setup(app: Any) -> None:
    """Set formulas in MathML, which browsers draw without a script and without network; show what is in the gallery."""
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_block, None))
    app.connect("source-read", _show)
