"""contactsense: a robot's sense of touch over its whole body from what it already measures."""

from ._core import (
    Candidate,
    ClosestPoints,
    Contact,
    ContactIsolator,
    ContactMonitor,
    ContactReport,
    Isolation,
    MomentumObserver,
    RayHits,
    Surface,
    SurfaceSamples,
    build_profile,
)
from .errors import ContactSenseError, GeometryError, InputError, ModelError
from .robot import Robot

__version__ = "0.1.0"

__all__ = [
    "Candidate",
    "ClosestPoints",
    "Contact",
    "ContactIsolator",
    "ContactMonitor",
    "ContactReport",
    "ContactSenseError",
    "GeometryError",
    "InputError",
    "Isolation",
    "ModelError",
    "MomentumObserver",
    "RayHits",
    "Robot",
    "Surface",
    "SurfaceSamples",
    "build_profile",
]
