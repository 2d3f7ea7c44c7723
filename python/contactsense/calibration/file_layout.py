"""Which entries a calibration file has, with their units; a new number of a joint is one line here."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Rule = Literal["any", "not negative", "positive", "not zero"]

# Files of another format are refused: an entry may mean something else there.
FORMAT = 2


@dataclass(frozen=True)
class Field:
    """A number of a file.

    Attributes:
        name: in the file.
        unit: as the file says it, "Nm (N)" for Nm that are N where a joint slides.
        path: where it is in the core's content.
        rule: which numbers can be used.
    """

    name: str
    unit: str
    path: tuple[str, ...]
    rule: Rule = "any"


def fits(number: float, rule: Rule) -> bool:
    """Whether a number can be used."""
    allowed = {
        "any": True,
        "not negative": number >= 0.0,
        "positive": number > 0.0,
        "not zero": number != 0.0,
    }
    return math.isfinite(number) and allowed[rule]


JOINT_FIELDS = (
    Field("torque_bias", "Nm (N), constant torque that the measurement adds", ("torque_bias",)),
    Field("torque_bias_std", "Nm (N), one standard deviation", ("torque_bias_std",), "not negative"),
    Field("torque_scale", "true torque / measured torque, sign included", ("torque_scale",), "not zero"),
    Field("coulomb", "Nm (N), Coulomb friction", ("friction", "coulomb"), "not negative"),
    Field("coulomb_std", "Nm (N)", ("coulomb_std",), "not negative"),
    Field("viscous", "Nm s/rad (N s/m), viscous friction", ("friction", "viscous"), "not negative"),
    Field("viscous_std", "Nm s/rad (N s/m)", ("viscous_std",), "not negative"),
    Field("hysteresis", "share of a change of torque that gears keep back", ("hysteresis",), "not negative"),
    Field("hysteresis_std", "share", ("hysteresis_std",), "not negative"),
    Field("hysteresis_width", "Nm (N), where it levels off", ("hysteresis_width",), "not negative"),
    Field("armature", "kg m^2 (kg), rotor inertia behind the gear", ("armature",), "not negative"),
    Field("armature_std", "kg m^2 (kg)", ("armature_std",), "not negative"),
    Field("residual", "Nm (N), root mean square on held-out blocks", ("residual",), "not negative"),
)
NOISE_FIELDS = (
    Field("torque", "Nm (N), white, per sample", ("noise", "torque"), "not negative"),
    Field("velocity", "rad/s (m/s), white, per sample", ("noise", "velocity"), "not negative"),
    Field("relative", "share of the contact's own torque", ("noise", "relative"), "not negative"),
    Field("model", "Nm (N), slow errors left over", ("noise", "model"), "not negative"),
    Field("model_time", "s, time over which these change", ("noise", "model_time"), "not negative"),
    Field("friction", "Nm (N), of friction at starts and stops", ("noise", "friction"), "not negative"),
    Field("bias", "Nm (N), from one start to the next", ("noise", "bias"), "not negative"),
)
ROBOT_FIELDS = (
    Field("inertial_change", "share by which inertias may differ", ("inertial_change",), "not negative"),
    Field("velocity_delay", "s, of the velocity against the position", ("velocity_delay",), "not negative"),
    Field("torque_delay", "s, of the torque against the position", ("torque_delay",), "not negative"),
    Field("false_alarms_per_hour", "1/h", ("false_alarms_per_hour",), "positive"),
)
# How Coulomb friction changes its sign.
REVERSALS = {"velocity": "rad/s (m/s)", "displacement": "rad (m)"}
# Entries with a form of their own.
OTHER_CONTENT = {
    "robot",
    "fingerprint",
    "joints",
    "torque_is_external",
    "bodies",
    "payload",
    "sensor_offsets",
    "contacts",
    "tails",
    "notes",
}


def content_keys() -> set[str]:
    """The keys of the core's content that a file holds."""
    fields = (*JOINT_FIELDS, *NOISE_FIELDS, *ROBOT_FIELDS)
    return OTHER_CONTENT | {field.path[0] for field in fields}


def nameless(joint: str) -> str:
    """What the inertia behind a joint is called where the joint moves no link with a name."""
    return f"(joint {joint})"
