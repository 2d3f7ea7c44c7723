"""Types of compiled classes in the reference, from the stub, because compiled code has none for Sphinx."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import contactsense

STUB = Path(contactsense.__file__).with_name("_core.pyi")
_ARGUMENT = re.compile(r"^( +)(\w+): ")


def types_of(stub: str) -> dict[str, dict[str, str]]:
    """Types by argument, and of the result as "return", of each function and method by qualified name."""
    found: dict[str, dict[str, str]] = {}

    def visit(body: list[ast.stmt], prefix: str) -> None:
        for node in body:
            if isinstance(node, ast.ClassDef):
                visit(node.body, f"{prefix}{node.name}.")
            elif isinstance(node, ast.FunctionDef):
                # A class has the arguments of its constructor.
                name = prefix[:-1] if node.name in ("__new__", "__init__") else prefix + node.name
                arguments = (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)
                # Not those of a setter, which has the name of its property.
                found.setdefault(
                    name, {arg.arg: _text(arg.annotation) for arg in arguments if arg.annotation}
                )
                if node.returns is not None and name != prefix[:-1]:
                    found[name].setdefault("return", _text(node.returns))

    visit(ast.parse(stub).body, "contactsense.")
    return found


def _text(annotation: ast.expr | None) -> str:
    assert annotation is not None
    return ast.unparse(annotation).replace("np.float64", "float64").replace("np.", "numpy.")


def with_types(lines: list[str], types: dict[str, str]) -> list[str]:
    """A docstring in Google's style whose sections of arguments and results have types."""
    section, written = "", []
    for line in lines:
        if line.endswith(":") and line.strip() in ("Args:", "Returns:", "Raises:", "Example:"):
            section = line.strip()
        elif section == "Args:" and (match := _ARGUMENT.match(line)) and match[2] in types:
            line = f"{match[1]}{match[2]} ({types[match[2]]}): {line[match.end() :]}"
        elif section == "Returns:" and line.strip() and "return" in types:
            indent = line[: len(line) - len(line.lstrip())]
            line, section = f"{indent}{types['return']}: {line.strip()}", ""
        written.append(line)
    return written


def setup(app: Any) -> dict[str, bool]:
    """Called by Sphinx."""
    types = types_of(STUB.read_text(encoding="utf-8"))

    def add(app: object, what: str, name: str, item: object, options: object, lines: list[str]) -> None:
        own = types.get(name)
        if own is None:
            return
        lines[:] = with_types(lines, own)
        if what in ("property", "attribute") and "return" in own:
            lines[:] = [*lines, "", f"Type: `{own['return']}`", ""]

    # Before the docstrings become reStructuredText.
    app.connect("autodoc-process-docstring", add, priority=0)
    return {"parallel_read_safe": True}
