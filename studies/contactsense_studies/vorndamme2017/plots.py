"""Pictures after Figs. 6 to 10."""

from __future__ import annotations

from ..harness import Pictures
from .plot_errors import draw_fives, draw_pairs
from .plot_matrix import draw_matrix
from .plot_robot import draw_robot
from .plot_series import draw_series

PICTURES: Pictures = {
    "singles.png": ((11.0, 7.4), draw_robot),
    "pairs_by_link.png": ((15.5, 8.6), draw_matrix),
    "pairs_by_rank.png": ((12.5, 4.6), draw_pairs),
    "fives.png": ((11.0, 4.6), draw_fives),
    "hit_over_time.png": ((13.0, 6.6), draw_series),
}
