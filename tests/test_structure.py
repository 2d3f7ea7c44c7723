"""The files of the core import each other one way."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "rust" / "core" / "src"


def module_files() -> dict[tuple[str, ...], Path]:
    """The file of each module, by its path in the crate."""
    files = {}
    for path in SOURCE.rglob("*.rs"):
        parts = path.relative_to(SOURCE).with_suffix("").parts
        if parts[-1] in ("mod", "lib"):
            parts = parts[:-1]
        if "tests" not in parts:
            files[parts] = path
    return files


def leaves(tree: str) -> Iterator[str]:
    """`a::{b, c::d}` as `a::b` and `a::c::d`."""
    start = tree.find("{")
    if start < 0:
        yield tree
        return
    depth, last = 0, start + 1
    for place, letter in enumerate(tree[start:], start):
        depth += (letter == "{") - (letter == "}")
        if (letter == "," and depth == 1) or depth == 0:
            if part := tree[last:place].strip():
                yield from (tree[:start] + leaf for leaf in leaves(part))
            last = place + 1
        if depth == 0:
            return


def imports(path: Path) -> Iterator[tuple[bool, list[str], str]]:
    """Whether it is handed on, the path, and the name it has here, of each import but those of tests."""
    text = re.sub(r"^#\[cfg\(test\)\]\n[^\n{]*;\n", "", path.read_text(), flags=re.MULTILINE)
    text = re.sub(r"^#\[cfg\(test\)\]\nmod tests \{.*", "", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"//[^\n]*", "", text)
    for match in re.finditer(r"^(pub(?:\([a-z ]+\))? )?use ([^;]+);", text, re.MULTILINE):
        for leaf in leaves(re.sub(r"\s+", " ", match[2])):
            target, _, alias = leaf.partition(" as ")
            names = target.split("::")
            names = names[:-1] if names[-1] == "self" else names
            yield match[1] is not None, names, alias or names[-1]


def absolute(module: tuple[str, ...], names: list[str]) -> tuple[str, ...] | None:
    """The path from the root of the crate; none of another crate."""
    if names[0] == "crate":
        return tuple(names[1:])
    if names[0] not in ("self", "super"):
        return None
    base, rest = list(module), names
    while rest and rest[0] in ("self", "super"):
        base = base[:-1] if rest[0] == "super" else base
        rest = rest[1:]
    return (*base, *rest)


def graph() -> dict[tuple[str, ...], set[tuple[str, ...]]]:
    """The modules whose names each module uses: where they are defined, not where they are handed on."""
    files = module_files()
    handed_on: dict[tuple[str, ...], tuple[str, ...]] = {}
    for module, path in files.items():
        for public, names, name in imports(path):
            # A module's own children may be named without `self`.
            target = absolute(module, names) or ((*module, *names) if (*module, names[0]) in files else None)
            if public and target is not None:
                handed_on[(*module, name)] = target

    def home(item: tuple[str, ...]) -> tuple[str, ...] | None:
        seen = set()
        while item in handed_on and item not in seen:
            seen.add(item)
            item = handed_on[item]
        while item and item not in files:
            item = item[:-1]
        return item or None

    edges: dict[tuple[str, ...], set[tuple[str, ...]]] = {module: set() for module in files}
    for module, path in files.items():
        for public, names, _ in imports(path):
            target = absolute(module, names)
            found = home(target) if target and not public else None
            if found not in (None, module):
                edges[module].add(found)
    return edges


def circles(edges: dict[tuple[str, ...], set[tuple[str, ...]]]) -> set[tuple[str, ...]]:
    """The modules that reach themselves, and those on a way between two of them."""
    left = {module: set(targets) for module, targets in edges.items()}
    while True:
        done = {module for module, targets in left.items() if not targets & left.keys()}
        done |= left.keys() - set().union(*left.values())
        if not done:
            return set(left)
        left = {module: targets for module, targets in left.items() if module not in done}


def test_a_circle_is_seen() -> None:
    edges = {("a",): {("b",)}, ("b",): {("c",)}, ("c",): {("b",)}, ("d",): {("a",)}}
    assert circles(edges) == {("b",), ("c",)}


def test_imports_lead_to_where_names_are_defined() -> None:
    edges = graph()
    assert ("robot", "robot") in edges["isolation", "isolator"]  # handed on by robot/mod.rs
    assert ("isolation", "wrench_rows") in edges["isolation", "wrench"]
    assert sum(map(len, edges.values())) > 1000


def test_no_circle_between_the_files_of_the_core() -> None:
    assert circles(graph()) == set()
