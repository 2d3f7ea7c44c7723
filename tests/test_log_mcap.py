"""MCAP files: all chunks before a cut, and nothing but typed errors from broken ones."""

import re
import struct
from io import BytesIO

import numpy as np
import pytest
from bag_files import CUTS, JOINT_STATE, MUTATIONS, joint_state, messages, mutated, write_mcap
from mcap.reader import make_reader
from robots import SHARED
from ros_messages import Writer

from contactsense import InputError
from contactsense.log.formats import collect, mcap_file
from contactsense.log.formats.mcap_records import MAX_CHUNK

REAL = SHARED / "real" / "rosbag2_files"
FORMS = {
    "unchunked": {"use_chunking": False},
    "plain": {"chunk_size": 4000},
    "zstd": {"chunk_size": 4000, "compression": "zstd"},
    "lz4": {"chunk_size": 4000, "compression": "lz4"},
}


def table(recording, name, column):
    return next(t for t in recording.tables if t.name == name and column in t.columns)


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
@pytest.mark.parametrize("form", FORMS)
def test_all_messages_come_back(form, encoding, tmp_path):
    given = messages(encoding)
    found = mcap_file.read(write_mcap(tmp_path / "a.mcap", given, encoding, **FORMS[form]))
    assert found.damage == ()
    assert found.left_out == ("/text (std_msgs/msg/String): no measurements of joints or forces",)
    arm = table(found, "/joint_states", "position[arm_joint1]")
    rng = np.random.default_rng(5)
    assert arm.kind == "sensor_msgs/msg/JointState"
    assert arm.rows == 60
    assert arm.columns["position[arm_joint1]"][0] == rng.normal(size=7)[0]
    np.testing.assert_array_equal(
        arm.received, (1_700_000_000_000_000_000 + np.arange(60) * 1_000_000) * 1e-9
    )
    np.testing.assert_allclose(arm.columns["header.stamp"], arm.received, atol=3e-7, rtol=0)
    finger = table(found, "/joint_states", "position[finger]")
    assert set(finger.columns) - {"header.seq"} == {"header.stamp", "position[finger]"}
    np.testing.assert_array_equal(finger.columns["position[finger]"], np.arange(0, 60, 3))
    assert table(found, "/wrench", "wrench.torque.z").rows == 60


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_frames_that_messages_name_are_kept(encoding, tmp_path):
    writer = Writer(encoding)
    given = [writer.odometry("/odom", 0.001 * i, np.eye(7)[6], np.zeros(6), "hull") for i in range(9)]
    given += [writer.wrench("/ft", 0.001 * i, np.ones(6), f"frame{i % 12}") for i in range(99)]
    odometry, force = mcap_file.read(write_mcap(tmp_path / "a.mcap", given, encoding)).tables
    assert odometry.frames == {"header.frame_id": ("odom",), "child_frame_id": ("hull",)}
    # Many names are no frame of measurements; a few of them say so.
    assert force.frames == {"header.frame_id": tuple(f"frame{i}" for i in range(8))}
    assert force.rows == 99


def test_other_topics_are_read_when_wanted(tmp_path):
    path = write_mcap(tmp_path / "a.mcap", messages("cdr"))
    found = mcap_file.read(path, lambda topic, kind: kind.endswith("WrenchStamped"))
    assert [t.name for t in found.tables] == ["/wrench"]
    assert len(found.left_out) == 2


def test_joints_in_another_order_are_one_table_in_order_of_reception(tmp_path):
    names = [("a", "b"), ("b", "a"), ("a", "b")]
    given = [
        ("/j", JOINT_STATE, 30 - i * 10, joint_state("cdr", order, i, [ord(n) + i for n in order]))
        for i, order in enumerate(names)
    ]
    (found,) = mcap_file.read(write_mcap(tmp_path / "a.mcap", given)).tables
    np.testing.assert_array_equal(found.columns["position[a]"], [99, 98, 97])
    np.testing.assert_array_equal(found.columns["position[b]"], [100, 99, 98])
    np.testing.assert_array_equal(found.received, np.array([10, 20, 30]) * 1e-9)


def test_a_topic_of_too_many_shapes_is_read_in_part(tmp_path, monkeypatch):
    monkeypatch.setattr(collect, "MAX_LAYOUTS", 3)
    given = [("/j", JOINT_STATE, i, joint_state("cdr", (f"a{i % 5}",), 0, [i])) for i in range(20)]
    found = mcap_file.read(write_mcap(tmp_path / "a.mcap", given))
    assert [t.columns[f"position[a{i}]"].tolist() for i, t in enumerate(found.tables)] == [
        [i, i + 5, i + 10, i + 15] for i in range(3)
    ]
    assert found.damage == (f"/j ({JOINT_STATE}): 8 of 20 messages are not read: they have too many shapes",)


def test_messages_that_do_not_fit_their_type_are_counted(tmp_path):
    given = [m for m in messages("cdr") if m[0] == "/joint_states"]
    given[7:9] = [(*given[7][:3], given[7][3][:-8]), (*given[8][:3], b"")]
    found = mcap_file.read(write_mcap(tmp_path / "a.mcap", given))
    assert sum(t.rows for t in found.tables) == 78
    assert len(found.damage) == 1
    assert "2 of 80 messages are not read: " in found.damage[0]


