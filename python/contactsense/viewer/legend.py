"""What the colours of a page mean."""

from __future__ import annotations

from collections.abc import Iterable

from .._pictures import ESTIMATE, NAMED, UNSURE
from .sensor_rings import COLOUR
from .stage import HEAT, PURPLE


def legend(*, has_sensors: bool, has_particles: bool) -> str:
    """A list of colours as HTML."""
    lines = [
        (NAMED, "link in contact"),
        (ESTIMATE, "force, point and 90 % region of a located contact"),
        (UNSURE, "the same where the contact is not located"),
        (_gradient(HEAT), "where the torques allow a contact, from unlikely to likely"),
    ]
    lines += [(_rgb(COLOUR), "force/torque sensor, and the external force it measures")] * has_sensors
    lines += [(_gradient(PURPLE), "particles, from little to much weight")] * has_particles
    rows = "".join(
        f'<div style="display:flex;align-items:center;margin:3px 0"><span style="flex:none;width:28px;'
        f'height:12px;margin-right:8px;border-radius:2px;background:{colour}"></span>{text}</div>'
        for colour, text in lines
    )
    return f'<div style="font-size:12px;color:#444;padding:8px">{rows}</div>'


def _gradient(ends: Iterable[Iterable[float]]) -> str:
    return f"linear-gradient(90deg,{','.join(map(_rgb, ends))})"


def _rgb(colour: Iterable[float]) -> str:
    return f"rgb({','.join(str(round(each)) for each in colour)})"
