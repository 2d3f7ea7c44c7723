"""Mesh files come from the URDF's folder and the package folders, nowhere else."""

import os
from pathlib import Path

import numpy as np
import pytest
from described import describe_urdf
from urdf_text import SOLID, joint, link, robot, shape, write

from contactsense import Robot, _core
from contactsense.errors import GeometryError, InputError, ModelError

FILES = ("arm/meshes/in.stl", "share/pkg/meshes/in.STL", "share/pkg/in.obj", "outside/secret.stl")
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])


def mesh_text(path: Path, size: float) -> str:
    """A tetrahedron, by whose size a file is known."""
    corners = size * CORNERS
    if path.suffix == ".obj":
        return "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(
            f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES
        )
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {} {} {}\n".format(*corners[i]) for i in face)
        + "endloop\nendfacet\n"
        for face in FACES
    )
    return f"solid part\n{facets}endsolid part\n"


@pytest.fixture
def site(tmp_path):
    """A URDF folder, a package folder and a file outside both."""
    for size, name in enumerate(FILES, start=1):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(mesh_text(tmp_path / name, size))
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
        ("package://elsewhere/meshes/in.stl", "arm/meshes/in.stl"),
    ],
)
def test_file_is_found(site, filename, found):
    shape = load(site, filename.format(site=site), [site / "share"], "1 -1 0.5")
    vertices, _ = shape.params
    assert shape.kind == "mesh"
    np.testing.assert_allclose(np.ptp(vertices, axis=0), (FILES.index(found) + 1) * np.array([1, 1, 0.5]))


def test_package_folder_may_be_the_package_itself(site):
    for package_dirs in ([str(site / "share" / "pkg")], str(site / "share" / "pkg"), site / "share"):
        vertices, _ = load(site, "package://pkg/in.obj", package_dirs).params
        np.testing.assert_allclose(np.ptp(vertices, axis=0), [3, 3, 3])


@pytest.mark.parametrize("scheme", ["", "file://"])
@pytest.mark.parametrize("read", [Robot.from_urdf, _core._robot_from_urdf], ids=["package", "core"])
def test_path_of_another_machine_is_found_by_its_end(site, read, scheme):
    # Two files of that name: the one whose path agrees over more folders is taken.
    (site / "share/other/meshes").mkdir(parents=True)
    (site / "share/other/meshes/in.STL").write_text(mesh_text(Path("in.STL"), 9))
    mesh = f'<mesh filename="{scheme}/home/somebody/ws/src/pkg/meshes/in.STL"/>'
    urdf = write(site / "arm", robot(link("a", SOLID + shape(mesh))))
    found = read(urdf, package_dirs=[site / "share"])
    assert found.surface("a").area == pytest.approx(4 * (1.5 + np.sqrt(0.75)))
    (warning,) = [text for text in found.warnings if "in.STL" in text]
    assert str(site / "share/pkg/meshes/in.STL") in warning
    # Never a file outside, by whatever path.
    outside = write(site / "arm", robot(link("a", SOLID + shape(mesh.replace("in.STL", "secret.stl")))))
    with pytest.raises(GeometryError, match=r"secret.stl"):
        read(outside, package_dirs=[site / "share"])


@pytest.mark.parametrize("read", [Robot.from_urdf, _core._robot_from_urdf], ids=["package", "core"])
def test_missing_mesh_may_be_left_out(site, read):
    body = shape('<mesh filename="package://nowhere/none.stl"/>')
    ball = shape('<sphere radius="1"/>')
    text = robot(link("a", SOLID + body), link("b", SOLID + body + ball), joint("j", "a", "b"))
    urdf = write(site / "arm", text)
    with pytest.raises(GeometryError, match=r"link 'a'.*none.stl"):
        read(urdf)
    found = read(urdf, missing_meshes="warn")
    assert found.link_names == ("b",)
    missing = [text for text in found.warnings if "none.stl" in text]
    assert [text.split(":")[0] for text in missing] == ["link 'a'", "link 'b'"]
    with pytest.raises(InputError, match="missing_meshes: must be 'error' or 'warn', not 'ignore'"):
        read(urdf, missing_meshes="ignore")


@pytest.mark.parametrize(
    "filename",
    [
        "../outside/secret.stl",
        "{site}/outside/secret.stl",
        "file://{site}/outside/secret.stl",
        "package://../outside/secret.stl",
        "package://pkg/../../outside/secret.stl",
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
    with pytest.raises(GeometryError, match="was not found"):
        load(site, f"package://pkg/{site}/outside/secret.stl", [site / "share"])
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
