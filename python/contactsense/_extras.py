"""Optional parts of the installation."""

from __future__ import annotations

from importlib import import_module

from .errors import ContactSenseError


class MissingExtraError(ContactSenseError, ImportError):
    """A package of an optional part is not installed; the message says how to install it.

    `extra` names the part; without one, the package is installed by its own name.
    """

    def __init__(self, package: str, extra: str | None = None) -> None:
        wanted = f"'contactsense[{extra}]'" if extra else package
        super().__init__(f"{package} is not installed; get it with: pip install {wanted}")


def require(extra: str, *packages: str) -> None:
    """Raises `MissingExtraError` for the first of the part's packages that is not installed."""
    for package in packages:
        try:
            import_module(package)
        except ModuleNotFoundError as missing:
            raise MissingExtraError(package, extra) from missing
