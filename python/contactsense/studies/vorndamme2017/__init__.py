"""The experiments of Vorndamme 2017, section VI, on the packaged Atlas: one, two, five pushes at once."""

from .information import rank_deficit
from .instruments import SENSOR_LINKS, external_torque, external_wrenches
from .judge import Verdict, judge
from .scenes import Scene, fives, pairs, singles, standing_pose

__all__ = [
    "SENSOR_LINKS",
    "Scene",
    "Verdict",
    "external_torque",
    "external_wrenches",
    "fives",
    "judge",
    "pairs",
    "rank_deficit",
    "singles",
    "standing_pose",
]
