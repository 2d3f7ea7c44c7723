"""Commands on logs: what they print, what they write, how they end."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path

import humanoid_logs
import numpy as np
import pytest
from log_files import arm, named_columns, pushed, write_csv
from robots import BY_NAME, EXAMPLE_SHARE, SHARED, example

import contactsense as cs
from contactsense.cli.app import run

WORDS = {"position": "pos", "velocity": "vel", "torque": "effort"}
PANDA = BY_NAME["panda"]


def columns(log: cs.Log) -> dict[str, np.ndarray]:
    names = [str(number) for number in range(1, 8)]
    return {"time": log.time, **named_columns(log, names, WORDS)}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return write_csv(tmp_path / "pushed.csv", columns(pushed()))


def replay(file: Path, *more: str) -> list[str]:
    return ["replay", str(file), "--robot", "iiwa14", "--threshold", "0.6", *more]


def test_replay_prints_contacts_and_how_the_file_was_read(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(replay(file)) == 0
    told = capsys.readouterr()
    assert "pushed.csv: 1 contact in 2.0 s" in told.out
    assert "iiwa_link_7" in told.out
    assert "position from 'pos_1' to 'pos_7' of pushed [rad]" in told.err


def test_replay_as_json_is_what_the_library_says(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(replay(file, "--json")) == 0
    (line,) = capsys.readouterr().out.splitlines()
    log = cs.read_log(file, arm())
    monitor = cs.ContactMonitor(arm(), dt=float(np.median(np.diff(log.time))), torque_threshold=0.6)
    (contact,) = cs.replay(log, monitor).contacts
    assert json.loads(line) == {"log": str(file), **contact.to_dict()}


def test_replay_writes_all_files(file: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert run(replay(file, "--out", str(out))) == 0
    written = {"contacts.jsonl", "contacts.parquet", "contact_ticks.parquet", "ticks.parquet", "replay.mcap"}
    assert {path.name for path in out.iterdir()} == written


def test_several_logs_have_a_folder_each(file: Path, tmp_path: Path) -> None:
    other = write_csv(tmp_path / "free.csv", columns(pushed()[:300]))
    out = tmp_path / "out"
    assert run(["replay", str(other), *replay(file, "--out", str(out))[1:]]) == 0
    assert (out / "pushed" / "contacts.jsonl").read_text().count("\n") == 1
    assert (out / "free" / "contacts.jsonl").read_text() == ""


def test_a_damaged_file_gives_what_can_be_read_and_its_own_exit_code(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = file.read_bytes()
    file.write_bytes(whole[: int(0.9 * len(whole))])
    assert run(replay(file)) == 3
    told = capsys.readouterr()
    assert "1 contact in" in told.out
    assert "damaged: line 18" in told.err
    assert file.read_bytes() == whole[: int(0.9 * len(whole))]


def test_a_wrong_model_is_not_taken_for_contacts_without_a_word(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    constants = ["--torque-constants", "0.5"]
    assert run(replay(file, *constants)) == 0
    assert "its model has errors" in capsys.readouterr().err


def test_ctrl_c_keeps_what_is_done(
    file: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    module = import_module("contactsense.cli.replay")
    original = module.replay

    def stopped(log: cs.Log, monitor: cs.ContactMonitor, classifier: None, on_progress: object) -> cs.Replay:
        del classifier, on_progress

        def stop(done: int, rows: int) -> None:
            raise KeyboardInterrupt

        monkeypatch.setattr(import_module("contactsense.offline.replay"), "_CHUNK", 1500)
        result: cs.Replay = original(log, monitor, on_progress=stop)
        return result

    monkeypatch.setattr(module, "replay", stopped)
    assert run(replay(file)) == 130
    assert "1 contact in 1.5 s, until it was interrupted" in capsys.readouterr().out


def test_thresholds_by_joint_and_an_external_torque(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = pushed()
    torque = cs.replay(log, cs.ContactMonitor(arm(), dt=0.001)).ticks["external_torque"]
    vendor = {f"tau_ext{joint}": -torque[:, joint] for joint in range(7)}
    file = write_csv(tmp_path / "a.csv", {**columns(log), **vendor})
    levels = [9.0, 9.0, 9.0, 0.6, 0.5, 0.6, 0.5]
    external = ["--external", "--torque-constants=-1", "--threshold", ",".join(map(str, levels)), "--json"]
    assert run(["replay", str(file), "--robot", "iiwa14", *external]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    read = cs.read_log(file, arm(), external=True, torque_constants=-1.0)
    monitor = cs.ContactMonitor(arm(), dt=float(np.median(np.diff(read.time))), torque_threshold=levels)
    (contact,) = cs.replay(read, monitor).contacts
    assert json.loads(line) == {"log": str(file), **contact.to_dict()}


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--column", "position"], "column: must be NAME=VALUE"),
        (["--column", "nosuch=a"], "columns: there is no 'nosuch'"),
        (["--unit", "position=m"], "units: there is no 'position'"),
        (["--torque-constants", "a"], "torque-constants: must be a number"),
        (["--threshold", "1,2"], "torque_threshold"),
        (["--threshold", "1,a"], "threshold: must be a number"),
        (["--external"], "nothing holds external torques"),
        (["--calibration", "nosuch.yaml"], "path: cannot read"),
        (["--sensor", "wrist="], "sensor: must be LINK, NAME=LINK or NAME=LINK@TOPIC, not 'wrist='"),
        (["--sensor", "nosuch"], "sensors: 'nosuch' is at 'nosuch', which the robot does not have"),
        (["--sensor", "iiwa_link_7"], "no wrench is named as 'iiwa_link_7'"),
        (["--sensor", "a=iiwa_link_7", "--sensor", "a=iiwa_link_6"], "sensors: 'a' is there twice"),
        (["--sensor-convention", "up"], "sensor-convention: must be load or support, not 'up'"),
        (["--wanted", "wrist"], "wanted_contacts"),
    ],
)
def test_an_error_is_a_line(
    file: Path, more: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(replay(file, *more)) == 2
    told = capsys.readouterr()
    assert message in told.err
    assert "Traceback" not in told.err


def command_on(name: str, log: Path, robot: str = "iiwa14") -> list[str]:
    return [name, str(log), "--robot", robot]


@pytest.mark.parametrize("name", ["replay", "calibrate", "diagnose", "view"])
def test_a_file_that_cannot_be_read_is_named(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Output that cannot be written has another message and another code."""
    (tmp_path / "empty").mkdir()
    (tmp_path / "mine.csv").write_text("time\n0\n")
    (tmp_path / "robot.urdf").mkdir()

    def refuse(self: Path, *_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied", str(self))

    files = [tmp_path / "absent.csv", tmp_path / "empty"]
    robots = [tmp_path / "absent.urdf", tmp_path / "robot.urdf"]
    lines = [command_on(name, file) for file in files]
    lines += [command_on(name, files[0], str(robot)) for robot in robots]
    lines.append(command_on(name, tmp_path / "mine.csv"))  # last: only then files cannot be opened
    for arguments, file in zip(lines, [*files, *robots, tmp_path / "mine.csv"], strict=True):
        if file.name == "mine.csv":
            monkeypatch.setattr(Path, "open", refuse)
        assert run(arguments) == 2, arguments
        told = capsys.readouterr().err
        assert file.name in told
        assert "cannot write" not in told
        assert told.count("\n") == 1, told


@pytest.fixture(scope="module")
def moving(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Half a minute of motion with friction, bias and noise."""
    robot, rng = arm(), np.random.default_rng(5)
    motion = cs.exciting_motion(robot, 25.0, dt=0.01)
    rows = zip(motion.q, motion.v, motion.a, strict=True)
    tau = np.array([robot.inverse_dynamics(*row) for row in rows])
    tau += 0.4 + 0.8 * np.tanh(motion.v / 0.02) + rng.normal(0.0, 0.05, tau.shape)
    log = cs.Log(motion.time, motion.q, motion.v, tau)
    return write_csv(tmp_path_factory.mktemp("logs") / "moving.csv", columns(log))


def test_calibrate_writes_a_file_that_replay_uses(
    moving: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, png = tmp_path / "arm.yaml", tmp_path / "arm.png"
    assert run(["calibrate", str(moving), "--robot", "iiwa14", "--out", str(out), "--png", str(png)]) == 0
    told = capsys.readouterr()
    assert "Coulomb" in told.out
    calibration = cs.Calibration.load(out)
    np.testing.assert_allclose(calibration.friction.coulomb, 0.8, atol=0.1)
    assert png.stat().st_size > 20_000
    assert run(["replay", str(moving), "--robot", "iiwa14", "--calibration", str(out), "--json"]) == 0
    assert capsys.readouterr().out == ""


def test_calibrate_as_json_shows_what_is_left(
    moving: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "arm.yaml"
    assert run(["calibrate", str(moving), "--robot", "iiwa14", "--out", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert np.all(np.array(told["residual_after"]) < 0.5 * np.array(told["residual_before"]))


def test_diagnose_recognises_torques_of_the_opposite_sign(
    moving: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    png = tmp_path / "arm.png"
    arguments = ["diagnose", str(moving), "--robot", "iiwa14"]
    assert run([*arguments, "--torque-constants=-1", "--json", "--png", str(png)]) == 0
    # The sign has no vector, which is no number in JSON.
    findings = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert findings[0]["code"] == "sign"
    assert findings[0]["vector"] == [None, None, None]
    assert png.stat().st_size > 20_000
    assert run([*arguments, "--torque-constants", "-1"]) == 0
    assert capsys.readouterr().out.startswith("1. major, sign: ")


def test_a_short_log_is_not_calibrated_without_a_word(
    moving: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    short = tmp_path / "short.csv"
    short.write_text("\n".join(moving.read_text().splitlines()[:700]) + "\n")
    assert run(["calibrate", str(short), "--robot", "iiwa14", "--out", str(tmp_path / "arm.yaml")]) == 0
    assert "7.0 s are short; record at least 10 s" in capsys.readouterr().err


def test_warnings_of_meshes_are_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    urdf = example("ur_description/urdf/ur3_robot.urdf")
    robot = cs.Robot.from_urdf(urdf, package_dirs=EXAMPLE_SHARE)
    of_meshes = [text for text in robot.warnings if text.startswith("link '")]
    assert len(of_meshes) == len(robot.warnings) > 10
    six = {name: np.zeros(20) for name in robot.actuated_joint_names}
    words = {f"{word}_{name}": rows for word in ("pos", "vel", "effort") for name, rows in six.items()}
    file = write_csv(tmp_path / "a.csv", {"time": np.arange(20.0) / 100.0, **words})
    assert run(["replay", str(file), "--robot", str(urdf), "--package-dir", str(EXAMPLE_SHARE)]) == 0
    first, *others = capsys.readouterr().err.splitlines()
    assert first == f"ur3: meshes of 5 links are open or were repaired; Robot.warnings lists {len(of_meshes)}"
    assert not any(text in "".join(others) for text in of_meshes)


@pytest.mark.shared
@pytest.mark.parametrize(
    ("log", "robot", "more"),
    [
        ("panda_free", "panda", ["--lock", "panda_finger*"]),
        ("ur10_free", "ur10", []),
        ("ur3e_rtde/L1L2.csv.gz", "ur3", ["--torque-constants", "11.9,11.9,9.9,5.9,5.9,5.9"]),
    ],
)
def test_public_logs_need_one_command(
    log: str, robot: str, more: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = EXAMPLE_SHARE / "example-robot-data" / "robots"
    urdf = {"panda": PANDA.path, "ur10": folder / "ur_description/urdf/ur10_robot.urdf"}
    urdf["ur3"] = folder / "ur_description/urdf/ur3_robot.urdf"
    if not urdf[robot].exists():
        pytest.skip("example-robot-data is not installed")
    described = ["--robot", str(urdf[robot]), "--package-dir", str(EXAMPLE_SHARE)]
    assert run(["diagnose", str(SHARED / "real" / log), *described, *more]) == 0
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.shared
@pytest.mark.parametrize(
    ("log", "robot", "more"), [("panda_free", "panda", ["panda_finger*"]), ("ur10_free", "ur10", [])]
)
def test_the_opposite_sign_of_public_logs_is_recognised(
    log: str, robot: str, more: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    urdf = example(
        {"panda": "panda_description/urdf/panda.urdf", "ur10": "ur_description/urdf/ur10_robot.urdf"}[robot]
    )
    arguments = [
        "diagnose",
        str(SHARED / "real" / log),
        "--robot",
        str(urdf),
        "--package-dir",
        str(EXAMPLE_SHARE),
    ]
    arguments += [word for joint in more for word in ("--lock", joint)]
    for sign, expected in ((1, False), (-1, True)):
        assert run([*arguments, f"--torque-constants={sign}", "--json"]) == 0
        findings = json.loads(capsys.readouterr().out)
        assert ("sign" in [finding["code"] for finding in findings]) == expected
        assert not expected or findings[0]["code"] == "sign"


@pytest.mark.shared
def test_the_touches_of_a_public_log_are_found(capsys: pytest.CaptureFixture[str]) -> None:
    PANDA.require()
    described = ["--robot", str(PANDA.path), "--package-dir", str(EXAMPLE_SHARE), "--lock", "panda_finger*"]
    log = str(SHARED / "real/franka_touch/a4.csv.gz")
    assert run(["replay", log, *described, "--threshold", "1", "--bias-time", "1", "--json"]) == 0
    contacts = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert 13 <= len(contacts) <= 17


def test_replay_of_a_humanoid_with_sensors(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = humanoid_logs.table(tmp_path, "csv")
    sensors = ["--sensor", "left_foot=l_foot", "--sensor", "right_foot=r_foot@right_foot_*"]
    wanted = ["--wanted", "left_foot", "--wanted", "right_foot"]
    levels = ["--threshold", "3", "--wrench-threshold", "10"]
    command = ["replay", str(file), "--robot", "atlas", *levels, *sensors]
    assert run([*command, *wanted, "--json", "--out", str(tmp_path / "out")]) == 0
    told = capsys.readouterr()
    (line,) = told.out.splitlines()
    assert json.loads(line)["link"] == "utorso"
    assert "wrench of 'right_foot' from 'right_foot_force_x' to 'right_foot_torque_z'" in told.err
    assert (tmp_path / "out" / "replay.mcap").exists()
    # The weight on the feet is a contact unless it is said to be wanted.
    assert run([*command, "--json"]) == 0
    assert any(json.loads(line)["start"] < 0.1 for line in capsys.readouterr().out.splitlines())


def test_a_urdf_may_have_a_floating_base(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = humanoid_logs.table(tmp_path, "csv")
    urdf = Path(cs.__file__).with_name("descriptions") / "atlas.urdf"
    command = ["replay", str(file), "--robot", str(urdf), "--threshold", "1e6", "--json"]
    assert run([*command, "--floating-base"]) == 0
    assert "pose of the base from 'base_x' to 'base_qw'" in capsys.readouterr().err
