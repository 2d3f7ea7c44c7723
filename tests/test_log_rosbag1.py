"""Bags of ROS 1: the same numbers as in MCAP, all chunks before a cut, and typed errors only."""

import struct

import numpy as np
import pytest
from bag_files import CUTS, MUTATIONS, messages, mutated, write_bag, write_mcap

from contactsense import InputError
from contactsense.log.formats import mcap_file, rosbag1

FORMS = [None, "bz2", "lz4"]


def table(recording, name, column):
    return next(t for t in recording.tables if t.name == name and column in t.columns)


def rows_of(recording, name="/joint_states"):
    return sum(t.rows for t in recording.tables if t.name == name)


def chunks_of(data):
    """Begin and end of the chunks of a bag."""
    found, at = [], len(rosbag1.MAGIC)
    while at < len(data):
        (length,) = struct.unpack_from("<I", data, at)
        head = data[at + 4 : at + 4 + length]
        (size,) = struct.unpack_from("<I", data, at + 4 + length)
        end = at + 8 + length + size
        if b"op=\x05" in head:
            found.append((at, end))
        at = end
    return found


@pytest.mark.parametrize("form", FORMS)
def test_the_same_as_in_mcap(form, tmp_path):
    given = messages("ros1")
    found = rosbag1.read(write_bag(tmp_path / "a.bag", given, form))
    wanted = mcap_file.read(write_mcap(tmp_path / "a.mcap", given, "ros1"))
    assert found.damage == ()
    assert found.left_out == wanted.left_out
    assert rows_of(found) == 80
    assert [(t.name, t.kind) for t in found.tables] == [(t.name, t.kind) for t in wanted.tables]
    for one, other in zip(found.tables, wanted.tables, strict=True):
        np.testing.assert_array_equal(one.received, other.received)
        for name, column in one.columns.items():
            np.testing.assert_array_equal(column, other.columns[name])


@pytest.mark.parametrize("form", FORMS)
def test_all_before_a_cut_is_read(form, tmp_path):
    path = write_bag(tmp_path / "a.bag", messages("ros1"), form)
    whole, data, rng = rosbag1.read(path), path.read_bytes(), np.random.default_rng(23)
    chunks = chunks_of(data)
    assert len(chunks) > 5
    complete = {}  # joint states after so many chunks
    for number, (_, end) in enumerate(chunks):
        path.write_bytes(data[:end])
        complete[number + 1] = rows_of(rosbag1.read(path))
    assert complete[len(chunks)] == 80
    assert all(complete[n + 1] > complete[n] > 0 for n in range(1, len(chunks)))
    for size in rng.integers(len(rosbag1.MAGIC), len(data), CUTS):
        path.write_bytes(data[:size])
        found = rosbag1.read(path)
        assert rows_of(found) == complete.get(sum(end <= size for _, end in chunks), 0)
        for short in found.tables:
            long = table(whole, short.name, list(short.columns)[-1])
            for name, column in short.columns.items():
                np.testing.assert_array_equal(column, long.columns[name][: short.rows])
        if size < chunks[-1][1]:
            assert (
                f"of {size}; {sum(t.rows for t in found.tables)} messages were read before" in found.damage[0]
            )


@pytest.mark.parametrize("form", ["bz2", "lz4"])
def test_a_corrupt_chunk_is_skipped(form, tmp_path):
    path = write_bag(tmp_path / "a.bag", messages("ros1"), form)
    data = path.read_bytes()
    chunks = chunks_of(data)
    for number in (0, 2):  # the first holds the connections, which the index repeats
        broken, (start, end) = bytearray(data), chunks[number]
        # The middle of the compressed bytes.
        broken[(start + end) // 2 : (start + end) // 2 + 40] = b"\xff" * 40
        path.write_bytes(broken)
        found = rosbag1.read(path)
        assert f"the record at byte {start} is skipped" in found.damage[0]
        assert 40 < rows_of(found) < 80


def test_a_chunk_that_says_it_is_huge_is_not_unpacked(tmp_path):
    path = write_bag(tmp_path / "a.bag", messages("ros1"), "bz2")
    data = bytearray(path.read_bytes())
    start = data.index(b"size=", chunks_of(data)[0][0]) + 5
    data[start : start + 4] = struct.pack("<I", rosbag1.MAX_CHUNK + 1)
    path.write_bytes(data)
    assert "its size is not possible" in rosbag1.read(path).damage[0]


@pytest.mark.parametrize("order", ["conn op time", "op conn time", "time op conn"])
def test_fields_of_a_message_stand_in_any_order(order):
    fields = {"conn": b"\7\0\0\0", "op": b"\2", "time": struct.pack("<II", 5, 9)}
    parts = [name.encode() + b"=" + fields[name] for name in order.split()]
    head = b"".join(struct.pack("<I", len(part)) + part for part in parts)
    assert rosbag1.message_head(head) == (2, 7, 5_000_000_009)


@pytest.mark.parametrize("data", [b"", b"#ROSBAG V1.2\n" + b"\0" * 99, b"no bag at all"])
def test_other_files_are_refused(data, tmp_path):
    path = tmp_path / "a.bag"
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"a\.bag: must"):
        rosbag1.read(path)


@pytest.mark.parametrize("form", FORMS)
def test_mutated_files_end_in_typed_errors(form, tmp_path):
    data = write_bag(tmp_path / "a.bag", messages("ros1", 20), form).read_bytes()
    rng, path, read = np.random.default_rng(29), tmp_path / "b.bag", 0
    for _ in range(MUTATIONS // len(FORMS)):
        path.write_bytes(mutated(rng, data))
        try:
            read += len(rosbag1.read(path, lambda topic, kind: True).tables) > 0
        except InputError:
            continue
    assert read > MUTATIONS // len(FORMS) // 3
