"""Pictures that commands of the package and its studies draw."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

_CONTACTSENSE = (sys.executable, "-m", "contactsense")


def demo(path: Path) -> None:
    """The demonstration of an arm."""
    subprocess.run([*_CONTACTSENSE, "demo", "--out", path], check=True, stdout=subprocess.DEVNULL)


def _of_study(path: Path) -> None:
    """The picture of a study of this name."""
    with tempfile.TemporaryDirectory() as folder:
        command = [*_CONTACTSENSE, "study", path.stem, "--png", folder]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        path.write_bytes((Path(folder) / path.name).read_bytes())


PICTURES: dict[str, Callable[[Path], None]] = {
    "demo": demo,
    # How well the classes of contacts are told, on three robots.
    "contact_classes": _of_study,
    # How exactly torques locate a contact, on an arm and a humanoid.
    "identifiability": _of_study,
}
