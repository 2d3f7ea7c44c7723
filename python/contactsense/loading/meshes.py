"""Where a URDF's mesh files are, and which files it may name."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from ..errors import GeometryError, InputError

MESH_SUFFIXES = (".stl", ".obj", ".dae")

PackageDirs = str | os.PathLike[str] | Iterable[str | os.PathLike[str]]


class MeshFinder:
    """Resolves one URDF's mesh file names to files inside its folder or the package folders, nowhere else."""

    def __init__(self, urdf: Path, package_dirs: PackageDirs = ()) -> None:
        """Raise `InputError` where `package_dirs` is not a path or paths."""
        try:
            given = [package_dirs] if isinstance(package_dirs, str | os.PathLike) else list(package_dirs)
            folders = [(Path(entry).absolute().name, Path(entry).resolve()) for entry in given]
        except (TypeError, ValueError, OSError, RuntimeError) as cause:
            raise InputError(
                f"package_dirs: must be a folder or folders that hold packages: {cause}"
            ) from cause
        self._folder = urdf.parent.resolve()
        # A package's name is that of its folder, also where a link leads to it.
        self._packages = [*folders, (self._folder.name, self._folder)]

    def find(self, filename: str, link: str) -> Path:
        """The file that `filename` means in `link`; `GeometryError` where missing, outside or no mesh."""
        owner = f"link '{link}': mesh '{filename}'"
        if not filename.lower().endswith(MESH_SUFFIXES):
            raise GeometryError(f"{owner} is of an unknown kind; supported: {', '.join(MESH_SUFFIXES)}")
        allowed = list(dict.fromkeys([self._folder, *(folder for _, folder in self._packages)]))
        inside: list[Path] = []
        for candidate in self._candidates(filename, owner):
            try:
                path = candidate.resolve()
                if any(path.is_relative_to(folder) for folder in allowed):
                    if path.is_file():
                        return path
                    inside.append(path)
            except (OSError, ValueError, RuntimeError) as cause:
                raise GeometryError(f"{owner} is not a usable file name: {cause}") from cause
        if inside:
            raise GeometryError(f"{owner} was not found; looked for {_listing(inside)} (see package_dirs)")
        raise GeometryError(
            f"{owner} lies outside the folders it may come from, {_listing(allowed)}; "
            "move it there or add its folder to package_dirs"
        )

    def _candidates(self, filename: str, owner: str) -> list[Path]:
        scheme, separator, rest = filename.partition("://")
        if not separator:
            return [self._folder / filename]
        if scheme == "file":
            return [self._folder / rest]
        if scheme != "package":
            raise GeometryError(
                f"{owner} has the unknown scheme '{scheme}://'; supported: package://, file://, a path"
            )
        # "package:///pkg/file" is seen in the wild.
        package, _, inner = rest.lstrip("/").partition("/")
        candidates: list[Path] = []
        for name, folder in self._packages:
            candidates.append(folder / package / inner)
            if package in (name, folder.name):
                candidates.append(folder / inner.lstrip("/"))
        return candidates


def _listing(paths: list[Path]) -> str:
    return ", ".join(f"'{path}'" for path in paths)
