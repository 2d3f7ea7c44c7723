"""Pictures after Figs. 6 to 10."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ... import InputError
from ...demo.style import GREY
from .plot_errors import draw_fives, draw_pairs
from .plot_matrix import draw_matrix
from .plot_robot import draw_robot
from .plot_series import draw_series
from .study import Study

STYLE: Any = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
}
PICTURES: dict[str, tuple[tuple[float, float], Callable[[Figure, Study], None]]] = {
    "singles.png": ((11.0, 7.4), draw_robot),
    "pairs_by_link.png": ((15.5, 8.6), draw_matrix),
    "pairs_by_rank.png": ((12.5, 4.6), draw_pairs),
    "fives.png": ((11.0, 4.6), draw_fives),
    "hit_over_time.png": ((13.0, 6.6), draw_series),
}


def save_plots(study: Study, folder: Path) -> list[Path]:
    """Writes all pictures into `folder`, which is made if need be; returns their paths.

    Raises:
        InputError: a file cannot be written.
    """
    paths = []
    with matplotlib.rc_context(STYLE):
        for name, (size, draw) in PICTURES.items():
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
