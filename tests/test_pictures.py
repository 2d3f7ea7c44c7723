"""The pictures of the documentation: each is made by a function, is there, and is shown on a page."""

from __future__ import annotations

import struct
from pathlib import Path

from tools.pictures.__main__ import FOLDER, PICTURES

DOCS = Path(__file__).parents[1] / "docs"


def test_each_picture_has_its_function() -> None:
    assert sorted(path.stem for path in FOLDER.glob("*")) == sorted(PICTURES)


def test_each_picture_is_shown_on_a_page() -> None:
    pages = [DOCS.parent / "README.md", *DOCS.rglob("*.md")]
    text = "".join(path.read_text(encoding="utf-8") for path in pages)
    assert [name for name in PICTURES if f"pictures/{name}.png)" not in text] == []


def test_each_picture_can_be_read_at_full_width() -> None:
    for name in PICTURES:
        data = (FOLDER / f"{name}.png").read_bytes()
        assert data[:8] == b"\x89PNG\r\n\x1a\n"
        width, height = struct.unpack(">II", data[16:24])
        assert 800 <= width <= 2400, name
        assert height >= 300, name
        # A picture of a page that is empty compresses to less.
        assert len(data) > 20_000, name
