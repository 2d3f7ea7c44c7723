"""The pipeline with force/torque sensors: wanted contacts, wrench thresholds, sensors that say nothing."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin
import pytest
from robots import BY_NAME, RobotFile
from sensor_models import random_pose

import contactsense as cs

DT = 1e-3
PANDA = BY_NAME["panda"]
TALOS = BY_NAME["talos"]


@dataclass
class Push:
    """A force at a link's origin plus `arm`, world frame."""

    link: str
    force: tuple[float, float, float]
    arm: tuple[float, float, float] = (0.02, -0.03, 0.05)


@dataclass
class Held:
    """A robot that its motors hold still whatever pushes it; sensors read what Pinocchio says."""

    file: RobotFile
    sensors: list[cs.ForceTorqueSensor]
    pushes: list[Push] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.robot, self.model = self.file.robot(), self.file.model()
        self.data = self.model.createData()
        rng = np.random.default_rng(7)
        self.q = pin.integrate(self.model, pin.neutral(self.model), rng.uniform(-0.4, 0.4, self.model.nv))
        self.zero = np.zeros(self.model.nv)
        self.weight = self.robot.inverse_dynamics(self.q, self.zero, self.zero)

    def torque(self) -> np.ndarray:
        """External torque of the pushes, `(nv,)`."""
        total = np.zeros(self.model.nv)
        for push in self.pushes:
            point = self.robot.link_pose(self.q, push.link)[:3, 3] + push.arm
            total += self.robot.jacobian(self.q, push.link, point)[:3].T @ push.force
        return total

    def readings(self) -> np.ndarray:
        """What still sensors at moving joints read: pushes and weights behind them, sensor axes."""
        pin.framesForwardKinematics(self.model, self.data, self.q)
        rows = []
        for sensor in self.sensors:
            frame = self.model.getFrameId(sensor.link, pin.FrameType.BODY)
            place = self.data.oMf[frame] * pin.SE3(sensor.pose)
            behind = self.model.subtrees[self.model.frames[frame].parentJoint]
            total = np.zeros(6)
            for body in behind:
                inertia = self.model.inertias[body]
                com = self.data.oMi[body].act(inertia.lever)
                weight = inertia.mass * self.model.gravity.linear
                total += np.r_[weight, np.cross(com - place.translation, weight)]
            for push in self.pushes:
                link = self.model.frames[self.model.getFrameId(push.link, pin.FrameType.BODY)]
                if link.parentJoint in list(behind):
                    point = self.robot.link_pose(self.q, push.link)[:3, 3] + push.arm
                    total += np.r_[push.force, np.cross(point - place.translation, push.force)]
            turn = place.rotation.T * (1.0 if sensor.convention == "load" else -1.0)
            rows.append(np.r_[turn @ total[:3], turn @ total[3:]])
        return np.reshape(rows, (-1, 6))

    def tick(
        self, monitor: cs.ContactMonitor, *, silent: tuple[int, ...] = (), dt: float | None = None
    ) -> cs.ContactReport:
        readings = self.readings()
        readings[list(silent), 2] = np.nan
        return monitor.update(self.q, self.zero, self.weight - self.torque(), readings, dt=dt)

    def settle(self, monitor: cs.ContactMonitor, ticks: int = 100, **options) -> cs.ContactReport:
        for _ in range(ticks):
            report = self.tick(monitor, **options)
        return report


def arm(*links: str, wanted: tuple[str, ...] = (), **options: object) -> tuple[Held, cs.ContactMonitor]:
    rng = np.random.default_rng(8)
    sensors = [
        cs.ForceTorqueSensor(link, link, pose=random_pose(rng), convention=("load", "support")[k % 2])
        for k, link in enumerate(links)
    ]
    held = Held(PANDA, sensors)
    options = {"observer_gain": 200.0, "torque_threshold": 0.1, "hold_time": 0.01} | options
    return held, cs.ContactMonitor(held.robot, dt=DT, sensors=sensors, wanted_contacts=wanted, **options)


def test_wrenches_are_compensated() -> None:
    held, monitor = arm("panda_link4", "panda_link6")
    report = held.settle(monitor)
    assert not report.collision
    np.testing.assert_allclose(report.wrenches, 0.0, atol=1e-9)
    held.pushes = [Push("panda_link7", (3.0, -4.0, 5.0))]
    report = held.settle(monitor)
    for sensor, wrench in zip(held.sensors, report.wrenches, strict=True):
        pose = held.robot.link_pose(held.q, sensor.link) @ sensor.pose
        point = held.robot.link_pose(held.q, "panda_link7")[:3, 3] + held.pushes[0].arm
        np.testing.assert_allclose(wrench[:3], [3.0, -4.0, 5.0], atol=1e-8)
        np.testing.assert_allclose(wrench[3:], np.cross(point - pose[:3, 3], [3.0, -4.0, 5.0]), atol=1e-8)


