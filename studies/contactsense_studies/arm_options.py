"""Options of studies on one arm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option


@dataclass(frozen=True)
class ArmOptions:
    """The arm, and its links that are touched."""

    robot: Annotated[str, Option(help="A packaged arm, or a URDF file.")] = "iiwa14"
    package_dirs: Annotated[
        tuple[str, ...], Option("--package-dir", help="Folder for `package://` names; may be repeated.")
    ] = ()
    links: Annotated[
        tuple[str, ...], Option("--link", help="Link in contact; may be repeated (default: all that move).")
    ] = ()
