"""What a bare `pip install contactsense` gives: the library works, and a missing extra is named.

Run by the Python of an environment with nothing but the wheel and its dependencies: `make wheel-check`.
"""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module, metadata
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import contactsense as cs

# What extras bring, and must be absent here.
ABSENT = (
    "typer",
    "rich",
    "mujoco",
    "matplotlib",
    "pyarrow",
    "rosbags",
    "mcap",
    "h5py",
    "viser",
    "ray",
    "zenoh",
)
EXTRAS = {"cli", "sim", "plot", "log", "view", "bridge", "fleet", "demo", "study"}


def check_environment() -> None:
    """The wheel is what was installed, it is complete, and none of the extras is there."""
    assert "site-packages" in Path(cs.__file__).parts, f"not installed: {cs.__file__}"
    assert cs.build_profile == "release"
    for package in ABSENT:
        assert find_spec(package) is None, f"{package} is installed; wanted is an environment without extras"
    about = metadata.metadata("contactsense")
    assert about["License-Expression"] == "MIT OR Apache-2.0"
    licences = {Path(file).name for file in about.get_all("License-File") or ()}
    assert licences == {"LICENSE-MIT", "LICENSE-APACHE"}, licences
    offered = set(about.get_all("Provides-Extra") or ())
    assert offered == EXTRAS, offered


def check_library() -> None:
    """A contact on the last link of an arm is detected, and its link is found."""
    robot = cs.Robot.named("iiwa14")
    monitor = cs.ContactMonitor(robot, dt=0.001, torque_threshold=0.5)
    q, v = np.array([0, 0.5, 0, -1.4, 0, 0.9, 0]), np.zeros(7)
    weight = robot.inverse_dynamics(q, v, v)
    push = robot.jacobian(q, "iiwa_link_6", point=[0.515, 0.013, 0.605])[:3].T @ [38, 0, 13]
    for tick in range(1000):
        report = monitor.update(q, v, weight - push if tick >= 500 else weight)
    assert [contact.link for contact in report.contacts] == ["iiwa_link_6"]


def check_command() -> None:
    """The command says what to install, in one line."""
    command = Path(sys.executable).with_name("contactsense")
    for arguments in ([], ["demo"], ["study"]):
        ended = subprocess.run([command, *arguments], capture_output=True, text=True, timeout=60, check=False)
        assert ended.returncode == 2, ended
        assert ended.stderr.endswith("pip install 'contactsense[cli]'\n"), ended.stderr
        assert ended.stderr.count("\n") == 1, ended.stderr


def check_missing_extras() -> None:
    """What needs an extra names it."""
    from contactsense import demo

    attempts = {
        "sim": lambda: import_module("contactsense.sim"),
        "demo": lambda: demo.run(),
    }
    for extra, attempt in attempts.items():
        try:
            attempt()
        except cs.ContactSenseError as missing:
            assert f"pip install 'contactsense[{extra}]'" in str(missing), missing  # noqa: PT017
        else:
            raise AssertionError(f"extra {extra}: nothing is missing")


def main() -> None:
    """Runs all checks."""
    for check in (check_environment, check_library, check_command, check_missing_extras):
        check()
        print(f"{check.__name__}: passed")


if __name__ == "__main__":
    main()
