"""The true external torque of a state of MuJoCo."""

from __future__ import annotations

import numpy as np

from contactsense.errors import InputError

from ._arrays import FloatArray
from ._mujoco import mujoco

_CONTACTS = (
    mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS,
    mujoco.mjtConstraint.mjCNSTR_CONTACT_PYRAMIDAL,
    mujoco.mjtConstraint.mjCNSTR_CONTACT_ELLIPTIC,
)


def external_torque(model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
    """What contacts and applied forces put on the joints: the truth an observer looks for.

    This is the torque of all contacts, those of a robot with itself included, and of `data.xfrc_applied`. The
    other constraints, such as limits and dry friction of joints, are no part of it, and neither is
    `data.qfrc_applied`, by which some programs drive the motors.

    After `mj_step`, `data` has the contacts of the beginning of the step; `mj_forward` brings them to the
    present.

    Args:
        model: of any world.
        data: a state of it, after `mj_forward`.

    Returns:
        (model.nv,), in MuJoCo's order and axes [Nm; N for a sliding joint]. `Coordinates.v` converts it for a
        robot that is alone in its world.

    Raises:
        InputError: `data` is not one of `model`.

    Example:
        >>> import mujoco
        >>> from contactsense import sim
        >>> ball = '<body pos="0 0 0.09"><freejoint/><geom size="0.1" mass="1"/></body>'
        >>> world = f'<mujoco><worldbody><geom type="plane" size="1 1 1"/>{ball}</worldbody></mujoco>'
        >>> model = mujoco.MjModel.from_xml_string(world)
        >>> data = mujoco.MjData(model)
        >>> mujoco.mj_step(model, data, 1000)
        >>> mujoco.mj_forward(model, data)
        >>> sim.external_torque(model, data)[:3].round(2)
        array([0.  , 0.  , 9.81])
    """
    if data.qvel.shape != (model.nv,) or data.xfrc_applied.shape != (model.nbody, 6):
        raise InputError(
            f"data: must be of the model with {model.nbody} bodies and {model.nv} degrees of freedom, not of "
            f"one with {len(data.xfrc_applied)} and {data.qvel.size}"
        )
    total = applied_torque(model, data)
    if data.nefc > 0:
        forces = np.where(np.isin(data.efc_type, _CONTACTS), data.efc_force, 0.0)
        of_contacts = np.zeros(model.nv)
        mujoco.mj_mulJacTVec(model, data, of_contacts, forces)
        total += of_contacts
    return total


def applied_torque(model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
    """(model.nv,) what `data.xfrc_applied` alone puts on the joints [Nm]."""
    total = np.zeros(model.nv)
    for body in np.flatnonzero(data.xfrc_applied.any(axis=1)):
        wrench, centre = data.xfrc_applied[body], data.xipos[body]
        mujoco.mj_applyFT(model, data, wrench[:3], wrench[3:], centre, int(body), total)
    return total
