"""A log through a monitor: the answers of the live loop, and files of them."""

import json
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from log_files import DT, arm, pushed

import contactsense as cs
from contactsense.offline.summary import contacts_of

# The package has a function of the same name.
module = import_module("contactsense.offline.replay")


def monitor(**options: object) -> cs.ContactMonitor:
    return cs.ContactMonitor(arm(), dt=DT, torque_threshold=0.6, **options)


@pytest.fixture(scope="module")
def result() -> cs.Replay:
    return cs.replay(pushed(), monitor())


def test_it_says_what_the_live_loop_says_bit_for_bit(result: cs.Replay) -> None:
    live, log = monitor(), pushed()
    steps = [None, *np.diff(log.time).tolist()]
    assert log.tau is not None
    reports = [live.update(*row, dt=dt) for *row, dt in zip(log.q, log.v, log.tau, steps, strict=True)]
    ticks, found = result.ticks, result.contact_ticks
    assert [report.collision for report in reports] == ticks["collision"].tolist()
    assert [report.onset for report in reports] == ticks["onset"].tolist()
    np.testing.assert_array_equal([report.external_torque for report in reports], ticks["external_torque"])
    contacts = [contact for report in reports for contact in report.contacts]
    assert [contact.link for contact in contacts] == found["link"].tolist()
    assert [contact.id for contact in contacts] == found["id"].tolist()
    for name in ("point", "point_local", "force", "probability", "region_radius", "located"):
        np.testing.assert_array_equal([getattr(contact, name) for contact in contacts], found[name])


def test_a_contact_is_one_row(result: cs.Replay) -> None:
    (contact,) = result.contacts
    assert 0.8 <= contact.start < 0.85
    assert 1.15 < contact.end < 1.35
    assert contact.link == "iiwa_link_7"
    assert contact.link_probability > 0.5
    assert 20.0 < contact.peak_force < 30.0
    assert np.linalg.norm(contact.force) == pytest.approx(contact.peak_force)
    assert np.linalg.norm(contact.point_local - [0.06, 0.0, 0.04]) < 0.08
    assert not result.interrupted
    assert repr(result) == "Replay(2000 rows, 1 contacts)"


def test_contacts_that_are_not_followed_are_told_apart_by_time() -> None:
    result = cs.replay(pushed(), monitor(samples=0))
    assert len(result.contacts) == 1
    assert np.isnan(result.contacts[0].link_probability)


def ticks_of(radius: list[float], located: list[bool]) -> dict[str, np.ndarray]:
    """Columns of one contact, whose point's x says which tick it is of."""
    rows = len(radius)
    points = np.outer(np.arange(rows), [1.0, 0.0, 0.0])
    return {
        "time": np.arange(rows) * DT,
        "id": np.zeros(rows, dtype=int),
        "link": np.array(["iiwa_link_7"] * rows, dtype=object),
        "link_probability": np.where(np.isfinite(radius), 0.5, np.nan),
        "located": np.array(located),
        "region_radius": np.array(radius),
        **{name: points for name in ("point", "point_local", "force")},
    }


@pytest.mark.parametrize(
    ("radius", "located", "told"),
    [
        # Ahead of the posterior, a contact was located that it then does not locate.
        ([np.nan, 0.2, 0.3], [True, False, False], 2),
        ([np.nan, 0.02, 0.3], [True, True, False], 1),
        ([np.nan, np.nan, np.nan], [True, True, False], 1),
        ([np.nan, np.nan, np.nan], [False, False, False], 2),
    ],
)
def test_the_place_is_what_the_posterior_says(radius: list[float], located: list[bool], told: int) -> None:
    (contact,) = contacts_of(ticks_of(radius, located))
    assert contact.point[0] == told
    assert contact.located == located[told]


def test_an_external_torque_alone_is_enough(result: cs.Replay) -> None:
    log = pushed()
    external = cs.Log(log.time, log.q, log.v, external_torque=result.ticks["external_torque"])
    assert len(cs.replay(external, monitor()).contacts) == 1


def test_ctrl_c_keeps_what_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_CHUNK", 500)

    def stop(done: int, rows: int) -> None:
        assert rows == 2000
        if done == 1500:
            raise KeyboardInterrupt

    result = cs.replay(pushed(), monitor(), on_progress=stop)
    assert result.interrupted
    assert len(result.ticks["time"]) == 1500
    assert len(result.contacts) == 1


