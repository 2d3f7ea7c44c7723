"""The node of a bridge: what it publishes for joint states, and what it does with those it cannot use."""

from __future__ import annotations

import numpy as np
import pytest
from bridge_arm import (
    HELD,
    LINK,
    NAMES,
    POINT,
    PUSH,
    ROBOT,
    START,
    STEP,
    ZERO,
    Q,
    configuration,
    efforts,
    is_the_push,
    node,
    on,
    reading,
    run,
    true_wrench,
)

import contactsense as cs
from contactsense.bridge.counts import ERROR, OK, WARNING
from contactsense.bridge.node import ContactNode
from contactsense.bridge.values import Drawing, Health
from contactsense.offline.ros_messages import Marker

TORQUE, CONTACTS, OTHERS, MARKERS = (
    f"/contactsense/{name}" for name in ("external_torque", "contacts", "contacts_not_located", "markers")
)
NAN = np.nan


@pytest.fixture(scope="module")
def pushed() -> list:
    """What is published while the arm is pushed from tick 300 to 700, of 1000."""
    return run(node(), efforts(1000, range(300, 700)))


def health(bridge: ContactNode, now: float = 1.0) -> Health:
    topic, output = bridge.health(START, now)
    assert topic == "/diagnostics"
    assert isinstance(output, Health)
    return output


def test_every_state_gives_a_torque_with_its_stamp(pushed: list) -> None:
    torques = on(pushed, TORQUE)
    assert [it.stamp for it in torques] == [START + STEP * tick for tick in range(1000)]
    assert torques[0].names == NAMES
    assert np.abs(torques[600].torque - PUSH).max() < 0.3
    assert np.abs(torques[250].torque).max() < 0.3


def test_torques_are_those_of_a_monitor() -> None:
    rows = efforts(200, range(100, 200))
    monitor = cs.ContactMonitor(ROBOT, dt=1e-3, torque_threshold=0.8)
    wanted = [monitor.update(Q, ZERO, row, dt=None if k == 0 else 1e-3) for k, row in enumerate(rows)]
    found = on(run(node(), rows), TORQUE)
    assert np.allclose([it.torque for it in found], [it.external_torque for it in wanted], atol=1e-9)


def test_a_contact_comes_as_a_wrench_at_its_links_origin_in_its_axes(pushed: list) -> None:
    found = on(pushed[450:700], CONTACTS)
    assert len(found) == 250
    assert all(is_the_push(it) for it in found)
    assert found[0].stamp == START + 450 * STEP
    # Axes of the link are turned against the world here, so that this would see the wrong ones.
    world = cs.ContactMonitor(ROBOT, dt=1e-3, torque_threshold=0.8)
    for row in efforts(450, range(300, 450)):
        report = world.update(Q, ZERO, row, dt=1e-3)
    assert np.abs(report.contacts[0].wrench - true_wrench()).max() > 10.0


def test_contacts_that_are_not_located_have_a_topic_of_their_own(pushed: list) -> None:
    assert on(pushed[:300], CONTACTS) == on(pushed[:300], OTHERS) == []
    for tick in pushed:
        assert len([name for name, _ in tick if name in (CONTACTS, OTHERS)]) <= 1
    # A push on the second link moves two joints only: nothing says where it is.
    pose = ROBOT.link_pose(Q, "iiwa_link_2")
    push = ROBOT.jacobian(Q, "iiwa_link_2", point=pose[:3, 3] + [0.0, 0.0, 0.1])[:3].T @ [40.0, 40.0, 0.0]
    found = run(node(), efforts(300) - push)
    assert on(found, CONTACTS) == []
    drawn = [it for drawings in on(found, MARKERS) for it in drawings.drawings if it.points]
    assert {it.namespace for it in drawn} == {"text"}
    assert all(it.text.startswith("not located: ") for it in drawn)
    assert "iiwa_link_2" in drawn[-1].text


