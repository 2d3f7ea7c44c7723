"""Meshes of packages are found without an option where a ROS package or a workspace says where they are."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from log_files import arm, named_columns, pushed, write_csv

from contactsense.cli.app import run
from contactsense.robot import description_file

LINK = re.compile(r'<link name="(\w+)">.*?</link>', re.DOTALL)
SHAPES = re.compile(r"\s*<(visual|collision)>.*?</\1>", re.DOTALL)


def write_stl(path: Path, link: str) -> None:
    surface = arm().surface(link)
    records = np.zeros(
        len(surface.triangles), dtype=[("normal", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")]
    )
    records["v"] = surface.vertices[surface.triangles]
    path.write_bytes(bytes(80) + np.uint32(len(records)).tobytes() + records.tobytes())


def write_package(urdf: Path, meshes: Path, prefix: str = "package://my_arm/meshes/") -> Path:
    """The iiwa14 with meshes in place of its shapes, named by `prefix`."""
    for folder in (urdf.parent, meshes):
        folder.mkdir(parents=True, exist_ok=True)

    def with_mesh(found: re.Match[str]) -> str:
        write_stl(meshes / f"{found[1]}.stl", found[1])
        mesh = f'<geometry><mesh filename="{prefix}{found[1]}.stl"/></geometry>'
        return SHAPES.sub("", found[0]).replace("</link>", f"<collision>{mesh}</collision></link>")

    urdf.write_text(LINK.sub(with_mesh, description_file("iiwa14").read_text()))
    return urdf


@pytest.fixture
def log(tmp_path: Path) -> Path:
    words = {"position": "pos", "velocity": "vel", "torque": "effort"}
    columns = named_columns(pushed(), arm().joint_names, words)
    return write_csv(tmp_path / "pushed.csv", {"time": pushed().time, **columns})


def told(log: Path, urdf: Path, capsys: pytest.CaptureFixture[str], *more: str) -> tuple[int, str, str]:
    code = run(["replay", str(log), "--robot", str(urdf), "--threshold", "0.6", *more])
    return code, *capsys.readouterr()


def test_beside_the_urdf(log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    urdf = write_package(tmp_path / "download" / "arm.urdf", tmp_path / "download" / "meshes")
    code, out, err = told(log, urdf, capsys)
    assert (code, "iiwa_link_7" in out, "not found" in err) == (0, True, False)


def test_in_the_package_of_the_urdf(log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    package = tmp_path / "src" / "my_arm"
    urdf = write_package(package / "urdf" / "arm.urdf", package / "meshes")
    # A folder of this name need not be a package: files elsewhere are not read.
    assert "meshes of 8 links were not found, such as 'package://my_arm/" in told(log, urdf, capsys)[2]
    (package / "package.xml").write_text("<package/>")
    code, out, err = told(log, urdf, capsys)
    assert (code, "iiwa_link_7" in out, "not found" in err) == (0, True, False)


@pytest.mark.parametrize(("variable", "below"), [("ROS_PACKAGE_PATH", "src"), ("AMENT_PREFIX_PATH", "share")])
def test_in_the_workspace(
    log: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    variable: str,
    below: str,
) -> None:
    urdf = write_package(tmp_path / "arm.urdf", tmp_path / below / "my_arm" / "meshes")
    named = tmp_path / below if variable == "ROS_PACKAGE_PATH" else tmp_path
    monkeypatch.setenv(variable, f"{tmp_path / 'nowhere'}:{named}")
    code, out, err = told(log, urdf, capsys)
    assert (code, "iiwa_link_7" in out, "not found" in err) == (0, True, False)


def test_a_robot_without_surface_is_not_drawn(
    log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    urdf = write_package(tmp_path / "arm.urdf", tmp_path / "elsewhere")
    code, out, err = told(log, urdf, capsys, "--png", str(tmp_path / "a.png"))
    assert (code, out) == (2, "")
    assert err.endswith(
        "contactsense: png: the robot has no surface that could be drawn; see --package-dir and --geometry\n"
    )
