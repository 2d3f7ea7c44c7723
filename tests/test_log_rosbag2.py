"""Bags of rosbag2: SQLite files, folders with several parts, and compressed ones; whole, cut and broken."""

import sqlite3

import numpy as np
import pytest
import yaml
import zstandard
from bag_files import (
    CUTS,
    JOINT_STATE,
    MUTATIONS,
    joint_state,
    messages,
    mutated,
    write_mcap,
    write_sqlite,
)
from robots import SHARED

from contactsense import InputError
from contactsense.log.formats import mcap_file, rosbag2_folder, rosbag2_sqlite

REAL = SHARED / "real"
PAGE = 512  # the smallest page of SQLite: interior pages come early, and rows flow over into further pages


def rows_of(recording, name="/joint_states"):
    return sum(t.rows for t in recording.tables if t.name == name)


def same(first, second):
    assert [(t.name, t.kind) for t in first.tables] == [(t.name, t.kind) for t in second.tables]
    for one, other in zip(first.tables, second.tables, strict=True):
        assert list(one.columns) == list(other.columns)
        np.testing.assert_array_equal(one.received, other.received)
        for name, column in one.columns.items():
            np.testing.assert_array_equal(column, other.columns[name])


@pytest.mark.parametrize("page_size", [512, 4096, 65536])
@pytest.mark.parametrize("packs", [False, True])
def test_sqlite_holds_the_same_as_mcap(packs, page_size, tmp_path):
    given = messages("cdr")
    found = rosbag2_sqlite.read(write_sqlite(tmp_path / "a.db3", given, page_size, packs=packs))
    assert found.damage == ()
    assert rows_of(found) == 80
    same(found, mcap_file.read(write_mcap(tmp_path / "a.mcap", given)))


def test_many_topics_and_odd_times(tmp_path):
    """Topic numbers of two bytes, times before 1970 and small ones, rows with numbers of their own."""
    given = [
        (f"/j{i}", JOINT_STATE, time, joint_state("cdr", ("a",), 0, [i]))
        for i, time in enumerate([-5, 0, 1, 300, 2**40] * 60)
    ]
    path = write_sqlite(tmp_path / "a.db3", given)
    with sqlite3.connect(path) as base:
        base.execute("UPDATE messages SET id = id + 3000000000 WHERE id > 200")
    base.close()
    found = rosbag2_sqlite.read(path)
    assert found.damage == ()
    assert [t.columns["position[a]"].item() for t in found.tables] == list(range(300))
    assert [t.received.item() for t in found.tables] == [time * 1e-9 for _, _, time, _ in given]


def killed_recorder(folder, given, page_size=4096, pages=10**6):
    """Copies of file and log of a recorder that is killed: of most rows, only the log has them."""
    path = write_sqlite(folder / "open.db3", given[:20], page_size)
    base = sqlite3.connect(path)
    base.execute("PRAGMA journal_mode=WAL")
    base.execute(f"PRAGMA wal_autocheckpoint={pages}")
    other = write_sqlite(folder / "other.db3", given, page_size)
    base.execute("ATTACH ? AS other", (str(other),))
    for first in range(0, len(given), 7):  # a few rows at a time
        base.execute(
            "INSERT INTO main.messages SELECT * FROM other.messages WHERE id > ? AND id <= ? AND id > 20",
            (first, first + 7),
        )
        base.commit()
    base.execute("INSERT OR IGNORE INTO main.topics SELECT * FROM other.topics")
    base.commit()
    killed = folder / "killed"
    killed.mkdir()
    copies = [killed / "a.db3", killed / "a.db3-wal"]
    copies[0].write_bytes(path.read_bytes())
    copies[1].write_bytes(path.with_name("open.db3-wal").read_bytes())
    base.close()
    return other, *copies


@pytest.mark.parametrize("page_size", [512, 4096])
@pytest.mark.parametrize("pages", [4, 10**6])
def test_rows_that_wait_in_the_log_are_read(pages, page_size, tmp_path):
    other, path, log = killed_recorder(tmp_path, messages("cdr"), page_size, pages)
    assert log.stat().st_size > 0
    before = path.read_bytes(), log.read_bytes()
    found = rosbag2_sqlite.read(path)
    assert found.damage == ()
    same(found, rosbag2_sqlite.read(other))
    assert (path.read_bytes(), log.read_bytes()) == before
    assert sorted(p.name for p in path.parent.iterdir()) == ["a.db3", "a.db3-wal"]


