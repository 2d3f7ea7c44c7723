"""Writing a study's pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from .. import InputError
from ..demo.style import GREY

Study = TypeVar("Study")

STYLE: Any = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
}


def save_pictures(
    pictures: Mapping[str, tuple[tuple[float, float], Callable[[Figure, Study], None]]],
    study: Study,
    folder: Path,
) -> list[Path]:
    """Draws each picture, of a size in inches, and writes it into `folder`, which is made if need be.

    Returns:
        The pictures' paths.

    Raises:
        InputError: a file cannot be written.
    """
    paths = []
    with matplotlib.rc_context(STYLE):
        for name, (size, draw) in pictures.items():
            figure = Figure(figsize=size, layout="constrained")
            FigureCanvasAgg(figure)
            draw(figure, study)
            try:
                folder.mkdir(parents=True, exist_ok=True)
                figure.savefig(folder / name, dpi=130, facecolor="white")
            except OSError as cause:
                raise InputError(f"png: cannot write '{folder / name}': {cause}") from cause
            paths.append(folder / name)
    return paths
