"""The one place that imports MuJoCo, an optional dependency."""

try:
    import mujoco
except ImportError as error:
    raise ImportError("contactsense.sim needs MuJoCo: pip install contactsense[sim]") from error

__all__ = ["mujoco"]