def test_a_cut_log_gives_what_was_committed_before(tmp_path):
    _, path, log = killed_recorder(tmp_path, messages("cdr"), PAGE)
    whole = log.read_bytes()
    # As many rows as SQLite itself finds, which is that of the last commit before the cut.
    counts = []
    for end in np.random.default_rng(5).integers(0, len(whole), 30):
        log.write_bytes(whole[:end])
        found = rosbag2_sqlite.read(path)
        copy = tmp_path / f"copy{end}.db3"
        copy.write_bytes(path.read_bytes())
        copy.with_name(copy.name + "-wal").write_bytes(whole[:end])
        base = sqlite3.connect(copy)
        joints = "SELECT count(*) FROM messages JOIN topics t ON t.id = topic_id WHERE name = '/joint_states'"
        assert rows_of(found) == base.execute(joints).fetchone()[0]
        base.close()
        counts.append(rows_of(found))
    assert len(set(counts)) > 5


def test_mutated_logs_end_in_typed_errors(tmp_path):
    _, path, log = killed_recorder(tmp_path, messages("cdr"), PAGE)
    whole, rng = log.read_bytes(), np.random.default_rng(29)
    rows = []
    for _ in range(MUTATIONS):
        log.write_bytes(mutated(rng, whole))
        rows.append(rows_of(rosbag2_sqlite.read(path)))
    # Most of the rows outlive most of the changes.
    assert np.median(rows) > 40


def test_deleted_rows_do_not_come_back(tmp_path):
    path = write_sqlite(tmp_path / "a.db3", messages("cdr"), PAGE)
    with sqlite3.connect(path) as base:
        base.execute("DELETE FROM messages WHERE id > 30")
        left = base.execute(
            "SELECT count(*) FROM messages JOIN topics t ON t.id = topic_id WHERE name = '/joint_states'"
        )
        wanted = left.fetchone()[0]
    base.close()
    found = rosbag2_sqlite.read(path)
    assert found.damage == ()
    assert rows_of(found) == wanted


def test_the_file_and_its_folder_stay_as_they_are(tmp_path):
    path = write_sqlite(tmp_path / "a.db3", messages("cdr"))
    base = sqlite3.connect(path)
    base.execute("PRAGMA journal_mode=WAL")
    base.close()
    before = path.read_bytes()
    path.chmod(0o444)
    assert rows_of(rosbag2_sqlite.read(path)) == 80
    assert [p.name for p in tmp_path.iterdir()] == ["a.db3"]
    assert path.read_bytes() == before


@pytest.mark.parametrize("page_size", [512, 1024, 4096])
def test_all_before_a_cut_is_read(page_size, tmp_path):
    """What a cut file gives is what the whole one gives with all rows whose pages lie before the cut."""
    path = write_sqlite(tmp_path / "a.db3", messages("cdr", 100), page_size)
    whole, data, rng = rosbag2_sqlite.read(path), path.read_bytes(), np.random.default_rng(13)
    last = 0
    for size in np.sort(rng.integers(512, len(data), CUTS)):
        path.write_bytes(data[:size])
        found = rosbag2_sqlite.read(path)
        rows = rows_of(found)
        assert "messages were read before" in found.damage[0]
        assert rows >= last
        last = rows
        for short in found.tables:
            long = next(t for t in whole.tables if t.columns.keys() == short.columns.keys())
            place = np.searchsorted(long.received, short.received)
            np.testing.assert_array_equal(long.received[place], short.received)
            for name, column in short.columns.items():
                np.testing.assert_array_equal(column, long.columns[name][place])
        # Rows are written one after the other; the index takes a share of the pages.
        assert rows >= 0.85 * rows_of(whole) * (size - 6 * page_size) / len(data) - 8
    assert last > 0.8 * rows_of(whole)


def found_by_hand(data, page_size, stamps):
    """Stamps of rows that lie whole within leaf pages before the cut, found by their bytes."""
    whole_pages = len(data) // page_size * page_size
    return [stamp for stamp in stamps if stamp.to_bytes(8, "big") in data[:whole_pages]]


