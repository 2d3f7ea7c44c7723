"""What the wheel is made of and needs, with licences: `python tools/licences.py [--sbom FILE]`.

Refuses a licence that may not be shipped with MIT or Apache-2.0. Crates are those that the wheel holds,
packages of Python those that `pip install contactsense` brings.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[1]
# Permissive ones, by their names of SPDX.
ALLOWED = {
    *(
        "0BSD",
        "Apache-2.0",
        "BSD-2-Clause",
        "BSD-3-Clause",
        "BSL-1.0",
        "CC0-1.0",
        "ISC",
        "MIT",
        "MIT-0",
        "Python-2.0",
    ),
    *("PSF-2.0", "Unicode-3.0", "Unlicense", "Qhull", "Zlib", "Apache-2.0 WITH LLVM-exception", "NCSA"),
}
# Of packages that are needed at run time, but not shipped in the wheel.
ALLOWED_BESIDE = ALLOWED | {"MPL-2.0", "LGPL-2.1-or-later", "LGPL-3.0-only", "LGPL-3.0-or-later"}
# Where a package says its licence in words of its own.
WORDS = {
    "BSD": "BSD-3-Clause",
    "BSD 2-clause": "BSD-2-Clause",
    "MIT License": "MIT",
    "Apache 2.0": "Apache-2.0",
}
# Packages that say nothing; by the project that they hold.
SILENT = {"cmeel-qhull": "Qhull"}
CLASSIFIERS = {
    "License :: OSI Approved :: BSD License": "BSD-3-Clause",
    "License :: OSI Approved :: MIT License": "MIT",
    "License :: OSI Approved :: Apache Software License": "Apache-2.0",
    "License :: OSI Approved :: Boost Software License 1.0 (BSL-1.0)": "BSL-1.0",
    "License :: OSI Approved :: Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
    "License :: OSI Approved :: GNU Lesser General Public License v2 or later (LGPLv2+)": "LGPL-2.1-or-later",
}


@dataclass(frozen=True)
class Part:
    """A crate or a package."""

    kind: str
    name: str
    version: str
    licence: str


def allowed(expression: str, names: set[str]) -> bool:
    """Whether an expression of SPDX can be met by these licences."""
    tokens = re.findall(r"\(|\)|[^\s()]+(?:\s+WITH\s+[^\s()]+)?", expression.replace("/", " OR "))

    def either() -> bool:
        found = both()
        while tokens and tokens[0] == "OR":
            tokens.pop(0)
            found = both() or found
        return found

    def both() -> bool:
        found = one()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            found = one() and found
        return found

    def one() -> bool:
        if not tokens:
            return False
        token = tokens.pop(0)
        if token != "(":
            return token in names
        found = either()
        return bool(tokens) and tokens.pop(0) == ")" and found

    return either() and not tokens


def crates() -> list[Part]:
    """What is linked into the wheel and the C library."""
    command = ["cargo", "metadata", "--format-version", "1", "--locked"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    told = json.loads(done.stdout)
    packages = {package["id"]: package for package in told["packages"]}
    nodes = {node["id"]: node for node in told["resolve"]["nodes"]}
    open_, found = list(told["workspace_members"]), set()
    while open_:
        if (one := open_.pop()) in found:
            continue
        found.add(one)
        # Those for tests only are not shipped.
        open_ += [
            it["pkg"] for it in nodes[one]["deps"] if any(kind["kind"] is None for kind in it["dep_kinds"])
        ]
    shipped = [packages[one] for one in found - set(told["workspace_members"])]
    return [
        Part("crate", package["name"], package["version"], package["license"] or "")
        for package in sorted(shipped, key=lambda package: (package["name"], package["version"]))
    ]


def packages(names: tuple[str, ...]) -> list[Part]:
    """These packages of the environment, and what they need."""
    open_, found = list(names), {}
    while open_:
        name = re.sub(r"[-_.]+", "-", open_.pop()).lower()
        if name in found:
            continue
        about = metadata.distribution(name)
        found[name] = Part("package", name, about.version, _licence(about) or SILENT.get(name, ""))
        for needed in map(Requirement, about.requires or ()):
            if needed.marker is None or needed.marker.evaluate({"extra": ""}):
                open_.append(needed.name)
    return [found[name] for name in sorted(found)]


def _licence(about: metadata.Distribution) -> str:
    said = about.metadata
    if expression := said.get("License-Expression"):
        return str(expression)
    named = [CLASSIFIERS[it] for it in said.get_all("Classifier") or () if it in CLASSIFIERS]
    if named:
        return " OR ".join(named)
    text = (said.get("License") or "").strip().split("\n")[0]
    return WORDS.get(text, text)


def sbom(parts: list[Part]) -> dict[str, object]:
    """As CycloneDX has it."""
    kinds = {"crate": "cargo", "package": "pypi"}
    components = [
        {
            "type": "library",
            "name": part.name,
            "version": part.version,
            "purl": f"pkg:{kinds[part.kind]}/{part.name}@{part.version}",
            "licenses": [{"expression": part.licence.replace("/", " OR ")}],
        }
        for part in parts
    ]
    return {"bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1, "components": components}


def main() -> int:
    """Lists all parts; exit code 1 where a licence is not allowed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sbom", type=Path, help="writes a bill of materials, CycloneDX as JSON")
    arguments = parser.parse_args()
    shipped, beside = crates(), packages(("numpy", "pin", "pyyaml"))
    wrong = [part for part in shipped if not allowed(part.licence, ALLOWED)]
    wrong += [part for part in beside if not allowed(part.licence, ALLOWED_BESIDE)]
    for part in (*shipped, *beside):
        print(*asdict(part).values(), sep="\t")
    if arguments.sbom:
        arguments.sbom.write_text(json.dumps(sbom([*shipped, *beside]), indent=2) + "\n", encoding="utf-8")
    for part in wrong:
        print(
            f"{part.kind} {part.name} {part.version}: licence {part.licence!r} is not allowed",
            file=sys.stderr,
        )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