def complete_messages(data):
    """Where each joint state is complete: at the end of its record, or of its chunk. In order."""
    file = BytesIO(data)
    ends = [
        (c.message_end_time, c.chunk_start_offset + c.chunk_length)
        for c in make_reader(file).get_summary().chunk_indexes
    ]
    if ends:
        times = [m.log_time for _, c, m in make_reader(file).iter_messages() if c.topic == "/joint_states"]
        return [next(end for last, end in ends if time <= last) for time in times]
    found, at = [], 8
    while at < len(data):
        code, length = struct.unpack_from("<BQ", data, at)
        at += 9 + length
        if code == 5 and struct.unpack_from("<H", data, at - length)[0] == 1:
            found.append(at)
        if code == 15:
            return found


@pytest.mark.parametrize("form", FORMS)
def test_all_before_a_cut_is_read(form, tmp_path):
    path = write_mcap(tmp_path / "a.mcap", messages("cdr"), **FORMS[form])
    whole, data, rng = mcap_file.read(path), path.read_bytes(), np.random.default_rng(11)
    ends = complete_messages(data)
    assert len(ends) == 80
    for size in rng.integers(8, len(data), CUTS):
        path.write_bytes(data[:size])
        found = mcap_file.read(path)
        assert sum(t.rows for t in found.tables if t.name == "/joint_states") == sum(
            end <= size for end in ends
        )
        for short in found.tables:
            long = table(whole, short.name, list(short.columns)[-1])
            for name, column in short.columns.items():
                np.testing.assert_array_equal(column, long.columns[name][: short.rows])
        if size <= ends[-1]:
            rows = sum(t.rows for t in found.tables)
            assert f"of {size}; {rows} messages were read before" in found.damage[0]
            at = int(re.search(r"a\.mcap: .* at byte (\d+) of", found.damage[0]).group(1))
            assert max([end for end in ends if end <= size], default=8) <= at <= size


@pytest.mark.parametrize("form", ["plain", "zstd", "lz4"])
def test_a_corrupt_chunk_is_skipped(form, tmp_path):
    path = write_mcap(tmp_path / "a.mcap", messages("cdr"), **FORMS[form])
    with path.open("rb") as file:
        chunks = make_reader(file).get_summary().chunk_indexes
    whole, data = mcap_file.read(path), bytearray(path.read_bytes())
    for number in (0, 2):  # the first holds the schemas and channels, which the summary repeats
        broken = bytearray(data)
        middle = chunks[number].chunk_start_offset + chunks[number].chunk_length // 2
        broken[middle : middle + 4] = bytes(255 - byte for byte in broken[middle : middle + 4])
        path.write_bytes(broken)
        found = mcap_file.read(path)
        assert f"the chunk at byte {chunks[number].chunk_start_offset} is skipped" in found.damage[0]
        lost = table(whole, "/wrench", "header.stamp").rows - table(found, "/wrench", "header.stamp").rows
        assert 0 < lost < 30


def test_a_chunk_that_says_it_is_huge_is_not_unpacked(tmp_path):
    path = write_mcap(tmp_path / "a.mcap", messages("cdr"), **FORMS["zstd"])
    with path.open("rb") as file:
        start = make_reader(file).get_summary().chunk_indexes[0].chunk_start_offset
    data = bytearray(path.read_bytes())
    data[start + 25 : start + 33] = struct.pack("<Q", MAX_CHUNK + 1)
    path.write_bytes(data)
    assert "its sizes are not possible" in mcap_file.read(path).damage[0]


@pytest.mark.parametrize("data", [b"", b"\x89MCAP", b"no bag at all, but long enough"])
def test_other_files_are_refused(data, tmp_path):
    path = tmp_path / "a.mcap"
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"a\.mcap: must"):
        mcap_file.read(path)


@pytest.mark.parametrize("form", [*FORMS, "unchecked"])
def test_mutated_files_end_in_typed_errors(form, tmp_path):
    forms = FORMS | {"unchecked": {"chunk_size": 4000, "enable_crcs": False}}
    data = write_mcap(tmp_path / "a.mcap", messages("cdr", 20), **forms[form]).read_bytes()
    rng, path, read = np.random.default_rng(17), tmp_path / "b.mcap", 0
    for _ in range(MUTATIONS // len(forms)):
        path.write_bytes(mutated(rng, data))
        try:
            read += len(mcap_file.read(path, lambda topic, kind: True).tables) > 0
        except InputError:
            continue
    assert read > MUTATIONS // len(forms) // 4


@pytest.mark.shared
def test_files_of_rosbag2_itself():
    found = mcap_file.read(REAL / "cdr_test_0.mcap", lambda topic, kind: True)
    assert found.damage == ()
    assert {(t.name, t.rows) for t in found.tables} == {("/test_topic", 3), ("/array_topic", 4)}
    arrays = table(found, "/array_topic", "alignment_check")
    assert arrays.columns["float64_values_default[0]"].tolist() == [3.1415] * 4
    wrong = mcap_file.read(REAL / "wrong_rmw_test_0.mcap", lambda topic, kind: True)
    assert wrong.tables == ()
    assert "serialised as 'wrong_format'" in wrong.left_out[0]
    services = mcap_file.read(REAL / "topics_and_services.mcap")
    assert services.tables == services.damage == ()
    assert any("_service_event" in line for line in services.left_out)
