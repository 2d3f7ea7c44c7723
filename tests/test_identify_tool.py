"""The tool behind a wrist sensor and the sensor's offset, from poses at rest.

`python tests/test_identify_tool.py` prints the errors and their stated standard deviations over many arms.
"""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs

# White noise of a reading of a common sensor (N, Nm), and how many readings a pose has: 0.2 s at 500 Hz.
NOISE = np.repeat([0.2, 0.01], 3)
SAMPLES = 100


class Wrist:
    """A wrist with a tool that the model lacks, and a sensor with an offset."""

    def __init__(self, seed: int, convention: str = "load") -> None:
        self.rng = np.random.default_rng(seed)
        self.robot = cs.Robot.named("iiwa14")
        self.mass = self.rng.uniform(0.5, 3.0)
        self.com = np.r_[self.rng.uniform(-0.05, 0.05, 2), self.rng.uniform(0.05, 0.15)]
        self.offset = self.rng.uniform(-1, 1, 6) * np.repeat([20.0, 2.0], 3)
        self.loaded = self.robot.with_payload("iiwa_link_7", self.mass, self.com)
        pose = self.robot.link_pose(self.robot.random_configuration(seed), "iiwa_link_5")
        pose[:3, 3] = [0.01, -0.02, 0.03]
        self.sensor = cs.ForceTorqueSensor(
            "wrist", "iiwa_link_7", pose=pose, convention=convention, offset=[7.0] * 6
        )

    def poses(self, count: int) -> np.ndarray:
        """Gravity's directions are far apart by the last two joints alone."""
        q = np.tile(self.rng.uniform(-0.5, 0.5, 7), (count, 1))
        q[:, 5] = np.resize([-1.5, 0.0, 1.5, 0.8], count) + self.rng.uniform(-0.1, 0.1, count)
        q[:, 6] = np.resize([0.0, 1.5, 0.7, -1.5], count) + self.rng.uniform(-0.1, 0.1, count)
        return q

    def readings(self, q: np.ndarray, noise: float = 1.0, samples: int = SAMPLES) -> np.ndarray:
        free = cs.LoadCompensator(self.loaded, [self.sensor])
        clean = np.array([-free.tare(row, np.zeros((1, 6)))[0] for row in q]) + self.offset
        return clean[:, None] + noise * NOISE * self.rng.standard_normal((len(q), samples, 6))

    def truth(self) -> np.ndarray:
        return np.r_[self.mass, self.com, self.offset]


def numbers(tool: cs.ToolLoad) -> np.ndarray:
    return np.r_[tool.mass, tool.com, tool.offset]


def within_two_percent(wrist: Wrist, tool: cs.ToolLoad) -> bool:
    """Of mass, of the distance of the centre, and of the size of the offset's force and moment."""
    errors = [
        abs(tool.mass / wrist.mass - 1.0),
        np.linalg.norm(tool.com - wrist.com) / np.linalg.norm(wrist.com),
        np.linalg.norm((tool.offset - wrist.offset)[:3]) / np.linalg.norm(wrist.offset[:3]),
        np.linalg.norm((tool.offset - wrist.offset)[3:]) / np.linalg.norm(wrist.offset[3:]),
    ]
    return max(errors) < 0.02


@pytest.mark.parametrize("convention", ["load", "support"])
def test_exact_readings_give_the_tool(convention: str) -> None:
    wrist = Wrist(1, convention)
    q = wrist.poses(4)
    tool = cs.identify_tool(wrist.robot, wrist.sensor, q, wrist.readings(q, 0.0, 1)[:, 0])
    assert tool.link == "iiwa_link_7"
    np.testing.assert_allclose(numbers(tool), wrist.truth(), atol=1e-6)
    assert tool.residual.max() < 1e-9