def test_a_wanted_contact_is_no_collision() -> None:
    held, monitor = arm("panda_link6", wanted=("panda_link6",))
    held.settle(monitor, 5)
    held.pushes = [Push("panda_link7", (30.0, -20.0, 10.0))]
    reports = [held.tick(monitor) for _ in range(200)]
    np.testing.assert_allclose(reports[-1].external_torque, held.torque(), atol=1e-6)
    np.testing.assert_allclose(reports[-1].collision_torque, 0.0, atol=1e-6)
    # What a step adds within a tick is open; past it nothing is left of it.
    assert not any(report.collision for report in reports[40:])
    held.pushes.append(Push("panda_link3", (0.0, 40.0, 10.0)))
    report = held.settle(monitor)
    assert report.collision
    assert "panda_link3" in report.links or "panda_link2" in report.links
    only = Held(PANDA, [], held.pushes[1:])
    # Joints at and behind the wanted sensor are left out.
    assert report.joints_left_out[0] == "panda_joint6"
    np.testing.assert_allclose(report.collision_torque[:5], only.torque()[:5], atol=1e-6)
    np.testing.assert_array_equal(report.collision_torque[5:], 0.0)


@pytest.mark.parametrize("gain", [20.0, 200.0, 5000.0])
def test_a_changing_wanted_contact_leaves_no_trace(gain: float) -> None:
    """A force that moves faster than the observer: both are lagged alike."""
    held, monitor = arm("panda_link6", wanted=("panda_link6",), observer_gain=gain, torque_threshold=0.5)
    held.settle(monitor, 5)
    worst, peak = 0.0, 0.0
    for k in range(400):
        force = 40.0 * np.sin(2.0 * np.pi * 10.0 * k * DT) * np.array([0.6, -0.5, 0.6])
        held.pushes = [Push("panda_link7", tuple(force))]
        report = held.tick(monitor)
        worst = max(worst, np.abs(report.collision_torque).max())
        peak = max(peak, np.abs(report.external_torque).max())
    # Held still, the robot's true acceleration is zero; the observed one is not, while the force changes.
    assert worst < 0.02 * max(peak, 20.0)


def test_without_lag_a_fast_wanted_contact_would_alarm() -> None:
    """What the low-pass is for: the sensor's torque at once, less the observer's, is a large false signal."""
    held, monitor = arm("panda_link6", wanted=("panda_link6",), observer_gain=20.0)
    held.settle(monitor, 5)
    worst = 0.0
    for k in range(100):
        force = 40.0 * np.sin(2.0 * np.pi * 10.0 * k * DT) * np.array([0.6, -0.5, 0.6])
        held.pushes = [Push("panda_link7", tuple(force))]
        report = held.tick(monitor)
        worst = max(worst, np.abs(report.external_torque - held.torque())[:5].max())
    assert worst > 2.0


def test_a_fast_contact_on_a_free_arm_is_no_collision() -> None:
    """The arm gives way, so that the compensation needs the acceleration before the observer knows it."""
    held, monitor = arm("panda_link6", wanted=("panda_link6",), observer_gain=500.0, torque_threshold=0.5)
    model, data = held.model, held.data
    frame = model.getFrameId("panda_link6", pin.FrameType.BODY)
    joint, place = model.frames[frame].parentJoint, pin.SE3(held.sensors[0].pose)
    stiffness = np.array([200.0, 200.0, 200.0, 100.0, 50.0, 20.0, 10.0, 500.0, 500.0])
    q, v, substeps = held.q.copy(), np.zeros(model.nv), 10
    hand = model.getJointId("panda_joint7")
    false, felt = 0.0, 0.0
    for k in range(150):
        for part in range(substeps):
            time = (k + part / substeps) * DT
            force = 60.0 * max(0.0, np.sin(2.0 * np.pi * 20.0 * (time - 0.02))) * np.array([0.7, -0.5, 0.5])
            tau = held.weight - stiffness * (q - held.q) - 2.0 * v
            pin.forwardKinematics(model, data, q)
            local = data.oMi[hand].rotation.T @ force
            external = pin.StdVec_Force()
            external.extend(pin.Force.Zero() for _ in range(model.njoints))
            external[hand] = pin.Force(local, np.cross([0.03, 0.02, 0.1], local))
            a = pin.aba(model, data, q, v, tau, external).copy()
            if part == 0:
                pin.rnea(model, data, q, v, a, external)
                reading = -place.actInv(data.f[joint]).vector
                report = monitor.update(q, v, tau, reading[None])
                false = max(false, np.abs(report.collision_torque).max())
                felt = max(felt, np.abs(report.external_torque).max())
                assert not report.collision
            v = v + a * DT / substeps
            q = q + v * DT / substeps
    assert felt > 10.0
    assert false < 0.02 * felt


