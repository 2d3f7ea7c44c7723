"""Writes the compiled core's docstrings into its stub, where editors look for them; `--check` only compares.

Names, types and defaults in the stub are written by hand; mypy's stubtest compares them with those compiled.
"""

from __future__ import annotations

import argparse
import ast
import inspect
import sys
import textwrap
from pathlib import Path

from contactsense import _core

STUB = Path(__file__).resolve().parent.parent / "python" / "contactsense" / "_core.pyi"
INDENT = "    "

Documented = ast.ClassDef | ast.FunctionDef


def written(text: str) -> str:
    """The text of a stub, with the docstring of every class, method and function that has one."""
    lines = text.splitlines()
    # From the last to the first, so that line numbers before it stay.
    for node, scope in reversed(list(documented(ast.parse(text)))):
        place(lines, node, docstring(node, scope))
    return "\n".join(lines) + "\n"


def documented(module: ast.Module) -> list[tuple[Documented, object]]:
    """Every definition of a stub with the compiled object that holds it, in the order of the text."""
    found: list[tuple[Documented, object]] = []
    for node in module.body:
        if isinstance(node, Documented):
            found.append((node, _core))
        if isinstance(node, ast.ClassDef):
            holder = getattr(_core, node.name)
            found += [(member, holder) for member in node.body if isinstance(member, ast.FunctionDef)]
    return found


def docstring(node: Documented, scope: object) -> str | None:
    """The compiled docstring; none of special methods, whose documentation is the class's, and of setters."""
    if node.name.startswith("__") or any(isinstance(mark, ast.Attribute) for mark in node.decorator_list):
        return None
    doc = getattr(getattr(scope, node.name), "__doc__", None)
    return inspect.cleandoc(doc) if doc else None


def place(lines: list[str], node: Documented, doc: str | None) -> None:
    """Puts a docstring, or none, under the header of a definition."""
    first = node.body[0]
    rest = [statement for statement in node.body if not is_text(statement) and not is_ellipsis(statement)]
    end = node.end_lineno or node.lineno
    margin = " " * (node.col_offset + len(INDENT))
    header = lines[node.lineno - 1 : first.lineno]
    header[-1] = header[-1][: first.col_offset] if first.lineno == header_end(node, header) else ""
    header = [line.rstrip() for line in header if line.strip()]
    # What is left of a body begins with its first decorator, where it has one.
    kept = lines[rest[0].lineno - 1 - len(getattr(rest[0], "decorator_list", [])) : end] if rest else []
    if doc is None and not kept:
        lines[node.lineno - 1 : end] = [*header[:-1], f"{header[-1]} ..."]
        return
    body = (
        [] if doc is None else [*textwrap.indent(quoted(doc), margin).splitlines(), *([""] if kept else [])]
    )
    lines[node.lineno - 1 : end] = [*header, *body, *kept]


def header_end(node: Documented, header: list[str]) -> int:
    """The line that a definition's body begins on, where that is the header's last."""
    return node.lineno + len(header) - 1


def quoted(doc: str) -> str:
    """A docstring as source text."""
    raw = "r" if "\\" in doc else ""
    return f'{raw}"""{doc}\n"""' if "\n" in doc else f'{raw}"""{doc}"""'


def is_text(node: ast.stmt) -> bool:
    """Whether a statement is a docstring."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def is_ellipsis(node: ast.stmt) -> bool:
    """Whether a statement is `...`."""
    return (
        isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and node.value.value is Ellipsis
    )


def main() -> int:
    """Runs the command; 1 where the stub differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="only compare; fails where the stub differs")
    check = parser.parse_args().check
    text = STUB.read_text(encoding="utf-8")
    new = written(text)
    if check and new != text:
        print(
            f"{STUB}: docstrings differ from the compiled ones; run python tools/stub_docs.py",
            file=sys.stderr,
        )
        return 1
    if not check:
        STUB.write_text(new, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
