"""Settings of the documentation site: `sphinx-build -W docs SITE`."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.util import logging

import contactsense

project = "contactsense"
author = "The contactsense authors"
version = release = contactsense.__version__
sys.path.append(str(Path(__file__).parent / "_extensions"))
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "stub_types",
]
root_doc = "site"
exclude_patterns = ["build"]
html_theme = "furo"
html_title = f"contactsense {version}"

# Browsers typeset MathML by themselves: the pages need no network.
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["mathematics.css"]

# Sections are linked by their names, as on GitHub.
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]

# Docstrings write code in single backticks.
default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "description"
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True

_CODE = re.compile(r"(`[^`]*`)")


def _plain_text(line: str) -> str:
    """Signs that mean something in reStructuredText, but not in the docstrings."""
    parts = _CODE.split(line)
    return "".join(
        part if part.startswith("`") else re.sub(r"([*|\\]|(?<=\w)_(?!\w))", r"\\\1", part) for part in parts
    )


def _docstring(app: object, what: str, name: str, item: object, options: object, lines: list[str]) -> None:
    lines[:] = [
        line if line.lstrip().startswith((">>>", "...", ".. ", ":")) else _plain_text(line) for line in lines
    ]


def _equation(display: str) -> Any:
    def write(translator: Any, node: nodes.Element) -> None:
        written = convert(node.astext(), display=display)
        if "\\" in written:  # a command that it does not know
            logging.getLogger(__name__).warning("cannot typeset %s", node.astext(), location=node)
        translator.body.append(written)
        raise nodes.SkipNode

    return write


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.add_html_math_renderer("mathml", (_equation("inline"), None), (_equation("block"), None))
    # Before napoleon, which makes reStructuredText of the sections.
    app.connect("autodoc-process-docstring", _docstring, priority=1)
