"""Plain values as messages of ROS 2."""

from __future__ import annotations

from typing import Any

from ..offline.ros_messages import Marker, Messages
from .values import Drawing, Drawings, ExternalTorque, Health, LinkWrench, Output

_NAME = "contactsense"


def message_of(messages: Messages, output: Output) -> Any:
    """The message of an output, made of the types of `messages`."""
    match output:
        case ExternalTorque():
            return messages.joint_state(output.stamp, output.names, effort=output.torque, frame="")
        case LinkWrench():
            return messages.wrench(output.stamp, output.link, output.wrench.tolist())
        case Drawings():
            return messages.markers([_marker(messages, output, it) for it in output.drawings])
        case Health():
            return messages.diagnostics(
                output.stamp,
                output.level,
                f"{_NAME}: contacts",
                output.message,
                output.robot,
                output.values,
            )


def _marker(messages: Messages, drawings: Drawings, drawing: Drawing) -> Any:
    return messages.marker(
        drawings.stamp,
        drawing.number,
        drawing.shape,
        drawing.points,
        drawing.scale,
        drawings.lifetime,
        frame=drawings.frame,
        namespace=drawing.namespace,
        colour=drawing.colour,
        text=drawing.text,
        action=Marker.ADD if len(drawing.points) else Marker.DELETE,
    )