def test_a_sensor_narrows_the_region_down() -> None:
    # Joint 4 feels the force, the sensor before link 6 says it is before link 6.
    held, monitor = arm("panda_link6")
    held.settle(monitor, 5)
    held.pushes = [Push("panda_link5", (20.0, 10.0, -15.0))]
    report = held.settle(monitor)
    assert report.collision
    assert report.links == ("panda_link5",)
    held.pushes = [Push("panda_link7", (20.0, 10.0, -15.0))]
    report = held.settle(monitor)
    assert set(report.links) <= {"panda_link7", "panda_link8", "panda_hand"}


def test_a_sensor_alone_detects() -> None:
    held, monitor = arm("panda_link3", torque_threshold=1e3, wrench_threshold=1.0, wrench_gain=np.inf)
    held.settle(monitor, 5)
    held.pushes = [Push("panda_link5", (0.0, 0.0, 5.0))]
    report = held.tick(monitor)
    assert report.collision
    assert report.onset
    assert report.links == ("panda_link3",)
    held.pushes = []
    assert not held.settle(monitor, 50).collision


@pytest.mark.parametrize("shape", ["scalar", "six", "rows"])
def test_wrench_threshold_forms(shape: str) -> None:
    threshold = {"scalar": 10.0, "six": np.full(6, 10.0), "rows": np.array([[10.0] * 6, [0.5] * 6])}[shape]
    held, monitor = arm("panda_link3", "panda_link6", torque_threshold=1e3, wrench_threshold=threshold)
    held.settle(monitor, 5)
    held.pushes = [Push("panda_link6", (0.0, 0.0, 3.0))]
    assert held.settle(monitor, 20).collision == (shape == "rows")


def test_a_silent_sensor_passes_its_region_on() -> None:
    held, monitor = arm("panda_link4", "panda_link6", torque_threshold=1e3)
    held.settle(monitor, 5)
    held.pushes = [Push("panda_link6", (0.0, 0.0, 20.0))]
    report = held.settle(monitor)
    assert report.sensors_left_out == ()
    assert "panda_link6" in report.links
    assert "panda_link4" not in report.links
    report = held.settle(monitor, silent=(1,))
    assert report.sensors_left_out == ("panda_link6",)
    assert np.isnan(report.wrenches[1]).all()
    np.testing.assert_allclose(report.wrenches[0, :3], [0, 0, 20.0], atol=1e-8)
    assert report.collision
    assert "panda_link4" in report.links


def test_a_silent_wanted_sensor_leaves_its_chain_out() -> None:
    sensors = [cs.ForceTorqueSensor(f"{side}_foot", f"leg_{side}_6_link") for side in ("left", "right")]
    held = Held(TALOS, sensors)
    monitor = cs.ContactMonitor(
        held.robot,
        dt=DT,
        sensors=sensors,
        wanted_contacts=["left_foot", "right_foot"],
        observer_gain=200.0,
        torque_threshold=1.0,
    )
    weight = held.weight[:6].copy()
    # Two feet carry the robot: no torque at the base.
    feet = [Push(f"leg_{side}_6_link", (0.0, 0.0, 0.5 * 9.81 * 90.0)) for side in ("left", "right")]
    held.pushes = feet
    assert weight.shape == (6,)
    assert not held.settle(monitor).collision
    # Five time constants of the observer, in ticks.
    reports = [held.tick(monitor, silent=(1,)) for _ in range(50)]
    assert not any(report.collision for report in reports)
    assert reports[0].sensors_left_out == ("right_foot",)
    assert {"root_joint", "leg_right_1_joint", "leg_right_5_joint"} <= set(reports[0].joints_left_out)
    assert "leg_left_3_joint" not in reports[0].joints_left_out
    # A push on an arm is still found.
    held.pushes = [*feet, Push("arm_left_5_link", (0.0, 30.0, 0.0))]
    report = held.settle(monitor, 50, silent=(1,))
    assert report.collision
    assert all("arm_left" in link for link in report.links)
    held.pushes = feet
    held.settle(monitor, 100, silent=(1,))
    back = [held.tick(monitor) for _ in range(100)]
    assert not any(report.collision for report in back)
    assert "leg_right_1_joint" in back[0].joints_left_out
    assert "leg_right_1_joint" not in back[-1].joints_left_out


def test_a_sensor_before_a_wanted_one_sees_the_rest() -> None:
    held, monitor = arm("panda_link3", "panda_link6", wanted=("panda_link6",), torque_threshold=1e3)
    held.settle(monitor, 5)
    held.pushes = [Push("panda_link7", (30.0, 0.0, 0.0))]
    assert not held.settle(monitor).collision
    assert not held.settle(monitor, 20, silent=(1,)).collision
    held.settle(monitor, 100)
    held.pushes.append(Push("panda_link4", (0.0, 10.0, 0.0)))
    report = held.settle(monitor)
    assert report.collision
    assert "panda_link3" in report.links
    assert "panda_link7" not in report.links


