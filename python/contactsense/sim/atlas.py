"""The packaged Atlas: its force/torque sensors, and how it stands: posture, feet, stiffness."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from contactsense import ForceTorqueSensor

from ._arrays import FloatArray
from .standing import Sole, StandingController

FEET = ("l_foot", "r_foot")
# Ends of all limbs, before the first arm and leg joints, and behind the back joints.
SENSOR_LINKS = ("l_hand", "r_hand", *FEET, "l_clav", "r_clav", "l_uglut", "r_uglut", "utorso")
SENSORS = tuple(ForceTorqueSensor(link, link) for link in SENSOR_LINKS)
# Of the foot's box and toe, foot's axes [m]; the pressure's centre is kept 1.2 cm inside the edges.
_SOLE_CENTRE, _SOLE_HALF = (0.04, 0.0, -0.076), (0.12, 0.055)
_SINKING = 0.0008  # of the soles into the ground under the robot's weight [m]

# Right side; the left one mirrors it [rad].
_KNEE, _HIP_ROLL = 0.6, -0.1
_ARM = {"shz": 0.3, "shx": 1.2, "ely": 2.0, "elx": -0.9, "wry": 0.0, "wrx": 0.0, "wry2": 0.0}
# How far from it a seed may be [rad].
_ARM_SPREAD, _KNEE_SPREAD = 0.25, 0.15
# Left joints whose axis and range mirror the right one's with the same sign.
_SAME_SIGN = ("ely",)

# Natural frequencies [rad/s]: wrists have to carry pushes with little inertia.
_STIFF, _WRISTS = (
    20.0,
    {"wry": 125.0, "wrx": 125.0, "wry2": 250.0, "elx": 60.0, "ely": 60.0, "shx": 40.0, "shz": 40.0},
)
_DAMPING_RATIO = 0.7


def posture(model: pin.Model, seed: int) -> FloatArray:
    """(nq,) knees bent, arms before the body, a little different for every seed; balanced over the feet."""
    generator = np.random.default_rng([seed, 0])
    knee = _KNEE + generator.uniform(-_KNEE_SPREAD, _KNEE_SPREAD)
    angles = {
        "l_leg_hpx": -_HIP_ROLL,
        "l_leg_akx": _HIP_ROLL,
        "r_leg_hpx": _HIP_ROLL,
        "r_leg_akx": -_HIP_ROLL,
    }
    for side in ("l", "r"):
        for name, angle in _ARM.items():
            sign = -1.0 if side == "l" and name not in _SAME_SIGN else 1.0
            angles[f"{side}_arm_{name}"] = sign * angle + generator.uniform(-_ARM_SPREAD, _ARM_SPREAD)
        angles[f"{side}_leg_kny"] = knee
    return _balanced(model, angles, knee)


def _balanced(model: pin.Model, angles: dict[str, float], knee: float) -> FloatArray:
    """Hips and ankles such that the trunk is upright and the centre of mass over the middle of the soles."""
    low, high = -0.4, 0.4
    for _ in range(50):
        middle = 0.5 * (low + high)
        q, ahead = _leaning(model, angles, knee, middle)
        # The more the hips bend forward, the further behind the feet the trunk is.
        low, high = (low, middle) if ahead < 0.0 else (middle, high)
    return q


def _leaning(
    model: pin.Model, angles: dict[str, float], knee: float, lean: float
) -> tuple[FloatArray, float]:
    """The posture with legs that lean, and how far ahead of the soles' middle its centre of mass is [m]."""
    q = pin.neutral(model)
    legs = {"leg_hpy": -0.5 * knee - lean, "leg_aky": -0.5 * knee + lean}
    both = {f"{side}_{name}": angle for side in ("l", "r") for name, angle in legs.items()}
    for name, angle in {**angles, **both}.items():
        q[model.joints[model.getJointId(name)].idx_q] = angle
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    soles = np.mean([data.oMf[model.getFrameId(foot)].act(np.array(_SOLE_CENTRE)) for foot in FEET], axis=0)
    q[2] -= soles[2] + _SINKING
    return q, float(pin.centerOfMass(model, data, q)[0] - soles[0])


def controller(model: pin.Model, q: FloatArray) -> StandingController:
    """Holds `q`: as stiff as its tick of 1 ms allows."""
    frequency = np.full(model.nv, _STIFF)
    for joint in range(2, model.njoints):
        kind = str(model.names[joint]).rsplit("_", 1)[-1]
        frequency[model.joints[joint].idx_v] = _WRISTS.get(kind, _STIFF)
    soles = [Sole(foot, np.array(_SOLE_CENTRE), _SOLE_HALF) for foot in FEET]
    kd = 2.0 * np.where(frequency > _STIFF, _DAMPING_RATIO, 1.0) * frequency
    return StandingController(model, q, soles, kp=frequency**2, kd=kd)
