"""Writes the docstrings of the compiled core into its stub, where editors and type checkers look for them.

    python tools/stub_docs.py           writes python/contactsense/_core.pyi
    python tools/stub_docs.py --check   says whether it is up to date

A class's or function's own text stands in the stub as in the compiled module; the rest of the stub is written by
hand.
"""

from __future__ import annotations

import ast
import inspect
import sys
from pathlib import Path

from contactsense import _core

STUB = Path(__file__).resolve().parents[1] / "python/contactsense/_core.pyi"
INDENT = 4


def with_docstrings(source: str) -> str:
    """The stub with the docstring of every public class, method and property."""
    lines = source.split("\n")
    # From the last to the first, so that line numbers stay right.
    for node, owner in reversed(list(_nodes(ast.parse(source)))):
        text = _docstring(owner)
        first = node.body[0]
        decorators = getattr(first, "decorator_list", [])
        start = min([first.lineno, *(entry.lineno for entry in decorators)]) - 1
        indent = " " * (node.col_offset + INDENT)
        new = _quoted(text, indent) if text else []
        has_old = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
        if has_old and isinstance(first.value.value, str):
            end = first.end_lineno
            lines[start:end] = new or [f"{indent}..."]
        elif not new:
            continue
        elif lines[start].strip() == "...":
            lines[start : start + 1] = new
        elif lines[start].endswith(": ...") and _on_one_line(node, first):
            lines[start : start + 1] = [lines[start].removesuffix(" ..."), *new]
        else:
            lines[start:start] = new
    return "\n".join(lines)


def _nodes(tree: ast.Module):
    """Public definitions with the object that each describes, in the order of the text."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            owner = getattr(_core, node.name)
            yield node, owner
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_"):
                    is_setter = any(
                        isinstance(entry, ast.Attribute) and entry.attr == "setter"
                        for entry in inner.decorator_list
                    )
                    if not is_setter:
                        yield inner, owner.__dict__[inner.name]


def _on_one_line(node: ast.ClassDef | ast.FunctionDef, first: ast.stmt) -> bool:
    """Whether the body stands behind the colon; a class's first member may end so, too."""
    return isinstance(node, ast.FunctionDef) or first.lineno == node.lineno


def _docstring(owner: object) -> str:
    return inspect.cleandoc(getattr(owner, "__doc__", None) or "")


def _quoted(text: str, indent: str) -> list[str]:
    raw = "r" if "\\" in text else ""
    body = [f"{indent}{line}".rstrip() for line in text.split("\n")]
    if len(body) == 1:
        return [f'{indent}{raw}"""{text}"""']
    body[0] = f'{indent}{raw}"""{text.split(chr(10))[0]}'
    return [*body, f'{indent}"""']


def _lines(source: str) -> list[str]:
    """Without blank lines, which the formatter sets."""
    return [line for line in source.split("\n") if line.strip()]


def main() -> int:
    source = STUB.read_text(encoding="utf-8")
    wanted = with_docstrings(source)
    if "--check" not in sys.argv[1:]:
        STUB.write_text(wanted, encoding="utf-8")
        return 0
    if _lines(wanted) != _lines(source):
        print(f"{STUB}: its docstrings are not those of the compiled core; run python tools/stub_docs.py")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
