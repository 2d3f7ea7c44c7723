"""The documentation as a site: it is built without a warning, and its reference has every public name."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from sphinx.util.inventory import InventoryFile

import contactsense
from contactsense import sim

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    # Links to pages and sections that are not there are warnings.
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "docs", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=500, check=False)
    assert done.returncode == 0, done.stderr
    return folder


def test_every_public_name_is_in_the_reference(site: Path) -> None:
    inventory = InventoryFile.loads((site / "objects.inv").read_bytes(), uri="")
    found = {name for kind, items in inventory.data.items() if kind.startswith("py:") for name in items}
    public = {f"contactsense.{name}" for name in contactsense.__all__ if name != "__version__"}
    public |= {f"contactsense.sim.{name}" for name in sim.__all__}
    assert public - found == set()
    # And what can be called of them.
    methods = {
        "contactsense.ContactMonitor.update",
        "contactsense.Replay.to_parquet",
        "contactsense.Robot.from_urdf",
    }
    assert methods <= found


def test_every_page_is_reached(site: Path) -> None:
    pages = {path.relative_to(ROOT / "docs").with_suffix(".html") for path in (ROOT / "docs").rglob("*.md")}
    contents = (site / "site.html").read_text(encoding="utf-8")
    assert [
        page for page in pages if page.name != "site.html" and f'href="{page.as_posix()}"' not in contents
    ] == []


def test_compiled_classes_have_types_in_the_reference(site: Path) -> None:
    page = re.sub(r"<[^>]+>", "", (site / "reference" / "monitor.html").read_text(encoding="utf-8"))
    assert "dt (float) – Time between two calls [s]." in page
    assert "calibration (Calibration | None)" in page
    assert re.search(r"propose_payload\(.*?Return type:\s*PayloadProposal \| None", page, re.DOTALL)
    assert re.search(r"Thresholds on the torques, .*?Type: NDArray\[float64\]", page, re.DOTALL)


def test_equations_are_typeset_without_a_network(site: Path) -> None:
    page = (site / "noise.html").read_text(encoding="utf-8")
    assert page.count('<math xmlns="http://www.w3.org/1998/Math/MathML" display="block">') == 3
    assert '<script src="http' not in page
