"""Mesh files come from the URDF's folder and the package folders, nowhere else."""

import os
from pathlib import Path

import numpy as np
import pytest
from urdf_text import SOLID, link, robot, shape, write

from contactsense import Robot, _core
from contactsense.errors import GeometryError, ModelError
from contactsense.loading.describe_urdf import describe_urdf


@pytest.fixture
def site(tmp_path):
    """A URDF folder, a package folder and a file outside both."""
    for name in ("arm/meshes/in.stl", "share/pkg/meshes/in.STL", "share/pkg/in.obj", "outside/secret.stl"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("solid")
    return tmp_path


def load(site, filename, package_dirs=(), scale=None):
    attributes = f'filename="{filename}"' + (f' scale="{scale}"' if scale else "")
    text = robot(link("a", SOLID + shape(f"<mesh {attributes}/>")))
    description = describe_urdf(write(site / "arm", text), package_dirs=package_dirs)
    return description.links[0].geometry[0]


@pytest.mark.parametrize(
    ("filename", "found"),
    [
        ("meshes/in.stl", "arm/meshes/in.stl"),
        ("./meshes/../meshes/in.stl", "arm/meshes/in.stl"),
        ("file://meshes/in.stl", "arm/meshes/in.stl"),
        ("file://{site}/arm/meshes/in.stl", "arm/meshes/in.stl"),
        ("{site}/arm/meshes/in.stl", "arm/meshes/in.stl"),
        ("{site}/share/pkg/in.obj", "share/pkg/in.obj"),
        ("package://pkg/meshes/in.STL", "share/pkg/meshes/in.STL"),
        ("package:///pkg/in.obj", "share/pkg/in.obj"),
        ("package://meshes/in.stl", "arm/meshes/in.stl"),
        ("package://arm/meshes/in.stl", "arm/meshes/in.stl"),
    ],
)
def test_file_is_found(site, filename, found):
    shape = load(site, filename.format(site=site), [site / "share"], "1 -1 0.001")
    path, scale = shape.params
    assert (shape.kind, path) == ("mesh_file", str((site / found).resolve()))
    np.testing.assert_array_equal(scale, [1, -1, 0.001])


def test_package_folder_may_be_the_package_itself(site):
    for package_dirs in ([str(site / "share" / "pkg")], str(site / "share" / "pkg"), site / "share"):
        path, scale = load(site, "package://pkg/in.obj", package_dirs).params
        assert path == str((site / "share/pkg/in.obj").resolve())
        np.testing.assert_array_equal(scale, [1, 1, 1])


@pytest.mark.parametrize(
    "filename",
    [
        "../outside/secret.stl",
        "{site}/outside/secret.stl",
        "file://{site}/outside/secret.stl",
        "package://../outside/secret.stl",
        "package://pkg/../../outside/secret.stl",
        "package://pkg/{site}/outside/secret.stl",
        "meshes/link.stl",
        "meshes/folder/secret.stl",
        "../outside/none.stl",
    ],
)
def test_file_outside_is_refused(site, filename):
    (site / "arm/meshes/link.stl").symlink_to(site / "outside/secret.stl")
    (site / "arm/meshes/folder").symlink_to(site / "outside")
    with pytest.raises(
        GeometryError, match=r"link 'a': mesh '.*stl' lies outside .*/arm'.*/share'"
    ) as caught:
        load(site, filename.format(site=site), [site / "share"])
    assert "package_dirs" in str(caught.value)


def test_missing_file_says_where_it_was_looked_for(site):
    with pytest.raises(
        GeometryError, match=r"mesh 'package://pkg/none.stl' was not found.*share/pkg/none.stl"
    ):
        load(site, "package://pkg/none.stl", [site / "share"])
    with pytest.raises(GeometryError, match=r"mesh 'meshes/none.stl' was not found.*arm/meshes/none.stl"):
        load(site, "meshes/none.stl")
    (site / "arm/folder.stl").mkdir()
    with pytest.raises(GeometryError, match="was not found"):
        load(site, "folder.stl")


@pytest.mark.parametrize(
    "filename", ["a.step", "meshes", "http://host/a.stl", "model://a.stl", "x" * 5000 + ".stl"]
)
def test_unusable_name_is_refused(site, filename):
    with pytest.raises(GeometryError, match="link 'a': mesh '"):
        load(site, filename)


def test_loop_of_links_is_refused(site):
    (site / "arm/loop.stl").symlink_to(site / "arm/loop.stl")
    with pytest.raises(GeometryError, match=r"loop.stl"):
        load(site, "loop.stl")


def _no_end(folder: Path, kind: str) -> list[Path]:
    """Files whose reading would not end: a device, a pipe, and one of 20 GB that takes no space."""
    pipe, sparse = folder / f"pipe{kind}", folder / f"sparse{kind}"
    os.mkfifo(pipe)
    with sparse.open("wb") as file:
        file.truncate(20_000_000_000)
    return [Path("/dev/zero"), pipe, sparse, folder]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with names")
@pytest.mark.parametrize("read", [Robot.from_urdf, _core._robot_from_urdf], ids=["package", "core"])
def test_files_without_end_are_refused(read, tmp_path):
    for path in _no_end(tmp_path, ".urdf"):
        with pytest.raises(ModelError, match=r"(regular file|at most|was not found|directory)"):
            read(path)
    meshes = tmp_path / "arm"
    meshes.mkdir()
    device = meshes / "device.stl"
    device.symlink_to("/dev/zero")
    endless = [path for kind in (".stl", ".obj", ".dae") for path in _no_end(meshes, kind)[1:3]]
    for mesh in (device, *endless):
        urdf = write(meshes, robot(link("a", SOLID + shape(f'<mesh filename="{mesh.name}"/>'))))
        with pytest.raises(GeometryError, match=mesh.name):
            read(urdf, package_dirs=["/dev"])
