"""The errors this library raises: one root, one class per kind of cause."""


class ContactSenseError(Exception):
    """Root of every error this library raises on purpose."""


class ModelError(ContactSenseError):
    """The robot's description (URDF or Pinocchio model) cannot be used; the message names the element."""


class GeometryError(ContactSenseError):
    """A mesh or shape of the robot's surface cannot be used; the message names the link or file."""


class InputError(ContactSenseError, ValueError):
    """An argument of a call is wrong; the message names it and says what would be right.

    The object's state is as it was before the call.
    """
