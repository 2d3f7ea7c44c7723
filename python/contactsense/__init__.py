"""contactsense: a robot's sense of touch over its whole body from what it already measures."""

from ._core import (
    Candidate,
    ClosestPoints,
    Contact,
    ContactIsolator,
    ContactMonitor,
    ContactReport,
    ForceTorqueSensor,
    Isolation,
    LoadCompensator,
    MomentumObserver,
    RayHits,
    Surface,
    SurfaceSamples,
    __version__,
    build_profile,
)
from .errors import ContactSenseError, GeometryError, InputError, ModelError
from .robot import Robot

__all__ = [
    "Candidate",
    "ClosestPoints",
    "Contact",
    "ContactIsolator",
    "ContactMonitor",
    "ContactReport",
    "ContactSenseError",
    "ForceTorqueSensor",
    "GeometryError",
    "InputError",
    "Isolation",
    "LoadCompensator",
    "ModelError",
    "MomentumObserver",
    "RayHits",
    "Robot",
    "Surface",
    "SurfaceSamples",
    "__version__",
    "build_profile",
]
