"""Programs in C get the answers of the Python package, and wrong calls are refused."""

from __future__ import annotations

import os
import shutil
import subprocess
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

import contactsense as cs

ROOT = Path(__file__).parents[1]
CAPI = ROOT / "rust" / "capi"
FLAGS = ["-Wall", "-Wextra", "-Werror", "-O1", "-I", str(CAPI / "include")]
# What the standard library of Rust needs of the system.
SYSTEM = ["-lpthread", "-ldl", "-lm"]
DT, TICKS, PUSHED = 0.001, 500, 150


@pytest.fixture(scope="module")
def library() -> Path:
    """The folder with the library."""
    subprocess.run(
        ["cargo", "build", "--release", "--quiet", "-p", "contactsense-capi"], cwd=ROOT, check=True
    )
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"


@pytest.fixture(scope="module")
def urdf() -> Path:
    with resources.as_file(resources.files("contactsense") / "descriptions" / "iiwa14.urdf") as path:
        return path


def compiled(source: Path, library: Path, folder: Path) -> Path:
    program = folder / source.stem
    archive = library / "libcontactsense_c.a"
    command = ["cc", "-std=c11", *FLAGS, str(source), str(archive), *SYSTEM, "-o", str(program)]
    subprocess.run(command, check=True)
    return program


def rows(robot: cs.Robot) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A moving arm with noise that is pushed at its sixth link."""
    rng = np.random.default_rng(3)
    phase = np.arange(TICKS)[:, None] * DT + np.arange(7)
    q, v, a = 0.4 * np.sin(phase), 0.4 * np.cos(phase), -0.4 * np.sin(phase)
    tau = np.array([robot.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)])
    tau += rng.normal(0.0, 0.1, tau.shape)
    place = robot.surface("iiwa_link_6").closest_points([[0.1, 0.2, 0.1]])
    for tick in range(PUSHED, TICKS):
        pose = robot.link_pose(q[tick], "iiwa_link_6")
        point = pose[:3, :3] @ place.points[0] + pose[:3, 3]
        force = -30.0 * pose[:3, :3] @ place.normals[0]
        tau[tick] -= robot.jacobian(q[tick], "iiwa_link_6", point)[:3].T @ force
    return q, v, tau


def test_a_program_in_c_says_what_the_monitor_says(library: Path, urdf: Path, tmp_path: Path) -> None:
    robot = cs.Robot.named("iiwa14")
    q, v, tau = rows(robot)
    np.hstack([q, v, tau]).tofile(tmp_path / "rows.bin")
    program = compiled(CAPI / "c_examples" / "replay.c", library, tmp_path)
    done = subprocess.run(
        [program, urdf, tmp_path / "rows.bin"], capture_output=True, text=True, timeout=120, check=True
    )
    assert done.stderr == ""
    monitor = cs.ContactMonitor(cs.Robot.from_urdf(urdf), dt=DT, torque_threshold=0.6)
    expected, placed = [], 0
    for tick, row in enumerate(zip(q, v, tau, strict=True)):
        report = monitor.update(*row)
        expected.append(["tick", tick, int(report.collision), int(report.onset), *report.external_torque])
        for it in report.contacts:
            known = -1 if it.id is None else it.id
            numbers = [*it.point, *it.force, it.probability, it.region_radius]
            expected.append(["contact", it.link, int(it.located), known, *numbers])
            placed += bool(np.isfinite(it.point).all())
    printed = [line.split() for line in done.stdout.splitlines()]
    assert len(printed) == len(expected)
    for line, wanted in zip(printed, expected, strict=True):
        assert line[:4] == [str(word) for word in wanted[:4]]
        found = np.array([float.fromhex(number) for number in line[4:]])
        # Python reads the URDF by Pinocchio and C by urdf-rs, which round rotations differently.
        np.testing.assert_allclose(found, np.array(wanted[4:], dtype=float), rtol=1e-6, atol=1e-9)
    assert placed > 200


def test_wrong_calls_are_refused(library: Path, urdf: Path, tmp_path: Path) -> None:
    program = compiled(CAPI / "tests" / "wrong_calls.c", library, tmp_path)
    done = subprocess.run([program, urdf], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (0, "all refused\n"), done.stdout


def test_valgrind_finds_nothing(library: Path, urdf: Path, tmp_path: Path) -> None:
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed")
    program = compiled(CAPI / "tests" / "wrong_calls.c", library, tmp_path)
    command = ["valgrind", "--quiet", "--error-exitcode=9", "--leak-check=full", program, urdf]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr


def test_the_header_is_that_of_cpp_too(tmp_path: Path) -> None:
    source = tmp_path / "it.cpp"
    source.write_text('#include "contactsense.h"\nint main() { return cs_robot_nq(nullptr) != 0; }\n')
    for standard in ("c++11", "c++17", "c++20"):
        command = ["c++", f"-std={standard}", *FLAGS, "-fsyntax-only", str(source)]
        subprocess.run(command, check=True)