def test_markers_come_at_a_limited_rate_and_at_each_end(pushed: list) -> None:
    ticks = [k for k, tick in enumerate(pushed) if any(name == MARKERS for name, _ in tick)]
    began = next(k for k, tick in enumerate(pushed) if k >= 300 and len(tick) > 1)
    assert ticks[0] == began
    steps = np.diff(ticks)
    assert np.all(steps[:-1] >= 33)
    # The last removes all that was shown.
    (last,) = on([pushed[ticks[-1]]], MARKERS)
    assert {it.namespace for it in last.drawings} == {"point", "force", "text"}
    assert not any(it.points for it in last.drawings)
    assert ticks[-1] > 700


def test_markers_show_point_force_and_words(pushed: list) -> None:
    drawings = on(pushed[500:600], MARKERS)[0]
    assert drawings.frame == "iiwa_link_0"
    by_name: dict[str, Drawing] = {it.namespace: it for it in drawings.drawings}
    assert by_name["point"].shape == Marker.SPHERE
    assert np.abs(by_name["point"].points[0] - POINT).max() < 0.05
    tail, head = by_name["force"].points
    assert np.allclose(head, by_name["point"].points[0])
    assert np.abs((head - tail) / 0.01 - [38.0, 0.0, 13.0]).max() < 3.0
    assert by_name["text"].text.startswith(f"{LINK}, 40 N, 90 % within ")


def test_markers_that_are_no_longer_true_are_removed() -> None:
    """Where a contact was located and is not any more, point and force go."""
    shown: set[tuple[str, int]] = set()
    bridge = node("marker_rate: 1000.0\n")
    for tick in run(bridge, efforts(1000, range(300, 700), seed=3)):
        located = any(name == CONTACTS for name, _ in tick)
        for _, output in (it for it in tick if it[0] == MARKERS):
            for it in output.drawings:
                (shown.add if it.points else shown.discard)((it.namespace, it.number))
            assert ("point" in {name for name, _ in shown}) >= located
    assert shown == set()


def test_joints_are_taken_by_name() -> None:
    order = np.random.default_rng(1).permutation(7)
    names = ("finger", *(NAMES[k] for k in order))
    first = on(run(node(), efforts(100, range(50, 100))), TORQUE)
    bridge = node()
    for k, row in enumerate(efforts(100, range(50, 100))):
        more = [np.concatenate([[0.02], it[order]]) for it in (Q, ZERO, row)]
        (published,) = [
            output
            for topic, output in bridge.take(
                reading(k, names=names, position=more[0], velocity=more[1], effort=more[2]), 1e-3 * k
            )
            if topic == TORQUE
        ]
        assert np.array_equal(published.torque, first[k].torque)
    assert published.names == NAMES


def test_prefixes_of_names_do_not_matter() -> None:
    bridge = node()
    assert bridge.take(reading(0, names=tuple(f"left/{name}" for name in NAMES)), 0.0)


def test_messages_of_other_joints_are_no_fault() -> None:
    bridge = node()
    for tick in range(10):
        assert bridge.take(reading(2 * tick), 2e-3 * tick)
        other = reading(
            2 * tick + 1, names=("finger",), position=ZERO[:1], velocity=ZERO[:1], effort=ZERO[:1]
        )
        assert bridge.take(other, 2e-3 * tick) == []
    assert (bridge.counts.other_joints, bridge.counts.refused) == (10, 0)


