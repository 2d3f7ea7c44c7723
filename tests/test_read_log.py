"""From a file of numbers to a robot's log."""

from pathlib import Path

import numpy as np
import pytest
from log_files import DT, arm, named_columns, pushed, write_csv
from robots import BY_NAME, SHARED

import contactsense as cs

WORDS = {"position": "pos", "velocity": "vel", "torque": "effort"}
NUMBERS = [str(number) for number in range(1, 8)]


@pytest.fixture
def columns() -> dict[str, np.ndarray]:
    log = pushed()[:200]
    return {"time": log.time, **named_columns(log, NUMBERS, WORDS)}


def test_columns_are_found_by_their_names(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    log = cs.read_log(write_csv(tmp_path / "a.csv", columns), arm())
    expected = pushed()[:200]
    for name in ("time", "q", "v", "tau"):
        np.testing.assert_allclose(getattr(log, name), getattr(expected, name), rtol=0.0, atol=1e-12)
    assert log.reading is not None
    assert log.reading.mended == log.reading.left_out == log.reading.damage == ()
    text = str(log.reading)
    assert all(
        part in text for part in ("time from 'time' [s]", "'pos_1' to 'pos_7' of a [rad]", "1000 rows")
    )


def test_joints_are_matched_by_name(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    robot = arm()
    names = [f"robot1 {name}" for name in robot.actuated_joint_names]
    own = named_columns(pushed()[:200], names, WORDS)
    shuffled = dict(sorted(own.items(), key=lambda item: hash(item[0][::-1])))
    extra = {"pos_gripper": np.zeros(200), "vel_gripper": np.zeros(200), "effort_gripper": np.zeros(200)}
    log = cs.read_log(write_csv(tmp_path / "a.csv", {"t": columns["time"], **extra, **shuffled}), robot)
    np.testing.assert_allclose(log.q, pushed().q[:200], rtol=0.0, atol=1e-12)
    assert log.reading is not None
    assert "pos_gripper" in log.reading.left_out[0]


def test_missing_joints_are_named(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    robot = arm()
    names = list(robot.actuated_joint_names)
    own = named_columns(pushed()[:200], names, WORDS)
    del own[f"pos_{names[2]}"]
    with pytest.raises(cs.InputError, match=f"no position of {names[2]}"):
        cs.read_log(write_csv(tmp_path / "a.csv", {"time": columns["time"], **own}), robot)


@pytest.mark.parametrize(("unit", "factor"), [("ns", 1e9), ("us", 1e6), ("ms", 1e3), ("s", 1.0)])
@pytest.mark.parametrize("start", [0.0, 1.7e9])
def test_the_unit_of_time_is_told_by_its_step(
    tmp_path: Path, columns: dict[str, np.ndarray], unit: str, factor: float, start: float
) -> None:
    stamps = np.round((start + columns["time"]) * factor, 6)
    log = cs.read_log(write_csv(tmp_path / "a.csv", {**columns, "time": stamps}), arm())
    np.testing.assert_allclose(log.time, columns["time"], atol=1e-6)
    assert log.reading is not None
    assert f"[{unit}]" in log.reading.chosen[0]


def test_degrees_are_told_by_size_and_by_name(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    degrees = {
        name: np.degrees(rows) if name.startswith(("pos", "vel")) else rows for name, rows in columns.items()
    }
    log = cs.read_log(write_csv(tmp_path / "a.csv", degrees), arm())
    np.testing.assert_allclose(log.q, pushed().q[:200], atol=1e-9)
    np.testing.assert_allclose(log.v, pushed().v[:200], atol=1e-9)
    named = {name.replace("pos", "pos_deg").replace("vel", "vel_deg"): rows for name, rows in degrees.items()}
    stated = {"position": "deg", "velocity": "deg/s"}
    log = cs.read_log(write_csv(tmp_path / "b.csv", named), arm(), units=stated, columns={
        "position": "pos_deg_*", "velocity": "vel_deg_*"
    })  # fmt: skip
    np.testing.assert_allclose(log.v, pushed().v[:200], atol=1e-9)


def test_currents_need_a_constant(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    currents = {name.replace("effort", "actual_current"): rows for name, rows in columns.items()}
    file = write_csv(tmp_path / "a.csv", currents)
    with pytest.raises(cs.InputError, match="torque_constants: current"):
        cs.read_log(file, arm())
    log = cs.read_log(file, arm(), torque_constants=2.0)
    np.testing.assert_allclose(log.tau, 2.0 * pushed().tau[:200])
    by_name = {name: -0.5 for name in arm().actuated_joint_names}
    np.testing.assert_allclose(
        cs.read_log(file, arm(), torque_constants=by_name).tau, -0.5 * pushed().tau[:200]
    )
    with pytest.raises(cs.InputError, match="torque_constants: needs one for each"):
        cs.read_log(file, arm(), torque_constants={"nosuch": 1.0})


def test_an_external_torque_takes_the_place_of_the_motors(
    tmp_path: Path, columns: dict[str, np.ndarray]
) -> None:
    estimates = {f"tau_ext_{number}": np.full(200, 0.1 * int(number)) for number in NUMBERS}
    # Two torques that fit as well do not matter where none is wanted.
    others = {name.replace("effort", "torque"): rows for name, rows in columns.items() if "effort" in name}
    file = write_csv(tmp_path / "a.csv", {**columns, **others, **estimates})
    log = cs.read_log(file, arm(), external=True, torque_constants=-2.0)
    assert log.tau is None
    np.testing.assert_allclose(log.external_torque, np.tile(-0.2 * np.arange(1, 8), (200, 1)))
    named = cs.read_log(file, arm(), external=True, columns={"external_torque": "torque_*"})
    np.testing.assert_allclose(named.external_torque, pushed().tau[:200])
    with pytest.raises(cs.InputError, match="nothing holds external torques"):
        cs.read_log(write_csv(tmp_path / "b.csv", columns), arm(), external=True)


def test_rows_out_of_order_repeated_or_incomplete_are_mended(
    tmp_path: Path, columns: dict[str, np.ndarray]
) -> None:
    order = np.arange(200)
    order[[50, 51]] = order[[51, 50]]
    order = np.insert(order, 120, 119)
    table = {name: rows[order] for name, rows in columns.items()}
    table["pos_3"][10] = np.nan
    table["time"][70] = np.nan
    log = cs.read_log(write_csv(tmp_path / "a.csv", table), arm())
    kept = np.delete(np.arange(200), [10, 70])
    np.testing.assert_allclose(log.q, pushed().q[kept], atol=1e-12)
    assert log.reading is not None
    assert [line.split()[0] for line in log.reading.mended] == ["1"] * 4


def test_numbers_that_nothing_measures_are_missing(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    table = {name: rows.copy() for name, rows in columns.items()}
    table["pos_2"][20], table["effort_1"][30], table["time"][40] = 1e300, -1e200, 1e308
    log = cs.read_log(write_csv(tmp_path / "a.csv", table), arm())
    assert len(log) == 197
    assert np.abs(log.v).max() < 1.0


def test_a_clock_that_is_set_back_goes_on(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    stamps = columns["time"].copy()
    stamps[100:] -= 5.0
    stamps[150:] += 3.0
    log = cs.read_log(write_csv(tmp_path / "a.csv", {**columns, "time": stamps}), arm())
    assert len(log) == 200
    np.testing.assert_allclose(np.diff(log.time[:150]), DT, atol=1e-9)
    assert log.reading is not None
    assert "set back 1 times" in log.reading.mended[0]
    assert "1 gaps, the longest 3.0" in log.reading.mended[1]


def test_missing_velocities_are_differences(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    table = {name: rows for name, rows in columns.items() if not name.startswith("vel")}
    log = cs.read_log(write_csv(tmp_path / "a.csv", table), arm())
    np.testing.assert_allclose(log.v[20:-20], pushed().v[20:180], atol=1e-5)
    assert log.reading is not None
    assert "velocity: central differences of positions" in log.reading.chosen


@pytest.mark.parametrize("nanoseconds", [False, True])
def test_files_are_joined_by_time(tmp_path: Path, columns: dict[str, np.ndarray], nanoseconds: bool) -> None:
    if nanoseconds:
        columns = {**columns, "time": np.round((columns["time"] + 1.7e9) * 1e9)}
    for word in WORDS.values():
        part = {name: rows for name, rows in columns.items() if name.startswith((word, "time"))}
        if word == "effort":
            # Half as often, from 20 ms on.
            part = {name: rows[20::2] for name, rows in part.items()}
        write_csv(tmp_path / f"{word}.csv", part)
    log = cs.read_log(tmp_path, arm())
    np.testing.assert_allclose(log.time, pushed().time[20:200], atol=1e-6)
    np.testing.assert_allclose(log.q, pushed().q[20:200], atol=1e-12)
    np.testing.assert_allclose(log.tau, np.repeat(pushed().tau[20:200:2], 2, axis=0), atol=1e-12)


def test_rows_are_interpolated_only_when_asked(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    log = cs.read_log(write_csv(tmp_path / "a.csv", columns), arm(), rate=500.0)
    np.testing.assert_allclose(log.time, np.arange(100) / 500.0)
    np.testing.assert_allclose(log.q, pushed().q[:200:2], atol=1e-9)


def test_a_counter_of_rows_is_no_time(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    table = {**columns, "time": np.arange(1.0, 201.0), "timestamp": columns["time"] + 1e6}
    log = cs.read_log(write_csv(tmp_path / "a.csv", table), arm())
    np.testing.assert_allclose(log.time, columns["time"], atol=1e-9)


def test_what_fits_twice_must_be_named(tmp_path: Path, columns: dict[str, np.ndarray]) -> None:
    twice = {**columns, **{name.replace("effort", "torque"): rows for name, rows in columns.items()}}
    file = write_csv(tmp_path / "a.csv", twice)
    with pytest.raises(cs.InputError, match=r"several fit as torque: .*'effort_1'.*'torque_1'"):
        cs.read_log(file, arm())
    assert cs.read_log(file, arm(), columns={"torque": "torque_*"}).tau is not None
    listed = [f"torque_{number}" for number in NUMBERS[::-1]]
    np.testing.assert_allclose(
        cs.read_log(file, arm(), columns={"torque": listed}).tau, pushed().tau[:200, ::-1], atol=1e-12
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"columns": {"nosuch": "a"}}, "columns: there is no 'nosuch'"),
        ({"columns": {"torque": "nosuch_*"}}, "columns: no table has 'nosuch_\\*'"),
        ({"columns": {"time": "nosuch"}}, "columns: a has no column 'nosuch'"),
        ({"units": {"position": "m"}}, "units: there is no 'position' in 'm'"),
        ({"rate": -1.0}, "rate: must be positive"),
        ({"rate": 1e12}, "rate: "),
        ({"topics": ["/nosuch"]}, "topics: there is no /nosuch; there are a"),
        ({"torque_constants": [1.0, 2.0]}, "torque_constants: "),
        ({"torque_constants": 0.0}, "torque_constants: must be finite and not zero"),
        ({"torque_constants": 10**400}, "^torque_constants: "),
        ({"torque_constants": [10**400] * 7}, "^torque_constants: "),
    ],
)
def test_wrong_arguments_are_named(
    tmp_path: Path, columns: dict[str, np.ndarray], options: dict[str, object], message: str
) -> None:
    with pytest.raises(cs.InputError, match=message):
        cs.read_log(write_csv(tmp_path / "a.csv", columns), arm(), **options)


def test_a_file_without_a_robot_in_it_says_what_it_has(tmp_path: Path) -> None:
    file = write_csv(tmp_path / "a.csv", {"time": np.arange(5.0), "height": np.arange(5.0)})
    with pytest.raises(cs.InputError, match=r"nothing holds positions .*'height'"):
        cs.read_log(file, arm())
    (tmp_path / "empty").mkdir()
    with pytest.raises(cs.InputError, match="path: the folder"):
        cs.read_log(tmp_path / "empty", arm())
    with pytest.raises(OSError, match="nosuch"):
        cs.read_log(tmp_path / "nosuch.csv", arm())


def test_numbered_columns_of_another_number_of_joints_are_no_match(
    tmp_path: Path, columns: dict[str, np.ndarray]
) -> None:
    six = {name: rows for name, rows in columns.items() if not name.endswith("7")}
    with pytest.raises(cs.InputError, match=r"nothing holds positions of the robot's 7 joints, .*'pos_1'"):
        cs.read_log(write_csv(tmp_path / "a.csv", six), arm())


def panda() -> cs.Robot:
    return BY_NAME["panda"].robot(locked_joints=["panda_finger_joint1", "panda_finger_joint2"])


@pytest.mark.shared
def test_the_panda_of_a_public_bag_is_read() -> None:
    log = cs.read_log(SHARED / "real/panda_free/panda_exciting_trajectory.db3", panda())
    assert len(log) > 700
    assert log.tau is not None
    assert 20.0 < log.time[-1] < 30.0


@pytest.mark.shared
def test_the_touches_of_a_public_csv_are_read() -> None:
    log = cs.read_log(SHARED / "real/franka_touch/a4.csv.gz", panda())
    assert log.tau is not None
    assert log.external_torque is not None
    assert log.q.shape == (3148, 7)
