"""Pictures of the tutorials: those that the programs of the pages draw."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from tools.doc_pages import ROOT, run_page

# The picture that each page draws into the folder in which it runs.
_DRAWN = {
    "first_contact": "first_contact.png",
    "calibrate_your_arm": "before_and_after.png",
    "from_a_log": "contact.png",
    "humanoid_with_sensors": "humanoid.png",
    "near_the_base": "near_the_base.png",
}


def _draw(page: str, path: Path) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "empty"
        folder.mkdir()
        run_page(ROOT / "docs" / "tutorials" / f"{page}.md", folder)
        shutil.copyfile(folder / _DRAWN[page], path)


PICTURES: dict[str, Callable[[Path], None]] = {f"tutorial_{page}": partial(_draw, page) for page in _DRAWN}