def test_chunks_do_not_show(result: cs.Replay, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_CHUNK", 333)
    other = cs.replay(pushed(), monitor())
    np.testing.assert_array_equal(other.ticks["external_torque"], result.ticks["external_torque"])
    np.testing.assert_array_equal(other.contact_ticks["point"], result.contact_ticks["point"])


def test_a_log_of_another_robot_is_refused() -> None:
    log = pushed()
    assert log.tau is not None
    short = cs.Log(log.time, log.q[:, :6], log.v[:, :6], log.tau[:, :6])
    with pytest.raises(cs.InputError, match="log: has q 6 and v 6 columns"):
        cs.replay(short, monitor())
    with_sensors = cs.Log(log.time, log.q, log.v, log.tau, wrenches=np.zeros((len(log), 1, 6)))
    with pytest.raises(cs.InputError, match="wrenches of 1 sensors; the monitor has 0"):
        cs.replay(with_sensors, monitor())
    with pytest.raises(cs.InputError, match=r"log: expected a contactsense\.Log"):
        cs.replay([], monitor())  # type: ignore[arg-type]


def test_readings_of_sensors_are_passed_on() -> None:
    sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_7")
    log = pushed()
    readings = np.full((len(log), 1, 6), np.nan)
    with_sensors = cs.Log(log.time, log.q, log.v, log.tau, wrenches=np.zeros_like(readings))
    told = cs.replay(with_sensors, monitor(sensors=[sensor]))
    live = monitor(sensors=[sensor])
    steps = [None, *np.diff(log.time).tolist()]
    assert log.tau is not None
    rows = zip(log.q, log.v, log.tau, steps, strict=True)
    live_torque = [live.update(q, v, tau, [np.zeros(6)], dt=dt).external_torque for q, v, tau, dt in rows]
    np.testing.assert_array_equal(live_torque, told.ticks["external_torque"])


def test_json_lines(result: cs.Replay, tmp_path: Path) -> None:
    file = tmp_path / "contacts.jsonl"
    result.to_json_lines(file)
    (line,) = file.read_text().splitlines()
    assert json.loads(line) == result.contacts[0].to_dict()
    assert list(tmp_path.iterdir()) == [file]


def test_parquet_has_one_schema_with_and_without_contacts(result: cs.Replay, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    none = cs.replay(pushed()[:500], monitor())
    assert none.contacts == ()
    result.to_parquet(tmp_path / "some")
    none.to_parquet(tmp_path / "none")
    for name in ("contacts", "contact_ticks", "ticks"):
        some = parquet.read_table(tmp_path / "some" / f"{name}.parquet")
        assert some.schema == parquet.read_table(tmp_path / "none" / f"{name}.parquet").schema
    table = parquet.read_table(tmp_path / "some" / "contacts.parquet").to_pylist()
    assert table[0]["link"] == "iiwa_link_7"
    assert table[0]["point"] == result.contacts[0].point.tolist()


def test_mcap_holds_the_log_and_what_was_found(result: cs.Replay, tmp_path: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    typesys = pytest.importorskip("rosbags.typesys")
    file = tmp_path / "a.mcap"
    result.to_mcap(file)
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    with file.open("rb") as stream:
        messages = [
            (channel.topic, store.deserialize_cdr(message.data, schema.name), message.log_time)
            for schema, channel, message in reader.make_reader(stream).iter_messages()
        ]
    states = [message for topic, message, _ in messages if topic == "/joint_states"]
    torques = [message for topic, message, _ in messages if topic == "/contactsense/external_torque"]
    markers = [message for topic, message, _ in messages if topic == "/contactsense/contacts"]
    assert len(states) == len(torques) == 2000
    assert states[0].name == list(arm().actuated_joint_names)
    np.testing.assert_array_equal([state.position for state in states], pushed().q)
    np.testing.assert_array_equal([it.effort for it in torques], result.ticks["external_torque"])
    placed = np.isfinite(result.contact_ticks["point"]).all(axis=1)
    assert len(markers) == np.count_nonzero(placed)
    # It is a log itself.
    again = cs.read_log(file, arm(), topics=["/joint_states"])
    np.testing.assert_array_equal(again.q, pushed().q)


def test_a_file_appears_whole_or_not_at_all(
    result: cs.Replay, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "contacts.jsonl"
    file.write_text("before")

    def broken(_: object) -> None:
        raise OSError("the disk is full")

    monkeypatch.setattr(cs.ReplayedContact, "to_dict", broken)
    with pytest.raises(OSError, match="disk is full"):
        result.to_json_lines(file)
    assert file.read_text() == "before"
    assert list(tmp_path.iterdir()) == [file]
