"""Writes `rust/core/tests/data`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import trimesh

from . import contacts, dynamics, filter_runs, meshed_arm
from .robot import GoldenRobot

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "rust" / "core" / "tests" / "data"
DESCRIPTIONS = ROOT / "python" / "contactsense" / "descriptions"
SEEDS = {"contacts": 100, "dynamics": 200, "filter": (300, 301, 302)}
VERSIONS = {"pinocchio": pin.__version__, "trimesh": trimesh.__version__, "numpy": np.__version__}


def _plain(value: Any) -> Any:
    """Arrays as lists, and numbers that were rounded as they are written."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(type(value).__name__)


def _write(name: str, seed: object, rows: dict[str, Any]) -> None:
    about = {"command": "python -m tools.golden", "seed": seed, "versions": VERSIONS}
    text = json.dumps({"about": about, **rows}, default=_plain)
    # One row of data a line, so that a change shows what has changed.
    (DATA / f"{name}.json").write_text(text.replace('}, {"', '},\n{"') + "\n", encoding="utf-8")


def main() -> None:
    """Writes all files."""
    DATA.mkdir(exist_ok=True)
    meshed = meshed_arm.write(DESCRIPTIONS / "iiwa14.urdf", DATA)
    arm = GoldenRobot.read(DESCRIPTIONS / "iiwa14.urdf", floating_base=False)
    atlas = GoldenRobot.read(DESCRIPTIONS / "atlas.urdf", floating_base=True)
    bumpy = GoldenRobot.read(meshed, floating_base=False)
    for robot, name, count in (
        (arm, "iiwa14", (8, 30)),
        (atlas, "atlas", (3, 3)),
        (bumpy, "meshed_arm", (8, 30)),
    ):
        seed = SEEDS["contacts"]
        _write(f"contacts_{name}", seed, contacts.make(robot, *count, seed))
    for robot, name in ((arm, "iiwa14"), (atlas, "atlas")):
        seed = SEEDS["dynamics"]
        _write(f"dynamics_{name}", seed, dynamics.make(robot, 3, seed))
    _write("observer_iiwa14", SEEDS["dynamics"], dynamics.observer(arm, SEEDS["dynamics"]))
    for robot, name in ((arm, "iiwa14"), (bumpy, "meshed_arm")):
        _write(f"filter_{name}", SEEDS["filter"], filter_runs.make(robot, SEEDS["filter"]))


main()
