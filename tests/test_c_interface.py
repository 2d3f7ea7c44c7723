"""Programs in C get the answers of the Python package, and wrong calls are refused."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

import contactsense as cs
from contactsense import _core

ROOT = Path(__file__).parents[1]
CAPI = ROOT / "rust" / "capi"
EXAMPLES, PROGRAMS = CAPI / "c_examples", CAPI / "tests"
FLAGS = ["-Wall", "-Wextra", "-Werror", "-O1", "-I", str(CAPI / "include")]
# What the standard library of Rust needs of the system.
SYSTEM = ["-lpthread", "-ldl", "-lm"]
DT, TICKS, PUSHED = 0.001, 500, 150


@dataclass(frozen=True)
class Pushed:
    """What programs are given, and the same in numbers."""

    urdf: Path
    rows: Path
    calibration: Path
    q: np.ndarray
    v: np.ndarray
    tau: np.ndarray

    def reports(self, dt: float | None = None) -> list[cs.ContactReport]:
        """What Python says of a robot that is read as C reads it: its own reader rounds differently."""
        robot, calibration = _core._robot_from_urdf(self.urdf), cs.Calibration.load(self.calibration)
        monitor = cs.ContactMonitor(robot, dt=DT, calibration=calibration)
        return [monitor.update(*row, dt=dt) for row in zip(self.q, self.v, self.tau, strict=True)]


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


def compiled(source: Path, library: Path, folder: Path, *flags: str) -> Path:
    program = folder / source.stem
    compiler = ["cc", "-std=c11"] if source.suffix == ".c" else ["c++", "-std=c++17"]
    archive = library / "libcontactsense_c.a"
    subprocess.run(
        [*compiler, *FLAGS, *flags, str(source), str(archive), *SYSTEM, "-o", str(program)], check=True
    )
    return program


def printed(program: Path, *arguments: Path) -> list[list[str]]:
    """The words of each line that a program prints."""
    done = subprocess.run([program, *arguments], capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return [line.split() for line in done.stdout.splitlines()]


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


@pytest.fixture(scope="module")
def pushed(urdf: Path, tmp_path_factory: pytest.TempPathFactory) -> Pushed:
    """Rows of a log, in a file, with a calibration that knows of bias and noise."""
    folder = tmp_path_factory.mktemp("pushed")
    robot = _core._robot_from_urdf(urdf)
    q, v, tau = rows(robot)
    bias = np.linspace(-0.4, 0.4, 7)
    np.hstack([q, v, tau + bias]).tofile(folder / "rows.bin")
    content = json.loads(cs.Calibration.of_description(robot)._content())
    content |= {"torque_bias": bias.tolist()}
    content["noise"] |= {"torque": [0.1], "model": [0.05]}
    calibration = cs.Calibration(json.dumps(content))
    calibration.save(folder / "arm.yaml")
    pushed = Pushed(urdf, folder / "rows.bin", folder / "arm.yaml", q, v, tau + bias)
    assert not any(report.collision for report in pushed.reports()[:PUSHED])
    return pushed


def test_a_program_in_c_says_what_the_monitor_says(library: Path, pushed: Pushed, tmp_path: Path) -> None:
    """Bit for bit."""
    program = compiled(EXAMPLES / "replay.c", library, tmp_path)
    expected, placed = [], 0
    for tick, report in enumerate(pushed.reports()):
        expected.append(["tick", tick, int(report.collision), int(report.onset), *report.external_torque])
        for it in report.contacts:
            known = -1 if it.id is None else it.id
            numbers = [*it.point, *it.force, it.probability, it.region_radius]
            expected.append(["contact", it.link, int(it.located), known, *numbers])
            placed += bool(np.isfinite(it.point).all())
    found = printed(program, pushed.urdf, pushed.rows, pushed.calibration)
    assert len(found) == len(expected)
    for line, wanted in zip(found, expected, strict=True):
        assert line[:4] == [str(word) for word in wanted[:4]]
        np.testing.assert_array_equal([float.fromhex(number) for number in line[4:]], wanted[4:])
    assert placed > 200


def test_a_loop_of_libfranka_stops_at_the_contact(library: Path, pushed: Pushed, tmp_path: Path) -> None:
    stand_ins = ["-I", str(PROGRAMS / "stand_ins")]
    program = compiled(EXAMPLES / "libfranka_callback.cpp", library, tmp_path, *stand_ins)
    first, *contacts = printed(program, pushed.rows, pushed.urdf, pushed.calibration)
    (report,) = (report for report in pushed.reports(DT) if report.onset)
    assert first == f"contact at {report.time:.3f} s, 0 samples refused".split()
    assert [line[0].rstrip(",") for line in contacts] == [contact.link for contact in report.contacts]


def test_a_controller_of_ros2_control_publishes_the_contact(
    library: Path, pushed: Pushed, tmp_path: Path
) -> None:
    stand_ins = ["-I", str(PROGRAMS / "stand_ins")]
    program = compiled(PROGRAMS / "broadcaster.cpp", library, tmp_path, *stand_ins)
    done = subprocess.run(
        [program, pushed.urdf, pushed.calibration, pushed.rows], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    assert "no_such_file.yaml" in done.stderr
    assert "joints: must be those of the URDF" in done.stderr
    expected = []
    for tick, report in enumerate(pushed.reports(DT)):
        located = [contact for contact in report.contacts if contact.located]
        if located:
            it = max(located, key=lambda contact: np.linalg.norm(contact.force))
            expected.append([DT * tick, *it.force, *np.cross(it.point, it.force)])
    # Every second one finds that the one before is still being sent.
    lines = [line.split() for line in done.stdout.splitlines()]
    assert len(lines) == (len(expected) + 1) // 2 > 50
    for line, wanted in zip(lines, expected[::2], strict=True):
        assert line[1] == "iiwa_link_0"
        found = [float.fromhex(number) for number in (line[0], *line[2:])]
        np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12)


def test_sensors_and_payloads_of_cpp(library: Path, urdf: Path, tmp_path: Path) -> None:
    """A sensor at the wrist whose contacts are wanted, another one, a payload, and a sample that is lost."""
    robot = cs.Robot.from_urdf(urdf)
    q, v, tau = rows(robot)
    rng = np.random.default_rng(8)
    wrenches = rng.normal(0.0, 1.0, (TICKS, 2, 6))
    wrenches[200:300, 1] = np.nan
    wrenches[:, 0, 2] += 40.0
    np.hstack([q, v, tau, wrenches.reshape(TICKS, 12)]).tofile(tmp_path / "rows.bin")
    turned = np.eye(4)
    turned[:3, :3] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    turned[:3, 3] = 0.0, 0.0, 0.02
    sensors = [
        cs.ForceTorqueSensor(
            "wrist",
            link="iiwa_link_7",
            pose=turned,
            offset=[0, 0, 3, 0, 0, 0],
            convention="support",
        ),
        cs.ForceTorqueSensor("elbow", link="iiwa_link_4"),
    ]
    monitor = cs.ContactMonitor(
        robot,
        dt=DT,
        sensors=sensors,
        wanted_contacts=["wrist"],
        torque_threshold=np.full(7, 0.8),
        wrench_threshold=3.0,
        bias_time_constant=0.05,
    )
    monitor.set_payload("iiwa_link_7", 0.4, [0.0, 0.0, 0.1])
    program = compiled(PROGRAMS / "sensors.cpp", library, tmp_path)
    lines = printed(program, urdf, tmp_path / "rows.bin")
    assert len(lines) == TICKS - 1
    found = iter(lines)
    for tick, row in enumerate(zip(q, v, tau, wrenches, strict=True)):
        if tick == 50:
            with pytest.raises(cs.InputError):
                monitor.update(row[0] * np.nan, *row[1:3], wrenches=row[3])
            continue
        if tick == 300:
            monitor.clear_payload()
        report = monitor.update(*row[:3], wrenches=row[3])
        line = next(found)
        assert line[0] == str(int(report.collision))
        numbers = [float.fromhex(number) for number in line[1:]]
        wanted = [*report.external_torque, *report.collision_torque, *report.wrenches.flat]
        # The two readers of URDF round rotations differently.
        np.testing.assert_allclose(numbers, wanted, rtol=1e-9, atol=1e-9)


def test_wrong_calls_are_refused(library: Path, pushed: Pushed, tmp_path: Path) -> None:
    program = compiled(PROGRAMS / "wrong_calls.c", library, tmp_path)
    assert printed(program, pushed.urdf, pushed.calibration) == [["all", "refused"]]


def test_the_address_sanitizer_finds_nothing(library: Path, pushed: Pushed, tmp_path: Path) -> None:
    flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer"]
    program = compiled(PROGRAMS / "wrong_calls.c", library, tmp_path, *flags)
    assert printed(program, pushed.urdf, pushed.calibration) == [["all", "refused"]]
    program = compiled(EXAMPLES / "replay.c", library, tmp_path, *flags)
    assert len(printed(program, pushed.urdf, pushed.rows, pushed.calibration)) > TICKS


def test_valgrind_finds_nothing(library: Path, pushed: Pushed, tmp_path: Path) -> None:
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed")
    program = compiled(PROGRAMS / "wrong_calls.c", library, tmp_path)
    command = ["valgrind", "--quiet", "--error-exitcode=9", "--leak-check=full", program]
    done = subprocess.run(
        [*command, pushed.urdf, pushed.calibration], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr


def test_what_is_installed_is_found_by_pkg_config(library: Path, pushed: Pushed, tmp_path: Path) -> None:
    if shutil.which("pkg-config") is None:
        pytest.skip("pkg-config is not installed")
    place = tmp_path / "place"
    subprocess.run(["sh", str(ROOT / "tools" / "install_c.sh"), str(place)], check=True)
    environment = os.environ | {"PKG_CONFIG_PATH": str(place / "lib" / "pkgconfig")}

    def asked(*options: str) -> list[str]:
        command = ["pkg-config", *options, "contactsense"]
        return subprocess.run(
            command, capture_output=True, text=True, check=True, env=environment
        ).stdout.split()

    assert asked("--modversion") == [cs.__version__]
    program = tmp_path / "replay"
    flags = [*asked("--cflags", "--libs"), f"-Wl,-rpath,{place / 'lib'}"]
    subprocess.run(["cc", str(EXAMPLES / "replay.c"), "-o", str(program), *flags], check=True)
    assert len(printed(program, pushed.urdf, pushed.rows, pushed.calibration)) > TICKS


def test_the_header_is_that_of_cpp_too(tmp_path: Path) -> None:
    source = tmp_path / "it.cpp"
    for standard, header in (
        ("c++11", "contactsense.h"),
        ("c++17", "contactsense.hpp"),
        ("c++20", "contactsense.hpp"),
    ):
        source.write_text(f'#include "{header}"\nint main() {{ return cs_robot_nq(nullptr) != 0; }}\n')
        command = ["c++", f"-std={standard}", *FLAGS, "-fsyntax-only", str(source)]
        subprocess.run(command, check=True)
