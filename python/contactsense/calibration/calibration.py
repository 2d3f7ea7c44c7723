"""What contact-free motion teaches of one robot."""

from __future__ import annotations

import os
from typing import Any

from .. import _core
from ..errors import InputError


class Calibration(_core.Calibration):
    """What contact-free motion teaches of one robot; make one with `calibrate`, or `load` it.

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
            InputError: `robot` is no robot, or has no joint that moves.
        """
        return cls(_core.Calibration._of_description(robot))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Calibration:
        """A calibration from a file that `save` wrote, perhaps edited since. No robot is needed.

        Whether it fits a robot is known when it is used, or by `check`.

        Args:
            path: of the file.

        Raises:
            InputError: the file cannot be read, or an entry is missing, unknown or wrong; names the file, the
                joint and the entry.
        """
        from .._paths import path_of  # few programs need it

        return cls(_core.Calibration._load(path_of(path)))

    def save(self, path: str | os.PathLike[str], *, source: str = "") -> None:
        """Writes a YAML file keyed by the names of joints and links, with units, for people to read and edit.

        Numbers have ten digits.

        Args:
            path: of the file; one that exists is replaced.
            source: where the calibration is from, such as the name of the log; kept in the file only.

        Raises:
            InputError: the file cannot be written, or `source` is no text.
        """
        from datetime import date

        from .._paths import path_of

        if not isinstance(source, str):
            raise InputError(f"source: expected a string, got {source!r}")
        file = path_of(path)
        text = self._to_yaml(source, date.today().isoformat())
        try:
            file.write_text(text, encoding="utf-8")
        except (OSError, ValueError) as error:
            raise InputError(f"path: cannot write {file}: {error}") from error

    def __reduce__(self) -> tuple[Any, ...]:
        restore, content = super().__reduce__()
        return _restore, (restore, content)

    def __copy__(self) -> Calibration:
        return self

    def __deepcopy__(self, memo: Any) -> Calibration:
        return self


def _restore(restore: Any, content: Any) -> Calibration:
    return Calibration(restore(*content))