def test_fingers_that_are_called_like_joints_are_other_joints() -> None:
    bridge = node()
    two = {"position": Q[:2], "velocity": ZERO[:2], "effort": ZERO[:2]}
    fingers = ("finger_joint_1", "finger_joint_2")
    bridge.take(reading(0, names=fingers, **two), 0.0)
    assert bridge.counts.refused == 1  # nothing says yet that these are not the arm's
    bridge.take(reading(1), 1e-3)
    for _ in range(3):
        assert bridge.take(reading(2, names=fingers, **two), 2e-3) == []
    assert (bridge.counts.refused, bridge.counts.other_joints) == (1, 3)


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"names": NAMES[:-1]}, "joints are missing: iiwa_joint_7"),
        ({"names": (*NAMES[:-1], NAMES[0])}, "stands there twice"),
        ({"names": tuple(f"joint_{k}" for k in range(10_000))}, "10000 joints; at most 256"),
        ({"position": Q[:5]}, "position: has 5 numbers for 7 joints"),
        ({"position": np.append(Q, 0.0)}, "position: has 8 numbers for 7 joints"),
        ({"velocity": np.zeros(0)}, "velocity: is empty"),
        ({"effort": np.zeros(0)}, "effort: is empty"),
        ({"effort": np.append(HELD[:6], NAN)}, "NaN"),
        ({"velocity": np.full(7, NAN)}, "NaN"),
        ({"position": np.full(7, np.inf)}, "inf"),
        ({"position": None}, "TypeError"),
        ({"stamp": "now"}, "TypeError"),
    ],
)
def test_what_cannot_be_used_is_counted_with_its_reason(changed: dict, reason: str) -> None:
    bridge = node()
    bridge.start(0.0)
    assert bridge.take(reading(0), 0.0)
    assert bridge.take(reading(1, **changed), 1e-3) == []
    assert bridge.counts.refused == 1
    told = health(bridge)
    assert told.level == WARNING
    assert reason in told.values["last refused"]
    # The next one is taken in as if nothing had been.
    assert bridge.take(reading(2), 2e-3)
    assert "2 taken in, 1 refused" in bridge.summary()


def test_missing_joints_are_said() -> None:
    bridge = node()
    bridge.take(reading(0, names=("a", *NAMES[2:], "b")), 0.0)
    told = health(bridge)
    assert told.values["missing joints"] == "iiwa_joint_1, iiwa_joint_2"
    assert (told.level, told.values["collision"]) == (ERROR, "unknown")


def test_stamps_that_repeat_or_go_back_are_late() -> None:
    bridge = node()
    for tick, taken in ((0, True), (1, True), (1, False), (0, False), (2, True)):
        assert bool(bridge.take(reading(tick), 1e-3 * tick)) == taken
    assert (bridge.counts.late, bridge.counts.refused) == (2, 2)


def test_a_clock_that_is_set_back_starts_anew() -> None:
    bridge = node()
    run(bridge, efforts(500, range(300, 500)))
    again = run(bridge, efforts(200), first=-5000)
    assert len(on(again, TORQUE)) == 200
    # Of what was before, nothing is left.
    assert np.abs(on(again, TORQUE)[0].torque).max() < 0.3
    assert health(bridge).values["clock set back"] == "1"


def test_a_stamp_from_the_future_does_not_stop_it() -> None:
    bridge = node()
    run(bridge, efforts(10))
    bridge.take(reading(0, stamp=START + 10**18), 0.01)
    assert len(on(run(bridge, efforts(10), first=11), TORQUE)) == 10


def test_messages_without_stamps_follow_each_other_at_the_configured_rate() -> None:
    bridge = node()
    rows = efforts(400, range(100, 400))
    found = [bridge.take(reading(0, row, stamp=0), 0.0) for row in rows]
    assert is_the_push(on(found, CONTACTS)[-1])


def test_gaps_are_counted_and_bridged() -> None:
    bridge = node()
    run(bridge, efforts(100))
    found = run(bridge, efforts(300, range(300)), first=140)
    assert is_the_push(on(found, CONTACTS)[-1])
    told = health(bridge).values
    assert (told["gaps"], told["longest gap [s]"]) == ("1", "0.041")


def test_the_external_torque_of_a_vendor_is_taken_as_it_is() -> None:
    bridge = node("effort: external\n")
    found = run(bridge, np.tile(PUSH, (300, 1)))
    assert np.allclose(on(found, TORQUE)[-1].torque, PUSH)
    assert is_the_push(on(found, CONTACTS)[-1])


def test_efforts_are_scaled_by_torque_constants() -> None:
    constants = [-1.0, 0.5, 0.1, 2.0, 1.0, -0.1, 1.0]
    wanted = on(run(node(), efforts(200, range(100, 200))), TORQUE)
    found = on(
        run(node(f"torque_constants: {constants}\n"), efforts(200, range(100, 200)) / constants), TORQUE
    )
    assert np.allclose([it.torque for it in found], [it.torque for it in wanted])
    turned = run(node("effort: external\ntorque_constants: -1\n"), np.tile(-PUSH, (300, 1)))
    assert np.allclose(on(turned, TORQUE)[-1].torque, PUSH)


