"""The command line."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from . import pages, studies, tutorials

FOLDER = Path(__file__).parents[2] / "docs" / "pictures"
# Each function writes the picture of its name to a file.
PICTURES: dict[str, Callable[[Path], None]] = {
    **studies.PICTURES,
    **pages.PICTURES,
    **tutorials.PICTURES,
}


def main() -> None:
    """Makes the pictures that are named, or all."""
    parser = argparse.ArgumentParser(prog="python -m tools.pictures", description=main.__doc__)
    parser.add_argument("name", nargs="*", metavar="NAME", help=f"one of {', '.join(PICTURES)}")
    names = parser.parse_args().name
    unknown = sorted(set(names) - set(PICTURES))
    if unknown:
        parser.error(f"NAME: must be one of {', '.join(PICTURES)}, not {', '.join(unknown)}")
    FOLDER.mkdir(exist_ok=True)
    for name in names or PICTURES:
        print(name, file=sys.stderr)
        PICTURES[name](FOLDER / f"{name}.png")


if __name__ == "__main__":
    main()
