"""The posterior over all surface with force/torque sensors and on floating bases, noisy measurements."""

from __future__ import annotations

from dataclasses import dataclass

import map_reference
import numpy as np
import pinocchio as pin
import pytest

import contactsense as cs

TORQUE = 0.1  # standard deviations [Nm]
FORCE, MOMENT = 0.5, 0.05  # of a sensor's wrench [N, Nm]
WRENCH = np.array([FORCE] * 3 + [MOMENT] * 3)
WEIGHT = 400.0  # on a foot [N]


@dataclass
class Sensed:
    """A robot with sensors at the origins of links; what they and its joints feel comes from Pinocchio."""

    robot: cs.Robot
    sensors: tuple[str, ...]
    wanted: tuple[str, ...] = ()

    def is_behind(self, link: str, sensor: str) -> bool:
        model = self.robot.model
        frame, other = (model.getFrameId(name, pin.FrameType.BODY) for name in (link, sensor))
        while frame not in (other, 0):
            frame = model.frames[frame].parentFrame
        return bool(frame == other)

    def isolator(self, **options: object) -> cs.ContactIsolator:
        return cs.ContactIsolator(
            self.robot,
            sensors=[cs.ForceTorqueSensor(name, name) for name in self.sensors],
            wanted_contacts=self.wanted,
            torque_threshold=3 * TORQUE,
            wrench_threshold=np.tile(3 * WRENCH, (len(self.sensors), 1)),
            **options,
        )

    def draw(
        self, rng: np.random.Generator, shares: dict[str, float]
    ) -> tuple[map_reference.Truth, np.ndarray, np.ndarray]:
        """A push that is not wanted, with torques and wrenches, both noisy."""
        truth = map_reference.draw(
            self.robot, rng, shares, forces=(10.0, 60.0), pull_probability=0.0, friction=0.3
        )
        data = self.robot.model.createData()
        pin.computeJointJacobians(self.robot.model, data, truth.q)
        pin.updateFramePlacements(self.robot.model, data)
        tau = truth.torque + TORQUE * rng.standard_normal(self.robot.nv)
        wrenches = WRENCH * rng.standard_normal((len(self.sensors), 6))
        for row, sensor in enumerate(self.sensors):
            frame = self.robot.model.getFrameId(sensor, pin.FrameType.BODY)
            if self.is_behind(truth.link, sensor):
                arm = truth.point - data.oMf[frame].translation
                wrenches[row] += np.concatenate([truth.force, np.cross(arm, truth.force)])
            if sensor in self.wanted:
                stance = np.concatenate([rng.normal(0.0, 60.0, 2), [WEIGHT], rng.normal(0.0, 20.0, 3)])
                tau += pin.getFrameJacobian(self.robot.model, data, frame, pin.LOCAL_WORLD_ALIGNED).T @ stance
                wrenches[row] += stance
        return truth, tau, wrenches

    def shares(self) -> dict[str, float]:
        """Shares of the surface where contacts are not wanted."""
        shares = map_reference.area_shares(self.robot)
        kept = {
            link: share
            for link, share in shares.items()
            if not any(self.is_behind(link, sensor) for sensor in self.wanted)
        }
        return {link: area / sum(kept.values()) for link, area in kept.items()}


def count(sensed: Sensed, pushes: int, seed: int, **options: object) -> dict[str, float]:
    isolator, shares = sensed.isolator(**options), sensed.shares()
    rng = np.random.default_rng(seed)
    right = located = wrong = 0
    for _ in range(pushes):
        truth, tau, wrenches = sensed.draw(rng, shares)
        contacts = isolator.isolate(truth.q, tau, wrenches).contacts
        if not contacts:
            continue
        right += contacts[0].link == truth.link
        if contacts[0].located:
            located += 1
            wrong += bool(np.linalg.norm(contacts[0].point - truth.point) > 0.01 + 3 * contacts[0].point_std)
    return {"right": right / pushes, "located": located / pushes, "wrong": wrong / max(located, 1)}


ARM = Sensed(cs.Robot.named("iiwa14"), ("iiwa_link_7", "iiwa_link_1"))
ATLAS = Sensed(cs.Robot.named("atlas"), ("l_hand", "r_hand", "l_foot", "r_foot"), ("l_foot", "r_foot"))


