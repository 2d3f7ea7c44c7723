"""docs/figures.json: the results, and what they were measured with."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from datetime import datetime, timezone
from importlib import metadata
from pathlib import Path
from typing import Any

from benches.compare.machine import describe

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "docs" / "figures.json"
# Beside those that benches name: simulated figures depend on the simulator.
PACKAGES = ("mujoco", "example-robot-data")


def load() -> dict[str, Any]:
    """All records by name."""
    return json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}


def save(records: dict[str, Any]) -> None:
    """Writes all records, ordered by name."""
    text = json.dumps(dict(sorted(records.items())), indent=1, ensure_ascii=False, allow_nan=False)
    FILE.write_text(text + "\n", encoding="utf-8")


def measured() -> dict[str, Any]:
    """Date, commit, processor and versions, of now."""
    versions = {package: metadata.version(package) for package in PACKAGES}
    about = {key: value for key, value in {**describe(), **versions}.items() if value != "absent"}
    code = ("rust/core/src", "rust/python/src", "python")
    changed = bool(git("status", "--porcelain", "--", *code))
    return {
        "date": datetime.now(timezone.utc).date().isoformat(),
        # The last that changed the library.
        "commit": git("log", "-1", "--format=%h", "--", *code) + (" and changes" if changed else ""),
        "about": about,
    }


def introduced(text: str, page: str) -> dict[str, str]:
    """The commit that put `text` into a page, and its date."""
    found = git("log", "-1", f"-S{text}", "--format=%h %ad", "--date=short", "--", page)
    if not found:
        raise SystemExit(f"no commit puts this into {page}: {text}")
    commit, date = found.split()
    return {"commit": commit, "date": date}


def git(*arguments: str) -> str:
    """What git prints."""
    return subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.strip()


def run(command: list[str], folder: Path) -> Any:
    """The JSON that a command prints, run in a folder of its own; `python` is this one."""
    done = subprocess.run(
        [sys.executable, *command[1:]],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},  # `tools` and `benches` are not installed
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SystemExit(f"exit code {done.returncode}: {' '.join(command)}")
    return json.loads(done.stdout)
