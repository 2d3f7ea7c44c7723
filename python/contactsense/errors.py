"""The errors this library raises: one root, one class per kind of cause."""

from ._core import ContactSenseError, GeometryError, InputError, ModelError

__all__ = ["ContactSenseError", "GeometryError", "InputError", "ModelError"]