@pytest.mark.parametrize("convention", ["load", "support"])
def test_four_noisy_poses_are_within_two_percent(convention: str) -> None:
    """And the robot with this tool and offset then reads under 0.5 N in 20 other poses."""
    good, scores = 0, []
    for seed in range(20):
        wrist = Wrist(100 + seed, convention)
        q = wrist.poses(4)
        tool = cs.identify_tool(wrist.robot, wrist.sensor, q, wrist.readings(q))
        good += within_two_percent(wrist, tool)
        scores.append((numbers(tool) - wrist.truth()) / np.sqrt(np.diag(tool.covariance)))
        np.testing.assert_allclose(
            np.r_[tool.mass_std, tool.com_std, tool.offset_std] ** 2, np.diag(tool.covariance)
        )
        compensator = cs.LoadCompensator(
            wrist.robot.with_payload(tool.link, tool.mass, tool.com), [wrist.sensor]
        )
        compensator.offsets = [tool.offset]
        assert largest_force(wrist, compensator) < 0.5
    assert good >= 19
    # Two standard deviations hold 95 % of normal errors; the noise itself is known from few numbers.
    assert (np.abs(scores) < 2.0).mean() >= 0.9


def largest_force(wrist: Wrist, compensator: cs.LoadCompensator) -> float:
    still = np.zeros(7)
    others = np.array([wrist.robot.random_configuration(seed) for seed in range(20)])
    means = wrist.readings(others).mean(axis=1)
    external = [compensator.update(q, still, still, [m])[0, :3] for q, m in zip(others, means, strict=True)]
    return float(np.linalg.norm(external, axis=1).max())


def test_a_sensor_that_was_zeroed_with_its_tool_on() -> None:
    """Taring suffices where the tool is in the model; where it is not, one pose cannot tell its weight."""
    wrist = Wrist(7)
    home = wrist.poses(1)
    wrist.offset = np.zeros(6)
    wrist.offset = -wrist.readings(home, 0.0, 1)[0, 0]  # now it reads zero at home
    for robot, is_enough in ((wrist.loaded, True), (wrist.robot, False)):
        compensator = cs.LoadCompensator(robot, [wrist.sensor])
        compensator.tare(home[0], wrist.readings(home)[0][:, None])
        assert (largest_force(wrist, compensator) < 0.5) == is_enough
    q = wrist.poses(4)
    tool = cs.identify_tool(wrist.robot, wrist.sensor, q, wrist.readings(q))
    assert within_two_percent(wrist, tool)


def test_readings_and_poses_without_readings_are_left_out() -> None:
    wrist = Wrist(3)
    q = wrist.poses(6)
    readings = wrist.readings(q)
    expected = cs.identify_tool(wrist.robot, wrist.sensor, q[:4], readings[:4, 5:])
    readings[4:] = np.nan
    readings[:, :5, 2] = np.nan
    tool = cs.identify_tool(wrist.robot, wrist.sensor, q, readings)
    np.testing.assert_allclose(numbers(tool), numbers(expected), rtol=1e-9)
    assert tool == cs.identify_tool(wrist.robot, wrist.sensor, q.tolist(), readings)


def test_no_tool_has_no_mass_and_an_unknown_centre() -> None:
    wrist = Wrist(4)
    q = wrist.poses(6)
    tool = cs.identify_tool(wrist.loaded, wrist.sensor, q, wrist.readings(q))
    assert 0.0 <= tool.mass < 0.01
    assert (tool.com_std > 0.01).all()
    np.testing.assert_allclose(tool.offset, wrist.offset, atol=0.2)


def test_poses_that_do_not_suffice_are_named() -> None:
    wrist = Wrist(5)
    q = wrist.poses(8)
    turned = np.tile(q[:1], (8, 1))
    turned[:, 0] = np.linspace(-1, 1, 8)  # about the vertical: gravity stays in the sensor's axes
    line = np.tile(wrist.robot.neutral(), (2, 1))
    line[1, 5] = 0.3
    for poses in (q[:3], np.tile(q[:1], (8, 1)), turned, np.resize(line, (8, 7))):
        with pytest.raises(cs.InputError, match=r"q: .*add poses in which gravity points along [+-][xyz]"):
            cs.identify_tool(wrist.robot, wrist.sensor, poses, wrist.readings(poses))


