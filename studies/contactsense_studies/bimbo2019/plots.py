"""Pictures after Figs. 3 to 7."""

from __future__ import annotations

from ..harness import Pictures
from .plot_errors import draw_confidence, draw_models, draw_noise
from .plot_progress import draw_obstacles, draw_progress

PICTURES: Pictures = {
    "models.png": ((12.5, 5.0), draw_models),
    "noise.png": ((12.5, 5.0), draw_noise),
    "obstacles.png": ((12.5, 5.4), draw_obstacles),
    "confidence.png": ((12.5, 4.6), draw_confidence),
    "progress.png": ((15.0, 5.8), draw_progress),
}
