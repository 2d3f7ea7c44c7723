"""Messages with the fields that the node uses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from geometry_msgs.msg import Header


@dataclass
class JointState:
    header: Header = field(default_factory=Header)
    name: Sequence[str] = ()
    position: Sequence[float] = ()
    velocity: Sequence[float] = ()
    effort: Sequence[float] = ()