def test_bias_is_tracked_beside_wanted_contacts() -> None:
    held, monitor = arm("panda_link6", wanted=("panda_link6",), bias_time_constant=0.2)
    bias = np.array([0.8, -0.6, 0.5, 0.4, 0.3, 0.0, 0.0, 0.0, 0.0])
    held.weight = held.weight - bias
    held.pushes = [Push("panda_link7", (10.0, -10.0, 20.0))]
    assert not held.settle(monitor, 1500).collision
    held.pushes = []
    report = held.settle(monitor, 300)
    # Gone with the wanted contact is nothing of the bias.
    assert not report.collision
    np.testing.assert_allclose(report.collision_torque, 0.0, atol=0.05)
    held.pushes = [Push("panda_link4", (0.0, 20.0, 0.0))]
    report = held.settle(monitor, 500)
    assert report.collision
    np.testing.assert_allclose(report.collision_torque[:5], held.torque()[:5], atol=0.1)


def test_reset_starts_anew() -> None:
    held, monitor = arm("panda_link4", "panda_link6", wanted=("panda_link6",))
    held.pushes = [Push("panda_link7", (3.0, -4.0, 5.0)), Push("panda_link5", (0.0, 9.0, 0.0))]
    first = [held.tick(monitor, silent=(1,) if k > 20 else ()) for k in range(40)]
    monitor.reset()
    second = [held.tick(monitor, silent=(1,) if k > 20 else ()) for k in range(40)]
    for a, b in zip(first, second, strict=True):
        np.testing.assert_array_equal(a.collision_torque, b.collision_torque)
        np.testing.assert_array_equal(a.wrenches, b.wrenches)
        assert (a.links, a.joints_left_out) == (b.links, b.joints_left_out)


@pytest.mark.parametrize(
    "bad",
    [None, np.zeros((1, 6)), np.zeros((3, 6)), np.zeros((2, 5)), np.zeros(12), np.full((2, 6), np.inf), "x"],
)
def test_bad_readings_are_a_missed_sample(bad: object) -> None:
    pairs = [arm("panda_link4", "panda_link6", wanted=("panda_link6",)) for _ in range(2)]
    for held, _ in pairs:
        held.pushes = [Push("panda_link5", (3.0, -4.0, 5.0))]
    for k in range(20):
        (held, clean), (_, disturbed) = pairs
        with pytest.raises(cs.InputError, match="wrenches"):
            disturbed.update(held.q, held.zero, held.weight, bad)
        a, b = held.tick(clean, dt=2 * DT if k > 0 else None), held.tick(disturbed)
        np.testing.assert_array_equal(a.collision_torque, b.collision_torque)
        np.testing.assert_array_equal(a.wrenches, b.wrenches)
        assert a.time == pytest.approx(b.time, abs=1e-12)


def test_readings_without_sensors_are_refused() -> None:
    held = Held(PANDA, [])
    monitor = cs.ContactMonitor(held.robot, dt=DT)
    with pytest.raises(cs.InputError, match="wrenches: the monitor was made without sensors"):
        monitor.update(held.q, held.zero, held.weight, np.zeros((1, 6)))
    report = monitor.update(held.q, held.zero, held.weight, np.zeros((0, 6)))
    assert report.wrenches.shape == (0, 6)
    assert report.sensors_left_out == report.joints_left_out == ()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"wanted_contacts": ["foot"]}, "wanted_contacts: there is no sensor 'foot'; the sensors are wrist"),
        ({"wanted_contacts": "wrist"}, "wanted_contacts: expected an iterable"),
        ({"wanted_contacts": [3]}, "wanted_contacts: expected an iterable"),
        ({"wrench_threshold": 0.0}, "wrench_threshold: must be positive"),
        ({"wrench_threshold": np.nan}, "wrench_threshold: must be positive"),
        ({"wrench_threshold": np.ones((2, 6))}, "wrench_threshold: expected one number"),
        ({"wrench_threshold": np.ones(5)}, "wrench_threshold"),
        ({"wrench_threshold": "x"}, "wrench_threshold"),
        ({"sensors": [None]}, "sensors: expected an iterable"),
    ],
)
def test_bad_settings_are_named(options: dict[str, object], message: str) -> None:
    robot = cs.Robot.named("iiwa14")
    arguments = {"sensors": [cs.ForceTorqueSensor("wrist", "iiwa_link_7")]} | options
    with pytest.raises(cs.InputError, match=message):
        cs.ContactMonitor(robot, dt=DT, **arguments)
