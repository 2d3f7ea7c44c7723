"""Pictures after Figs. 6 to 10."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from ..pictures import save_pictures
from .plot_errors import draw_fives, draw_pairs
from .plot_matrix import draw_matrix
from .plot_robot import draw_robot
from .plot_series import draw_series
from .study import Study

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
    return save_pictures(PICTURES, study, folder)
