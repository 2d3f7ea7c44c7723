"""The figures in README and docs are those that were recorded, and each has a command."""

from __future__ import annotations

from pathlib import Path

import pytest
from tools.figures import pages, record, render


def test_pages_agree_with_the_record() -> None:
    assert record.faults() == []


def test_a_changed_figure_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    entries = record.read()
    entries["demo_arm"]["text"] += " changed"
    monkeypatch.setattr(record, "RECORD", tmp_path / "figures.json")
    record.write(entries)
    assert record.faults() == ["README.md, figure 'demo_arm': text differs from docs/figures.json"]


def test_only_the_named_place_is_written(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- figure: one -->\nold\n<!-- end -->\n<!-- figure: two -->\nkept\n<!-- end -->\n")
    pages.write(page, "one", "new")
    assert pages.places(page) == {"one": "new", "two": "kept"}


def test_demo_pools_pushes_of_all_seeds() -> None:
    def run(seed: int, delay: float | None, error: float) -> dict[str, object]:
        push = {"delay_ms": delay, "located": delay is not None, "link_right": True, "point_error_mm": error}
        return {"command": "x", "seed": seed, "result": {"hits": [push], "summary": {"false_alarms": seed}}}

    row = render.demo([run(1, 2.0, 0.5), run(2, None, 0.0)]).splitlines()[-1]
    assert row == "| without noise, seeds 1 to 2 | 1 / 2 | 2.0 to 2.0 ms | 3 | 1 | 1 | 0.5 mm |"
