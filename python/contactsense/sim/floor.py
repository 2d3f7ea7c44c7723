"""The ground under a robot that stands."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass

from ._arrays import not_negative, positive
from ._text import text

# Contact masks: what stands on the floor meets the floor, and nothing else.
FLOOR_TYPE = 1


@dataclass(frozen=True)
class Floor:
    """A level floor at height zero, for geoms whose `conaffinity` has bit `FLOOR_TYPE`.

    The contact gives way a little, as a sole does: a penetration fades like a damped spring.
    """

    friction: float = 1.0  # coefficient
    time_constant: float = 0.02  # of the fading [s]; at least twice the simulation step
    damping_ratio: float = 1.0

    def __post_init__(self) -> None:
        not_negative("friction", self.friction)
        positive("time_constant", self.time_constant)
        positive("damping_ratio", self.damping_ratio)

    def write(self, root: ET.Element, world: ET.Element) -> None:
        """Add the floor to `<worldbody>`, and to `<option>` what keeps feet from creeping."""
        option = root.find("option")
        assert option is not None
        # Pyramidal cones, and friction as soft as the normal force, let a standing foot slide slowly.
        option.set("cone", "elliptic")
        option.set("impratio", "100")
        floor = ET.SubElement(world, "geom", name="floor", type="plane", size="0 0 1")
        floor.set("friction", text([self.friction, 0.0, 0.0]))
        floor.set("solref", text([self.time_constant, self.damping_ratio]))
        floor.set("priority", "1")
        floor.set("contype", str(FLOOR_TYPE))
        floor.set("conaffinity", "0")
