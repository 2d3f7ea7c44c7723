"""What contact-free motion teaches of one robot."""

from __future__ import annotations

from typing import Any

from .. import _core


class Calibration(_core.Calibration):
    """What contact-free motion teaches of one robot; make one with `calibrate`.

    Vectors are by velocity variable, in the order of `joint_names`. Frozen; equal where all numbers are; can
    be pickled and copied.

    Example:
        >>> import contactsense as cs
        >>> calibration = cs.Calibration.of_description(cs.Robot.named("iiwa14"))
        >>> calibration.torque_bias
        array([0., 0., 0., 0., 0., 0., 0.])
    """

    @classmethod
    def of_description(cls, robot: _core.Robot) -> Calibration:
        """The description as it is, with nothing to correct: to be filled in by hand.

        Args:
            robot: the robot.

        Raises:
            InputError: `robot` is no robot.
        """
        return cls(_core.Calibration._of_description(robot))

    def __reduce__(self) -> tuple[Any, ...]:
        restore, content = super().__reduce__()
        return _restore, (restore, content)

    def __copy__(self) -> Calibration:
        return self

    def __deepcopy__(self, memo: Any) -> Calibration:
        return self


def _restore(restore: Any, content: Any) -> Calibration:
    return Calibration(restore(*content))
