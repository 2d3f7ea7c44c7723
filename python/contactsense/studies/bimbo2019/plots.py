"""Pictures after Figs. 3 to 7."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from ..pictures import save_pictures
from .plot_confidence import draw_confidence
from .plot_errors import draw_models, draw_noise
from .plot_obstacles import draw_obstacles
from .plot_progress import draw_progress
from .study import Study

PICTURES: dict[str, tuple[tuple[float, float], Callable[[Figure, Study], None]]] = {
    "models.png": ((12.5, 5.0), draw_models),
    "noise.png": ((12.5, 5.0), draw_noise),
    "obstacles.png": ((12.5, 5.4), draw_obstacles),
    "confidence.png": ((12.5, 4.6), draw_confidence),
    "progress.png": ((15.0, 5.8), draw_progress),
}


def save_plots(study: Study, folder: Path) -> list[Path]:
    """Writes all pictures into `folder`, which is made if need be; returns their paths.

    Raises:
        InputError: a file cannot be written.
    """
    return save_pictures(PICTURES, study, folder)
