"""What contact-free motion teaches of one robot."""

from .calibrate import calibrate
from .calibration import Calibration

__all__ = ["Calibration", "calibrate"]
