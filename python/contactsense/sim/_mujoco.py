"""The one place that imports MuJoCo, an optional dependency."""

from .._extras import MissingExtraError

try:
    import mujoco
except ImportError as error:
    raise MissingExtraError("mujoco", "sim") from error

__all__ = ["mujoco"]
