"""Every public type of the Rust crate has an example; `cargo test` runs the examples."""

import re
from collections.abc import Iterator
from pathlib import Path

SOURCES = Path(__file__).parent.parent / "rust/core/src"

EXPORT = re.compile(r"^\s*pub use [\w:]+::(?:\{([^}]*)\}|(\w+));", re.MULTILINE)
#: The doc comment and attributes right before a public type, and the type's name.
TYPE = re.compile(
    r"^(?P<before>(?:[ \t]*(?:///|#\[)[^\n]*\n)*)[ \t]*pub (?:struct|enum|trait) (?P<name>\w+)", re.MULTILINE
)


def exported() -> set[str]:
    """Names that the modules' own files make public."""
    names = set()
    for path in [SOURCES / "lib.rs", *SOURCES.rglob("mod.rs")]:
        for several, one in EXPORT.findall(path.read_text()):
            names.update(name.strip() for name in (several or one).split(","))
    return names


def types() -> Iterator[tuple[str, str]]:
    """Every public type and the text before it."""
    public = exported()
    for path in SOURCES.rglob("*.rs"):
        for found in TYPE.finditer(path.read_text()):
            in_public_file = path.name == "mod.rs" or path.parent == SOURCES
            if found["name"] in public or in_public_file:
                yield found["name"], found["before"]


def test_public_types_are_found() -> None:
    names = {name for name, _ in types()}
    assert {"Robot", "Error", "Surface", "ContactMonitor", "ForceTorqueSensor", "Candidate"} <= names
    assert not {"Body", "Detector", "SensorTree"} & names, "private types need no example"


def test_every_public_type_has_an_example() -> None:
    lacking = sorted(name for name, before in types() if "```" not in before)
    assert not lacking