@pytest.mark.parametrize(
    ("sensed", "right", "located"), [(ARM, 0.85, 0.6), (ATLAS, 0.65, 0.2)], ids=["arm", "atlas"]
)
def test_wrenches_and_torques_together_place_contacts(sensed: Sensed, right: float, located: float) -> None:
    found = count(sensed, 200, seed=31)
    alone = count(sensed, 200, seed=31, samples=0)
    assert found["right"] >= max(right, alone["right"] + 0.05)
    assert found["located"] >= max(located, alone["located"])
    assert found["wrong"] <= 0.03


def test_a_sensor_that_says_nothing_leaves_the_torques() -> None:
    isolator, shares, rng = ARM.isolator(), ARM.shares(), np.random.default_rng(5)
    without = cs.ContactIsolator(ARM.robot, torque_threshold=3 * TORQUE)
    for _ in range(20):
        truth, tau, wrenches = ARM.draw(rng, shares)
        silent = isolator.isolate(truth.q, tau, np.full_like(wrenches, np.nan)).contacts
        alone = without.isolate(truth.q, tau).contacts
        assert [c.link for c in silent] == [c.link for c in alone]
        assert [c.located for c in silent] == [c.located for c in alone]
        assert all(c.source == "joint torques" for c in silent)


def test_the_sensor_that_saw_a_contact_is_its_source() -> None:
    isolator, rng = ARM.isolator(), np.random.default_rng(6)
    for link, source in (("iiwa_link_7", "iiwa_link_7"), ("iiwa_link_4", "iiwa_link_1")):
        for _ in range(10):
            truth, tau, wrenches = ARM.draw(rng, {link: 1.0})
            (contact,) = isolator.isolate(truth.q, tau, wrenches).contacts
            assert contact.link != link or contact.source == source


def standing(
    robot: cs.Robot, q: np.ndarray, link: str, point: np.ndarray, force: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Motor torques and the reading of the left foot's sensor; the robot stands on it while `force` acts."""
    model, data = robot.model, robot.model.createData()
    foot = model.getFrameId("l_foot", pin.FrameType.BODY)
    gravity = pin.rnea(model, data, q, np.zeros(model.nv), np.zeros(model.nv))
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    place, joint = data.oMf[foot], model.frames[foot].parentJoint
    at_foot = pin.getFrameJacobian(model, data, foot, pin.LOCAL_WORLD_ALIGNED)
    pushed = map_reference.jacobians(model, q, link, point[None])[0].T @ force
    stance = np.linalg.solve(at_foot[:, :6].T, gravity[:6] - pushed[:6])
    weight = sum(model.inertias[body].mass for body in model.subtrees[joint]) * model.gravity.linear
    assert len(model.subtrees[joint]) == 1
    arm = data.oMi[joint].act(model.inertias[joint].lever) - place.translation
    load = stance + np.concatenate([weight, np.cross(arm, weight)])
    turn = place.rotation.T
    reading = np.concatenate([turn @ load[:3], turn @ load[3:]])
    return (gravity - pushed - at_foot.T @ stance)[6:], reading


def test_a_monitor_follows_contacts_on_a_standing_humanoid() -> None:
    robot = cs.Robot.named("atlas")
    sensor = cs.ForceTorqueSensor("l_foot", "l_foot")
    shares, rng = ATLAS.shares(), np.random.default_rng(8)
    followed = located = 0
    for _ in range(6):
        monitor = cs.ContactMonitor(
            robot,
            dt=1e-3,
            sensors=[sensor],
            wanted_contacts=["l_foot"],
            torque_threshold=3 * TORQUE,
            wrench_threshold=3 * WRENCH,
        )
        truth = map_reference.draw(
            robot, rng, shares, forces=(30.0, 60.0), pull_probability=0.0, friction=0.3
        )
        ids = set()
        for tick in range(500):
            force = truth.force if tick >= 100 else np.zeros(3)
            tau, reading = standing(robot, truth.q, truth.link, truth.point, force)
            tau += TORQUE * rng.standard_normal(robot.nv - 6)
            reading += WRENCH * rng.standard_normal(6)
            report = monitor.update(truth.q, np.zeros(robot.nv), tau, reading[None])
            assert not report.collision or tick >= 100
            if tick > 300:
                ids |= {contact.id for contact in report.contacts}
        (contact,) = report.contacts
        followed += ids == {contact.id} and contact.peak_force > 0.7 * np.linalg.norm(truth.force)
        error = np.linalg.norm(contact.point - truth.point)
        assert not contact.located or error < 0.01 + 3 * contact.point_std
        located += contact.located
        assert contact.link_probabilities[truth.link] > 0.01
    assert followed == 6
    assert located >= 2