def test_readings_of_no_tool_are_refused() -> None:
    wrist = Wrist(6)
    q = wrist.poses(6)
    readings = wrist.readings(q)
    heavier = wrist.loaded.with_payload("iiwa_link_7", 0.5, [0.0, 0.0, 0.1])
    other = cs.ForceTorqueSensor("wrist", "iiwa_link_7", pose=wrist.sensor.pose, convention="support")
    for robot, sensor in ((heavier, wrist.sensor), (wrist.robot, other)):
        with pytest.raises(cs.InputError, match=r"wrenches: .*kg lighter.*convention"):
            cs.identify_tool(robot, sensor, q, readings)
    millimetres = readings * np.repeat([1.0, 1000.0], 3)
    with pytest.raises(cs.InputError, match=r"wrenches: .*units of the moments"):
        cs.identify_tool(wrist.robot, wrist.sensor, q, millimetres)


def test_bad_input_is_named() -> None:
    wrist = Wrist(8)
    q = wrist.poses(5)
    readings = wrist.readings(q, samples=3)
    infinite = readings.copy()
    infinite[2, 1, 4] = np.inf
    weightless = cs.Robot.from_urdf(description(), gravity=(0.0, 0.0, 0.0))
    bad = [
        ("robot", (None, wrist.sensor, q, readings)),
        ("robot: has no gravity", (weightless, wrist.sensor, q, readings)),
        ("sensor", (wrist.robot, "wrist", q, readings)),
        ("sensor", (wrist.robot, cs.ForceTorqueSensor("a", "nothing"), q, readings)),
        ("q", (wrist.robot, wrist.sensor, q[0], readings)),
        ("q", (wrist.robot, wrist.sensor, q[:, :6], readings)),
        ("q", (wrist.robot, wrist.sensor, q[:0], readings[:0])),
        ("q", (wrist.robot, wrist.sensor, np.full_like(q, np.nan), readings)),
        ("wrenches", (wrist.robot, wrist.sensor, q, readings[:4])),
        ("wrenches", (wrist.robot, wrist.sensor, q, readings[:, :0])),
        ("wrenches", (wrist.robot, wrist.sensor, q, readings[..., :5])),
        ("wrenches", (wrist.robot, wrist.sensor, q, infinite)),
        ("wrenches", (wrist.robot, wrist.sensor, q, None)),
    ]
    for named, arguments in bad:
        with pytest.raises(cs.InputError, match=named):
            cs.identify_tool(*arguments)


def description():
    from contactsense.robot import description_file

    return description_file("iiwa14")


def main() -> None:
    """Prints how many of 200 wrists are within 2 %, and what the stated standard deviations hold."""
    good, forces, scores = 0, [], []
    for seed in range(200):
        wrist = Wrist(10_000 + seed, ("load", "support")[seed % 2])
        q = wrist.poses(4)
        tool = cs.identify_tool(wrist.robot, wrist.sensor, q, wrist.readings(q))
        good += within_two_percent(wrist, tool)
        scores.append((numbers(tool) - wrist.truth()) / np.sqrt(np.diag(tool.covariance)))
        compensator = cs.LoadCompensator(wrist.loaded, [wrist.sensor])
        compensator.tare(q[0], wrist.readings(q[:1])[0][:, None])
        forces.append(largest_force(wrist, compensator))
    print(f"within 2 %: {good}/200; errors within 2 std: {(np.abs(scores) < 2).mean():.3f}")
    print(f"after tare with the tool in the model, 20 other poses: largest force {max(forces):.2f} N")


if __name__ == "__main__":
    main()
