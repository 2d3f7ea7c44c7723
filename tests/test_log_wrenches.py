"""Readings of force/torque sensors in logs: every format, other rates, missing values, and whose they are."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from log_files import arm, named_columns, pushed, write_csv

import contactsense as cs

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

from bag_files import write_bag, write_mcap, write_sqlite
from ros_messages import Writer

ROWS = 200
LEFT = cs.ForceTorqueSensor("left_ft", "iiwa_link_5")
RIGHT = cs.ForceTorqueSensor("right_ft", "iiwa_link_7")
NAMES = tuple(f"iiwa_joint_{number}" for number in range(1, 8))
# Every third row from the tenth on has readings.
STAMPED = np.arange(10, ROWS, 3)
READINGS = np.random.default_rng(2).normal(0.0, 20.0, (ROWS, 2, 6))
HELD = np.array([STAMPED[np.searchsorted(STAMPED, row, side="right") - 1] for row in range(10, ROWS)])
WORDS = {"position": "pos", "velocity": "vel", "torque": "effort"}
PARTS = ("force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z")


def columns(
    parts: tuple[str, ...] = PARTS, sides: tuple[str, ...] = ("left_ft", "right_ft")
) -> dict[str, np.ndarray]:
    """Columns of a table in which rows between two readings have none."""
    found = {"time": pushed().time[:ROWS], **named_columns(pushed()[:ROWS], NAMES, WORDS)}
    for side, name in enumerate(sides):
        for k, part in enumerate(parts):
            column = np.full(ROWS, np.nan)
            column[STAMPED] = READINGS[STAMPED, side, k]
            found[f"{name}_{part}"] = column
    return found


def csv(folder: Path) -> Path:
    return write_csv(folder / "a.csv", columns())


def parquet(folder: Path) -> Path:
    pa, writer = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    writer.write_table(pa.table(columns()), folder / "a.parquet")
    return folder / "a.parquet"


def npz(folder: Path) -> Path:
    wrenches = {side: np.full((ROWS, 6), np.nan) for side in ("left_ft", "right_ft")}
    for side, rows in enumerate(wrenches.values()):
        rows[STAMPED] = READINGS[STAMPED, side]
    log = pushed()[:ROWS]
    parts = {
        f"{side}_{name}": rows[:, at]
        for side, rows in wrenches.items()
        for name, at in (("force", slice(0, 3)), ("torque", slice(3, 6)))
    }
    np.savez(folder / "a.npz", time=log.time, q=log.q, dq=log.v, tau=log.tau, **parts)
    return folder / "a.npz"


def bag_messages(encoding: str) -> list:
    writer, log = Writer(encoding), pushed()[:ROWS]
    found = writer.joints(log, NAMES, 7)
    for row in STAMPED:
        for side, frame in enumerate(("iiwa_link_5", "iiwa_link_7")):
            topic = f"/{('left', 'right')[side]}_ft/wrench"
            found.append(writer.wrench(topic, log.time[row], READINGS[row, side], frame))
    return found


FORMATS: dict[str, Callable[[Path], Path]] = {
    "mcap": lambda folder: write_mcap(folder / "a.mcap", bag_messages("cdr")),
    "mcap_ros1": lambda folder: write_mcap(folder / "a.mcap", bag_messages("ros1"), "ros1"),
    "rosbag2": lambda folder: write_sqlite(folder / "a.db3", bag_messages("cdr")),
    "rosbag1": lambda folder: write_bag(folder / "a.bag", bag_messages("ros1")),
    "csv": csv,
    "parquet": parquet,
    "npz": npz,
}


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize("name", FORMATS)
def test_every_format_has_the_readings_in_the_order_of_the_sensors(
    tmp_path: Path, name: str, order: tuple[int, int]
) -> None:
    file = FORMATS[name](tmp_path)
    sensors = [(LEFT, RIGHT)[k] for k in order]
    log = cs.read_log(file, arm(), sensors=sensors)
    assert log.wrenches is not None
    np.testing.assert_array_equal(log.wrenches, READINGS[HELD][:, order])
    np.testing.assert_allclose(log.q, pushed().q[10:ROWS], rtol=0.0, atol=1e-12)
    assert log.reading is not None
    assert sum("wrench of" in line for line in log.reading.chosen) == 2
    assert log.reading.left_out == ()
    missing = [line for line in log.reading.mended if "reading of" in line]
    bags = name.startswith(("mcap", "rosbag"))
    assert missing == ([] if bags else [
        f"{ROWS - len(STAMPED)} rows without reading of '{it.name}'; the last one before is kept"
        for it in sensors
    ])  # fmt: skip


def test_without_sensors_readings_are_left_out_and_listed(tmp_path: Path) -> None:
    log = cs.read_log(FORMATS["mcap"](tmp_path), arm())
    assert log.wrenches is None
    assert log.reading is not None
    assert [line[:60] for line in log.reading.left_out] == [
        f"wrench 'wrench.force.x' to 'wrench.torque.z' of /{side}_ft/wrench"[:60]
        for side in ("left", "right")
    ]


def test_the_readings_of_one_sensor_are_one_sensor_s(tmp_path: Path) -> None:
    log = cs.read_log(FORMATS["mcap"](tmp_path), arm(), sensors=[RIGHT])
    assert log.wrenches is not None
    np.testing.assert_array_equal(log.wrenches[:, 0], READINGS[HELD, 1])


@pytest.mark.parametrize(
    "sensors",
    [
        ["left_ft", "right_ft"],
        ["left", "right"],
        {LEFT: "/left_ft/wrench", RIGHT: None},
        {"a": "/left_ft/wrench", "b": "/right_ft/wrench"},
        {cs.ForceTorqueSensor("a", "iiwa_link_5"): None, cs.ForceTorqueSensor("b", "iiwa_link_7"): None},
    ],
)
def test_sensors_are_told_by_name_topic_or_frame(tmp_path: Path, sensors: object) -> None:
    log = cs.read_log(FORMATS["mcap"](tmp_path), arm(), sensors=sensors)
    np.testing.assert_array_equal(log.wrenches, READINGS[HELD])


@pytest.mark.parametrize(
    ("names", "source"),
    [
        (tuple(f"wrench_{part}" for part in PARTS), None),
        (tuple(f"wrench[{k}]" for k in range(6)), None),
        (("ft_fx", "ft_fy", "ft_fz", "ft_tx", "ft_ty", "ft_tz"), None),
        (("Fx", "Fy", "Fz", "Mx", "My", "Mz"), None),
        (("Fx [N]", "Fy [N]", "Fz [N]", "Tx [Nm]", "Ty [Nm]", "Tz [Nm]"), None),
        (("force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"), None),
        (tuple(f"wrist_ft.wrench.{part}.{axis}" for part in ("force", "torque") for axis in "xyz"), None),
        (tuple(f"values[fts].values[{part.replace('_', '.')}]" for part in PARTS), None),
        (tuple(f"ft_raw_wrench_{k}" for k in range(6)), None),
        (tuple(f"ft_raw_{k}" for k in range(6)), "ft_raw_*"),
        (tuple(f"a{k}" for k in (3, 1, 4, 15, 9, 2)), ["a3", "a1", "a4", "a15", "a9", "a2"]),
    ],
)  # fmt: skip
def test_names_of_components(tmp_path: Path, names: tuple[str, ...], source: object) -> None:
    table = {name: rows for name, rows in columns().items() if "_ft_" not in name}
    table |= {name: READINGS[:, 0, k] for k, name in enumerate(names)}
    sensors = [LEFT] if source is None else {LEFT: source}
    log = cs.read_log(write_csv(tmp_path / "a.csv", table), arm(), sensors=sensors)
    np.testing.assert_allclose(log.wrenches, READINGS[:, :1])
    np.testing.assert_allclose(log.tau, pushed().tau[:ROWS])


@pytest.mark.parametrize(
    ("sensors", "message"),
    [
        (["wrist"], r"no wrench is named as 'wrist'; there are '.*/left_ft/wrench.*/right_ft/wrench"),
        (["ft"], "several wrenches fit 'ft'"),
        ({"a": "/left_ft/wrench", "b": "/left_ft/wrench"}, "'a' and 'b' both fit"),
        ({"a": "/nosuch"}, r"sensors: 'a': nothing that '/nosuch' names has the 6 components"),
        ({"a": "wrench.*"}, "several fit 'wrench"),
        (["left_ft", LEFT], "'left_ft' is there twice"),
        ("left_ft", "must be a sequence or a mapping"),
        (LEFT, "must be a sequence or a mapping"),
        (3, "must be a sequence or a mapping"),
        ({"a": 3}, "named by a topic, a pattern or six columns"),
        ([3], "must be of contactsense.ForceTorqueSensor or names, not int"),
        ([cs.ForceTorqueSensor("a", "nosuch")], "'a' is at 'nosuch', which the robot does not have"),
        ({cs.ForceTorqueSensor("a", "iiwa_link_4"): "/left_ft/wrench"}, "'iiwa_link_5', which moves against"),
    ],
)
def test_what_does_not_fit_is_named(tmp_path: Path, sensors: object, message: str) -> None:
    with pytest.raises(cs.InputError, match=message):
        cs.read_log(FORMATS["mcap"](tmp_path), arm(), sensors=sensors)


def test_readings_in_another_frame_are_refused(tmp_path: Path) -> None:
    pose = np.eye(4)
    pose[2, 3] = 0.1
    turned = cs.ForceTorqueSensor("left_ft", "iiwa_link_5", pose=pose)
    file = FORMATS["mcap"](tmp_path)
    with pytest.raises(
        cs.InputError, match=r"in the frame 'iiwa_link_5', which is not its frame: give .*pose=\[\[1"
    ):
        cs.read_log(file, arm(), sensors=[turned])
    # The name alone says nothing of the frame.
    assert cs.read_log(file, arm(), sensors=["left_ft"]).wrenches is not None


def test_a_frame_that_the_robot_lacks_is_noted(tmp_path: Path) -> None:
    writer, log = Writer("cdr"), pushed()[:ROWS]
    given = writer.joints(log, NAMES, 7)
    given += [writer.wrench("/ft", log.time[row], READINGS[row, 0], "ft_optical") for row in range(ROWS)]
    read = cs.read_log(write_mcap(tmp_path / "a.mcap", given), arm(), sensors=[RIGHT])
    assert read.reading is not None
    assert "the robot has no frame 'ft_optical', which is taken as the sensor's" in str(read.reading)
    given.append(writer.wrench("/ft", log.time[0], READINGS[0, 0], "other"))
    with pytest.raises(cs.InputError, match="of several frames: 'ft_optical', 'other'"):
        cs.read_log(write_mcap(tmp_path / "b.mcap", given), arm(), sensors=[RIGHT])


def test_what_a_controller_estimates_is_no_sensor_by_itself(tmp_path: Path) -> None:
    writer, log = Writer("cdr"), pushed()[:ROWS]
    given = writer.joints(log, NAMES, 7)
    given += [writer.wrench("/ext_wrench", log.time[row], READINGS[row, 0]) for row in range(ROWS)]
    file = write_mcap(tmp_path / "a.mcap", given)
    with pytest.raises(cs.InputError, match="no wrench is named as 'right_ft'"):
        cs.read_log(file, arm(), sensors=[RIGHT])
    log = cs.read_log(file, arm(), sensors={RIGHT: "/ext_wrench"})
    np.testing.assert_array_equal(log.wrenches, READINGS[:, :1])


def test_gaps_and_other_clocks_are_noticed(tmp_path: Path) -> None:
    writer, log = Writer("cdr"), pushed()[:ROWS]
    joints = writer.joints(log, NAMES, 7)
    rows = [*range(50), *range(90, 150)]
    given = joints + [writer.wrench("/ft", log.time[row], READINGS[row, 0]) for row in rows]
    read = cs.read_log(write_mcap(tmp_path / "a.mcap", given), arm(), sensors=[RIGHT])
    assert read.reading is not None
    assert read.reading.mended == (
        "1 gaps in reading of 'right_ft', the longest 0.041 s; the last one before is kept",
        "reading of 'right_ft' ends 0.050 s before the joints; the last one is kept",
    )
    held = [*range(50), *[49] * 40, *range(90, 150), *[149] * 50]
    np.testing.assert_array_equal(read.wrenches, READINGS[held][:, :1])
    given = joints + [writer.wrench("/ft", log.time[row] - 900.0, READINGS[row, 0]) for row in rows]
    with pytest.raises(
        cs.InputError, match=r"ends 899\.851 s before the joints begin; are their clocks the same"
    ):
        cs.read_log(write_mcap(tmp_path / "b.mcap", given), arm(), sensors=[RIGHT])


def test_a_sensor_without_a_reading_is_an_error(tmp_path: Path) -> None:
    table = columns(sides=("left_ft",))
    table = {name: np.full(ROWS, np.nan) if "_ft_force" in name else rows for name, rows in table.items()}
    with pytest.raises(cs.InputError, match="the log has no reading of 'left_ft'"):
        cs.read_log(write_csv(tmp_path / "a.csv", table), arm(), sensors=[LEFT])


def test_wrenches_are_interpolated_with_the_rest(tmp_path: Path) -> None:
    table = columns()
    table["left_ft_force_x"] = np.linspace(0.0, 199.0, ROWS)
    for name in table:
        if "_ft_" in name and name != "left_ft_force_x":
            table[name] = np.zeros(ROWS)
    log = cs.read_log(write_csv(tmp_path / "a.csv", table), arm(), sensors=[LEFT, RIGHT], rate=2000.0)
    assert log.wrenches is not None
    np.testing.assert_allclose(log.wrenches[:, 0, 0], np.arange(len(log)) / 2.0, atol=1e-9)


WORD = st.sampled_from(
    ["left", "right", "ft", "wrench", "force", "torque", "x", "y", "z", "fx", "1", "tau", "cmd", "[0]", "q"]
)
STYLES = st.sampled_from(
    [
        PARTS,
        ("fx", "fy", "fz", "tx", "ty", "tz"),
        ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z"),
        tuple(f"wrench.{part.replace('_', '.')}" for part in PARTS),
        tuple(f"wrench[{k}]" for k in range(6)),
    ]
)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    style=STYLES,
    extra=st.lists(st.lists(WORD, min_size=1, max_size=4).map("_".join), max_size=14),
    order=st.randoms(use_true_random=False),
)
def test_columns_beside_a_sensor_s_are_never_taken_for_its_own(
    tmp_path: Path, style: tuple[str, ...], extra: list[str], order: Random
) -> None:
    own = {f"left_ft_{part}": np.arange(20.0) + 100.0 * k for k, part in enumerate(style)}
    others = {name: -1.0 - np.arange(20.0) for name in extra if name not in own}
    table = {"time": pushed().time[:20], **named_columns(pushed()[:20], NAMES, WORDS), **own, **others}
    names = list(table)
    order.shuffle(names)
    file = write_csv(tmp_path / "a.csv", {name: table[name] for name in names})
    try:
        log = cs.read_log(file, arm(), sensors=["left_ft"])
    except cs.InputError:
        if extra:
            return
        raise
    assert log.wrenches is not None
    np.testing.assert_array_equal(log.wrenches[:, 0], np.column_stack(list(own.values())))
    np.testing.assert_array_equal(log.q, pushed().q[:20])
