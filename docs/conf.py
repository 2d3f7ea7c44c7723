"""Settings of the documentation site: `sphinx-build -W docs SITE`."""

from __future__ import annotations

import re

import contactsense

project = "contactsense"
author = "The contactsense authors"
version = release = contactsense.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode"]
root_doc = "site"
exclude_patterns = ["build"]
html_theme = "furo"
html_title = f"contactsense {version}"

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


def setup(app: object) -> None:
    """Called by Sphinx."""
    # Before napoleon, which makes reStructuredText of the sections.
    app.connect("autodoc-process-docstring", _docstring, priority=1)  # type: ignore[attr-defined]