def test_every_row_on_a_page_before_the_cut_is_read(tmp_path):
    """Without an index each stamp stands once in the file, in its row; rows here do not flow over."""
    given = [m for m in messages("cdr", 100) if m[0] == "/joint_states"]
    path = write_sqlite(tmp_path / "a.db3", given, 4096)
    base = sqlite3.connect(path)
    base.execute("DROP INDEX timestamp_idx")
    base.execute("VACUUM")
    base.close()
    data, rng = path.read_bytes(), np.random.default_rng(19)
    for size in rng.integers(4096 * 3, len(data), CUTS):
        path.write_bytes(data[:size])
        wanted = found_by_hand(data[:size], 4096, [time for _, _, time, _ in given])
        found = rosbag2_sqlite.read(path)
        received = np.sort(np.concatenate([t.received for t in found.tables] or [np.zeros(0)]))
        assert set(np.array(wanted) * 1e-9) <= set(received)
        # Rows on the page that the cut goes through may come back too, if they lie before it.
        assert len(received) <= len(wanted) + 4096 // 250


@pytest.mark.parametrize("page_size", [512, 4096])
def test_mutated_files_end_in_typed_errors(page_size, tmp_path):
    data = write_sqlite(tmp_path / "a.db3", messages("cdr", 20), page_size).read_bytes()
    rng, path, read = np.random.default_rng(17), tmp_path / "b.db3", 0
    for _ in range(MUTATIONS // 2):
        path.write_bytes(mutated(rng, data))
        try:
            read += len(rosbag2_sqlite.read(path, lambda topic, kind: True).tables) > 0
        except InputError:
            continue
    assert read > MUTATIONS // 6


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "a.db3"
    for data in (b"", b"SQLite format 3\0", b"no database, whatever its name says" * 100):
        path.write_bytes(data)
        with pytest.raises(InputError, match=r"a\.db3: must"):
            rosbag2_sqlite.read(path)
    path.unlink()
    base = sqlite3.connect(path)
    base.execute("CREATE TABLE other(id INTEGER)")
    base.commit()
    base.close()
    with pytest.raises(InputError, match="must be a bag of rosbag2"):
        rosbag2_sqlite.read(path)


def write_folder(folder, *, ending=".db3", metadata=True, parts=12):
    """A bag in many parts, whose names in the order of letters are not in the order of time."""
    given = messages("cdr")
    write = write_mcap if ending == ".mcap" else write_sqlite
    names = []
    for i in range(parts):
        share = given[i * len(given) // parts : (i + 1) * len(given) // parts]
        names.append(write(folder / f"bag_{i}{ending}", share).name)
    if metadata:
        write_metadata(folder, names)
    return given


def write_metadata(folder, names):
    content = {"rosbag2_bagfile_information": {"version": 5, "relative_file_paths": names}}
    (folder / "metadata.yaml").write_text(yaml.safe_dump(content))


@pytest.mark.parametrize("ending", [".db3", ".mcap"])
@pytest.mark.parametrize("metadata", [True, False])
def test_parts_are_one_recording(metadata, ending, tmp_path):
    given = write_folder(tmp_path, ending=ending, metadata=metadata)
    (tmp_path / "notes.txt").write_text("no part")
    found = rosbag2_folder.read(tmp_path)
    assert found.damage == ()
    outside = tmp_path / "whole"
    outside.mkdir()
    same(found, rosbag2_sqlite.read(write_sqlite(outside / "a.db3", given)))


@pytest.mark.parametrize("ending", [".db3", ".mcap"])
def test_packed_parts_are_unpacked(ending, tmp_path):
    given = write_folder(tmp_path, ending=ending, metadata=False)
    names = []
    for part in list(tmp_path.iterdir()):
        packed = part.with_name(part.name + ".zstd")
        packed.write_bytes(zstandard.ZstdCompressor().compress(part.read_bytes()))
        part.unlink()
        names.append(packed.name)
    write_metadata(tmp_path, names)
    found = rosbag2_folder.read(tmp_path)
    assert found.damage == ()
    assert rows_of(found) == sum(topic == "/joint_states" for topic, *_ in given)


def test_a_cut_packed_file_is_read_up_to_the_cut(tmp_path):
    plain = write_mcap(tmp_path / "a.mcap", messages("cdr", 2000), use_chunking=False)
    packed = zstandard.ZstdCompressor(level=1).compress(plain.read_bytes())
    path = tmp_path / "a.mcap.zstd"
    path.write_bytes(packed)
    whole = rows_of(mcap_file.read(path))
    path.write_bytes(packed[: len(packed) * 2 // 3])
    found = mcap_file.read(path)
    assert whole > rows_of(found) > 0.4 * whole
    assert "messages were read before" in found.damage[-1]


def test_a_part_that_is_not_there_or_broken_is_told_of(tmp_path):
    write_folder(tmp_path)
    whole = rows_of(rosbag2_folder.read(tmp_path))
    (tmp_path / "bag_3.db3").unlink()
    (tmp_path / "bag_5.db3").write_bytes(b"nothing")
    found = rosbag2_folder.read(tmp_path)
    assert 0 < rows_of(found) < whole
    assert "bag_3.db3" in found.damage[0]
    assert "bag_5.db3" in found.damage[1]


@pytest.mark.parametrize(
    "name", ["../secret.db3", "/etc/secret.db3", "sub/secret.db3", "..\\secret.db3", "a\0.db3"]
)
def test_names_in_a_bag_lead_nowhere_else(name, tmp_path):
    bag = tmp_path / "bag"
    (bag / "sub").mkdir(parents=True)
    for folder in (tmp_path, bag / "sub"):
        write_sqlite(folder / "secret.db3", [("/secret", JOINT_STATE, 0, joint_state("cdr", ("a",), 0, [1]))])
    write_sqlite(bag / "a.db3", messages("cdr"))
    write_metadata(bag, [name, "a.db3"])
    found = rosbag2_folder.read(bag)
    assert rows_of(found, "/secret") == 0
    assert rows_of(found) == 80
    assert "a part is left out" in found.damage[0]


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "!!python/object/apply:os.system ['true']",
        "[" * 5000,
        "a: 1",
        "\0",
        "rosbag2_bagfile_information: 3",
    ],
)
def test_broken_metadata_is_told_of(text, tmp_path):
    write_folder(tmp_path, metadata=False)
    (tmp_path / "metadata.yaml").write_text(text)
    found = rosbag2_folder.read(tmp_path)
    assert rows_of(found) == 80
    assert found.damage == (
        "metadata.yaml: is not readable; the parts are taken in the order of their names",
    )


def test_a_folder_without_parts_is_refused(tmp_path):
    with pytest.raises(InputError, match="must have parts of a bag"):
        rosbag2_folder.read(tmp_path)


def test_mutated_packed_parts_and_lists_end_in_typed_errors(tmp_path):
    write_folder(tmp_path, ending=".mcap", parts=2)
    (tmp_path / "bag_1.mcap").unlink()
    packed = zstandard.ZstdCompressor().compress((tmp_path / "bag_0.mcap").read_bytes())
    (tmp_path / "bag_0.mcap").unlink()
    write_metadata(tmp_path, ["bag_0.mcap.zstd"])
    metadata = (tmp_path / "metadata.yaml").read_bytes()
    rng, read = np.random.default_rng(41), 0
    for i in range(MUTATIONS):
        (tmp_path / "bag_0.mcap.zstd").write_bytes(packed if i % 2 else mutated(rng, packed))
        (tmp_path / "metadata.yaml").write_bytes(mutated(rng, metadata) if i % 2 else metadata)
        try:
            read += len(rosbag2_folder.read(tmp_path).tables) > 0
        except InputError:
            continue
    assert read > MUTATIONS // 3


@pytest.mark.shared
@pytest.mark.parametrize(("name", "rows", "joints"), [("panda", 727, 7), ("ur10", 3441, 6)])
def test_real_arms(name, rows, joints):
    path = REAL / f"{name}_free" / f"{name}_exciting_trajectory.db3"
    found = rosbag2_sqlite.read(path)
    (arm,) = found.tables
    base = sqlite3.connect(f"file:{path}?immutable=1", uri=True)
    times = [time for (time,) in base.execute("SELECT timestamp FROM messages ORDER BY timestamp")]
    base.close()
    np.testing.assert_array_equal(arm.received, np.array(times) * 1e-9)
    assert arm.rows == rows
    assert len(arm.columns) == 1 + 3 * joints
    assert found.left_out == found.damage == ()


@pytest.mark.shared
def test_split_bag_of_rosbag2_itself(tmp_path):
    for name in ("wbag_0.mcap", "wbag_1.mcap"):
        (tmp_path / name).write_bytes((REAL / "rosbag2_files" / name).read_bytes())
    (tmp_path / "metadata.yaml").write_bytes((REAL / "rosbag2_files" / "wbag_metadata.yaml").read_bytes())
    found = rosbag2_folder.read(tmp_path)
    assert len(found.left_out) == 8
    assert [f"wbag_{i}.mcap" in line for i, line in zip((2, 3, 4), found.damage, strict=True)] == [True] * 3
