"""The experiments of Vorndamme 2017, section VI, on the packaged Atlas: one, two, five pushes at once."""

from .information import rank_deficit
from .judge import Verdict, judge
from .scenes import Scene, external_torque, fives, pairs, singles, standing_pose

__all__ = [
    "Scene",
    "Verdict",
    "external_torque",
    "fives",
    "judge",
    "pairs",
    "rank_deficit",
    "singles",
    "standing_pose",
]
