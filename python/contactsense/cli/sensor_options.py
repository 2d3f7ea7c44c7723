"""Options of commands on logs with force/torque sensors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

import typer

from .._core import ForceTorqueSensor
from ..errors import InputError

SensorOption = Annotated[
    list[str] | None,
    typer.Option(
        "--sensor",
        metavar="[NAME=]LINK[@TOPIC]",
        help="Force/torque sensor where LINK joins its parent, in the frame of LINK; may be repeated. "
        "TOPIC, or a pattern of columns such as 'ft_*', says where its readings are; else names tell.",
    ),
]
ConventionOption = Annotated[
    str,
    typer.Option(
        "--sensor-convention",
        help="What sensors read: load (of a free hand at rest its weight) or support (the opposite).",
    ),
]
WantedOption = Annotated[
    list[str] | None,
    typer.Option(
        "--wanted", help="Name of a sensor whose contacts are meant, as those of feet; may be repeated."
    ),
]


def sensors_of(given: Sequence[str] | None, convention: str) -> dict[ForceTorqueSensor, str | None]:
    """The sensors, and where their readings are.

    Raises:
        InputError: a text has no link, or there is no such convention.
    """
    meant: Literal["load", "support"]
    if convention == "load":
        meant = "load"
    elif convention == "support":
        meant = "support"
    else:
        raise InputError(f"sensor-convention: must be load or support, not {convention!r}")
    found: dict[ForceTorqueSensor, str | None] = {}
    for text in given or ():
        place, _, topic = text.partition("@")
        name, _, link = place.rpartition("=")
        if not link:
            raise InputError(f"sensor: must be LINK, NAME=LINK or NAME=LINK@TOPIC, not '{text}'")
        found[ForceTorqueSensor(name or link, link, convention=meant)] = topic or None
    return found