SENSOR = "sensors: {wrist: {link: iiwa_link_7, topic: /wrist/wrench}}\n"


def test_sensors_are_read_by_topic_until_their_readings_are_old() -> None:
    bridge = node(SENSOR)
    bridge.start(0.0)
    bridge.take(reading(0), 0.0)
    assert health(bridge, 0.1).message == "no reading of wrist"
    bridge.take_wrench("/wrist/wrench", np.array([0.0, 0.0, 50.0, 0.0, 0.0, 0.0]), 0.001)
    bridge.take_wrench("/other", np.zeros(6), 0.001)
    for tick in (1, 2):  # the first reading starts its filter
        assert bridge.take(reading(tick), 1e-3 * tick)
    assert health(bridge, 0.2).values["sensors without reading"] == ""
    bridge.take_wrench("/wrist/wrench", np.array([np.inf, 0.0, 0.0, 0.0, 0.0, 0.0]), 0.003)
    assert bridge.take(reading(3), 0.003)
    assert health(bridge, 0.25).values["sensors without reading"] == "wrist"
    bridge.take_wrench("/wrist/wrench", np.array([0.0, 0.0, 50.0, 0.0, 0.0, 0.0]), 0.004)
    for tick in (4, 5):
        assert bridge.take(reading(tick), 1e-3 * tick)
    bridge.take(reading(6), 0.2)
    assert health(bridge, 0.3).values["sensors without reading"] == "wrist"


def test_a_contact_behind_a_sensor_is_found_by_it() -> None:
    bridge = node(SENSOR)
    rows = efforts(300)
    found = []
    for tick, row in enumerate(rows):
        push = 40.0 if tick >= 150 else 0.0
        bridge.take_wrench("/wrist/wrench", np.array([push, 0.0, 0.0, 0.0, 0.0, 0.0]), 1e-3 * tick)
        found.append(bridge.take(reading(tick, row), 1e-3 * tick))
    told = [it.link for tick in found for name, it in tick if name in (CONTACTS, OTHERS)]
    assert told
    assert set(told) <= {"iiwa_link_7", "iiwa_link_ee"}


def test_diagnostics_say_how_it_is() -> None:
    bridge = node()
    bridge.start(0.0)
    run(bridge, efforts(1000, range(900, 1000)))
    told = health(bridge)
    assert (told.level, told.message, told.robot) == (OK, "running", "iiwa14")
    assert told.values["messages"] == told.values["taken in"] == "1000"
    assert (told.values["rate [Hz]"], told.values["collision"]) == ("1000.0", "true")
    assert (told.values["contacts"], told.values["links"]) == ("1", LINK)
    assert 0.0 < float(told.values["tick, mean [us]"]) <= float(told.values["tick, longest [us]"])
    # Nothing came since: whether there is a contact is not known.
    silent = health(bridge, 2.0)
    assert (silent.level, silent.message) == (ERROR, "no joint states")
    assert silent.values["collision"] == "unknown"


def test_another_rate_than_the_configured_one_is_said() -> None:
    bridge = node("rate: 100\n")
    bridge.start(0.0)
    run(bridge, efforts(1000))
    told = health(bridge)
    assert (told.level, told.message) == (WARNING, "1000 joint states a second, not 100 as configured")


def test_losses_are_said() -> None:
    bridge = node("rate: 1\n")
    bridge.take(reading(0), 0.0)
    bridge.lose(3)
    assert health(bridge).message == "3 joint states lost"


def test_markers_are_in_the_configured_frame() -> None:
    bridge = ContactNode(configuration("frame: map\nprefix: /touch\n"), ROBOT)
    found = run(bridge, efforts(100, range(100)))
    assert on(found, "/touch/markers")[0].frame == "map"
