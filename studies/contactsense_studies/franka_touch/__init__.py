"""Touches of a real Franka arm: are they felt, how soon, and on which link.

The logs are those of MindLabZHAW/tactileGestureDetection: the arm holds still while a person touches one
marked point about fifteen times; touches were labelled by hand. The letter of a file's name says the link.
"""

from .logs import TouchLog, read_logs
from .replay import Replay, replay
from .settings import MEASURED, TUNING_FILES, VENDOR, Settings
from .study import Evaluation, Study, evaluate, run
from .summary import Summary, summarise
from .touches import LogResult, TouchResult
from .tuning import choose_settings

__all__ = [
    "MEASURED",
    "TUNING_FILES",
    "VENDOR",
    "Evaluation",
    "LogResult",
    "Replay",
    "Settings",
    "Study",
    "Summary",
    "TouchLog",
    "TouchResult",
    "choose_settings",
    "evaluate",
    "read_logs",
    "replay",
    "run",
    "summarise",
]
