"""From contact-free motion to a calibration."""

from __future__ import annotations

from .. import _core
from ..errors import InputError
from ..log import Log
from .calibration import Calibration


def calibrate(
    robot: _core.Robot,
    log: Log,
    *,
    false_alarms_per_hour: float = 1.0,
    payload_link: str | None = None,
) -> Calibration:
    """What a robot's motion without contact tells about its torques, friction, inertias and noise.

    Blocks of the log are held out in turn: they choose how far inertias may differ from the description, and
    from them the noise and the residual come. Short contacts are found and left out.

    Args:
        robot: with a fixed base.
        log: motion without contact, at least 10 s; see `exciting_motion`. Where it has only
            `external_torque`, the bias, friction and noise left in that are learnt.
        false_alarms_per_hour: that thresholds are set for [1/h].
        payload_link: the link that holds a payload which the description lacks.

    Returns:
        A `Calibration`.

    Raises:
        InputError: the log or an argument cannot be used, or the base of the robot is free to move; names it.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> motion = cs.exciting_motion(robot, 12.0, dt=0.01)
        >>> rows = zip(motion.q, motion.v, motion.a)
        >>> tau = [robot.inverse_dynamics(q, v, a) + 0.5 for q, v, a in rows]
        >>> calibration = cs.calibrate(robot, cs.Log(motion.time, motion.q, motion.v, tau))
        >>> calibration.torque_bias.round(1)
        array([0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5])
    """
    if not isinstance(log, Log):
        raise InputError(f"log: expected a contactsense.Log, got {type(log).__name__}")
    external = log.tau is None
    tau = log.external_torque if log.tau is None else log.tau
    assert tau is not None  # a log has one of them
    columns = (log.time, log.q.ravel(), log.v.ravel(), tau.ravel())
    return Calibration(_core._calibrate(robot, *columns, false_alarms_per_hour, payload_link, external))
