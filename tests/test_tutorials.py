"""Tutorials: the five commands of the log's page run on the files of a user, and what pages say is checked.

`test_examples.py` runs each page as a program and compares what it prints with what the page says.
"""

from __future__ import annotations

import csv
import re
import shlex
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from test_robot_files import write_package
from tools.doc_pages import ROOT, blocks, commands, differences, environment

import contactsense as cs

pytest.importorskip("mujoco")
from contactsense import sim

PAGES = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
LOG_PAGE = ROOT / "docs" / "tutorials" / "from_a_log.md"
INSTALL = re.compile(r"pip install '\.\[([\w,]+)\]'")
# What each extra installs that these pages import, by module.
MODULES = {"cli": ("typer", "rich"), "log": ("pyarrow",), "plot": ("matplotlib",), "sim": ("mujoco",)}
DT = 0.005
FORCE = np.array([0.0, 10.0, 0.0])  # [N], besides that against the surface
# Noise, friction and hysteresis of the torques change a force by so much of it.
FORCE_ERROR = 0.2
SEED = 21


def five_commands() -> list[str]:
    """Those before the page goes on."""
    text = LOG_PAGE.read_text(encoding="utf-8")
    before = text[: text.index("\n## Go on\n")]
    return [
        line
        for code in re.findall(r"^```sh\n(.*?)^```$", before, re.MULTILINE | re.DOTALL)
        for line in commands(code)
    ]


def write_log(path: Path, log: cs.Log, joints: tuple[str, ...]) -> None:
    """As a recorder might: degrees, milliseconds, semicolons, efforts before positions, an unknown column."""
    names = ["stamp_ms", *(f"effort_{it}" for it in joints), *(f"position_{it}_deg" for it in joints)]
    names += [*(f"velocity_{it}_deg" for it in joints), "gripper"]
    columns = [1e3 * log.time, log.tau, np.rad2deg(log.q), np.rad2deg(log.v), np.zeros(len(log))]
    with path.open("w", newline="") as file:
        writer = csv.writer(file, delimiter=";")
        writer.writerow(names)
        writer.writerows(np.round(np.column_stack(columns), 6).tolist())


@pytest.fixture(scope="module")
def user(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, sim.ImperfectRun]:
    """A folder with a URDF, its meshes and two logs of an arm with errors; what was true in the second."""
    folder = tmp_path_factory.mktemp("user")
    write_package(folder / "arm.urdf", folder / "meshes", "package://lab_arm_description/meshes/")
    robot = cs.Robot.named("iiwa14")
    arm = sim.ImperfectArm.typical(robot, seed=SEED)
    plan = cs.exciting_motion(robot, 20.0, dt=DT, seed=SEED)
    motion = sim.JointMotion(plan.time, plan.q, plan.v, plan.a)
    write_log(folder / "free.csv", sim.record_imperfect(robot, arm, motion, seed=1).log, robot.joint_names)
    face = robot.surface("iiwa_link_7").closest_points([[0.0, 0.3, 0.03]])
    force = FORCE - 40.0 * face.normals[0]
    push = sim.PersonContact("iiwa_link_7", face.points[0], force, start=5.0, duration=0.7, rise=0.1)
    motion = sim.random_moves(robot, 10.0, dt=DT, seed=SEED)
    run = sim.record_imperfect(robot, arm, motion, [push], seed=2)
    write_log(folder / "work.csv", run.log, robot.joint_names)
    return folder, run


def test_five_commands_give_a_picture_of_the_contact(user: tuple[Path, sim.ImperfectRun]) -> None:
    folder, run = user
    install, *others = five_commands()
    assert len(others) == 4
    found = INSTALL.fullmatch(install)
    assert found
    assert set(found[1].split(",")) == {"cli", "log", "plot"}
    before = {path.name for path in folder.iterdir()}
    assert before == {"arm.urdf", "meshes", "free.csv", "work.csv"}
    for command in others:
        done = subprocess.run(
            ["sh", "-c", command],
            cwd=folder,
            env=environment(folder),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, f"{command}\n{done.stderr}"
        assert "not found" not in done.stderr
    picture = folder / str(shlex.split(command)[-1])
    assert {path.name for path in folder.iterdir()} == {*before, "arm.yaml", picture.name}
    # It is one of the robot, not an empty frame.
    assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert struct.unpack(">II", picture.read_bytes()[16:24]) == (1300, 975)
    assert len(picture.read_bytes()) > 50_000

    rows = re.findall(r"^ +\d+ +([\d.]+) ([\d.]+) +(iiwa_link_\d) .* ([\d.]+)\s*$", done.stdout, re.MULTILINE)
    ((start, end, link, peak),) = rows
    (true,) = run.truth.contacts
    assert link == true.contact.link
    assert abs(float(start) - true.contact.start) < 0.15
    assert abs(float(end) - true.contact.end) < 0.15
    force = float(np.linalg.norm(true.force))
    assert abs(float(peak) - force) < FORCE_ERROR * force


def test_extras_that_pages_install_exist_and_are_enough() -> None:
    """The package is in no index and the tests need no network: what `pip install` would read is checked."""
    # Not the metadata of what is installed, which may be older than the checkout.
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    table = project[project.index("[project.optional-dependencies]") :].partition("\n\n[")[0]
    brought = dict(re.findall(r"^(\w+) = (\[.*\])$", table, re.MULTILINE))
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        assert "The package has not been published yet" in text, page.name
        extras = {extra for found in INSTALL.findall(text) for extra in found.split(",")}
        assert extras, page.name
        assert extras <= set(brought)
        for extra, modules in MODULES.items():
            for module in modules:
                needed = re.search(rf"^(import|from) {module}\b", text, re.MULTILINE)
                assert not needed or extra in extras, f"{page.name}: {module}"
                assert f'"{module}>=' in brought[extra]
        if "from contactsense import sim" in text:
            assert "sim" in extras, page.name
        if "contactsense replay" in text or ".to_parquet" in text:
            assert {"cli", "log"} <= extras, page.name
        if ".to_png(" in text or "--png" in text:
            assert "plot" in extras, page.name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_is_printed_is_on_the_page(page: Path) -> None:
    """Code that prints is followed by a text, which `test_examples.py` compares."""
    silent = [
        block.code
        for block in blocks(page)
        if block.language == "python" and re.search(r"^\s*print\(", block.code, re.MULTILINE)
        if block.stated is None
    ]
    assert silent == []
    assert all(block.stated != "" for block in blocks(page))


@pytest.mark.parametrize(
    ("stated", "printed", "same"),
    [
        ("bias 0.31 Nm", "bias  0.32 Nm", True),
        ("bias 0.31 Nm", "bias 0.35 Nm", False),
        ("force 38 N", "force 39 N", True),
        ("2 contacts", "3 contacts", False),
        ("link_6 located", "link_7 located", False),
        ("[-0.51 0.2]", "[-0.5 0.2]", True),
        ("[-0.51 0.2]", "[0.51 0.2]", False),
        ("a\n...\nd", "a\nb\nc\nd", True),
        ("a\n...\nd", "a\nb\nc", False),
        ("a", "a\nb", False),
        ("a\n...", "a\nb", True),
        ("a\nb", "a", False),
    ],
)
def test_differences_between_a_page_and_what_is_printed(stated: str, printed: str, same: bool) -> None:
    assert (differences(stated, printed) == []) == same
