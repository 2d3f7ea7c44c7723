"""The experiments of Bimbo 2019 in simulation: where on an arm is it touched, found by a particle filter."""

from .arm import Arm, load_arm
from .metric import Outcome, judge
from .options import Options
from .score import Score, score
from .study import Study, Trial, run, trial_seed
from .tracking import track
from .trials import record

__all__ = [
    "Arm",
    "Options",
    "Outcome",
    "Score",
    "Study",
    "Trial",
    "judge",
    "load_arm",
    "record",
    "run",
    "score",
    "track",
    "trial_seed",
]
