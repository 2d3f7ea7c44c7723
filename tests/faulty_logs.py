"""Contact-free logs of arms with the errors of normal arms, and the faults that users inject into them.

`python tests/faulty_logs.py --cases 20` prints the rate of right findings for each fault.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pinocchio as pin
from robots import EXAMPLE_SHARE, PACKAGE_DIRS, SHARED

import contactsense as cs

_EXAMPLES = EXAMPLE_SHARE / "example-robot-data" / "robots"
ARMS = {
    "panda": ("panda_description/urdf/panda.urdf", ("panda_finger_joint1", "panda_finger_joint2")),
    "ur5": ("ur_description/urdf/ur5_robot.urdf", None),
    "ur3": ("ur_description/urdf/ur3_robot.urdf", None),
    "ur10": ("ur_description/urdf/ur10_robot.urdf", None),
    "kinova": ("kinova_description/robots/kinova.urdf", None),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", None),
    "z1": ("z1_description/urdf/z1.urdf", None),
}


@cache
def arm(name: str) -> cs.Robot:
    """One of the arms, by name."""
    if name == "iiwa14":
        return cs.Robot.named(name)
    path, locked = ARMS[name]
    return cs.Robot.from_urdf(
        _EXAMPLES / path, package_dirs=PACKAGE_DIRS, locked_joints=locked, missing_meshes="warn"
    )


@dataclass(frozen=True)
class Case:
    """A log, the robot of the user, and what the true arm does."""

    robot: cs.Robot
    model: pin.Model
    time: np.ndarray
    angles: np.ndarray
    v: np.ndarray
    a: np.ndarray
    tau: np.ndarray
    rng: np.random.Generator

    @property
    def q(self) -> np.ndarray:
        neutral = pin.neutral(self.model)
        if self.model.nq == self.model.nv:
            return self.angles
        return np.array([pin.integrate(self.model, neutral, row) for row in self.angles])

    def torque(self, model: pin.Model | None = None) -> np.ndarray:
        """The torque of a model along the motion."""
        model = self.model if model is None else model
        data = model.createData()
        return np.array(
            [pin.rnea(model, data, q, v, a) for q, v, a in zip(self.q, self.v, self.a, strict=True)]
        )

    @property
    def effort(self) -> np.ndarray:
        return np.array(self.robot.effort_limits)

    def late(self, values: np.ndarray, delay: float) -> np.ndarray:
        return np.stack([np.interp(self.time - delay, self.time, column) for column in values.T], axis=1)

    def findings(self, **options) -> tuple:
        return cs.diagnose(self.robot, self.q, self.v, self.tau, time=self.time, **options)


def noise_scale(effort: np.ndarray) -> np.ndarray:
    """Torque noise of a joint [Nm]: a large joint's sensor is as good as its size allows."""
    return np.clip(effort / 100.0, 0.3, 1.0)


def simulated(name: str, seed: int, seconds: float | None = None, rate: float | None = None) -> Case:
    """A faultless log: 2 % wrong masses, small bias and friction, noise to 0.1 Nm, quantised encoders."""
    rng = np.random.default_rng(seed)
    robot = arm(name)
    seconds = rng.uniform(10, 30) if seconds is None else seconds
    rate = rng.choice([100.0, 250.0, 500.0, 1000.0]) if rate is None else rate
    model = robot.model.copy()
    for index in range(1, model.njoints):
        inertia = model.inertias[index]
        factor = 1.0 + 0.02 * rng.standard_normal()
        lever = inertia.lever + 0.002 * rng.standard_normal(3)
        model.inertias[index] = pin.Inertia(inertia.mass * factor, lever, inertia.inertia * factor)
    nv = model.nv
    time = np.arange(0.0, seconds, 1.0 / rate)
    limits = np.zeros((nv, 2))
    for joint in model.joints[1:]:
        k, i = joint.idx_v, joint.idx_q
        bounded = joint.nq == 1 and model.upperPositionLimit[i] - model.lowerPositionLimit[i] < 8.0
        limits[k] = [model.lowerPositionLimit[i], model.upperPositionLimit[i]] if bounded else [-2.0, 2.0]
    middle, half = limits.mean(axis=1), 0.5 * np.ptp(limits, axis=1)
    angles, v, a = (np.zeros((len(time), nv)) for _ in range(3))
    for k in range(nv):
        frequencies = 2 * np.pi * (0.1 * np.arange(1, 7) + rng.uniform(0, 0.03, 6))
        size = rng.standard_normal(6) / np.arange(1, 7) ** 0.5
        size *= min(0.35 * half[k], 0.9) * rng.uniform(0.6, 1.2) / np.abs(size).sum()
        phase = rng.uniform(0, 2 * np.pi, 6)
        angle = np.outer(time, frequencies) + phase
        centre = middle[k] + rng.uniform(-0.3, 0.3) * half[k]
        angles[:, k] = centre + np.sin(angle) @ size
        v[:, k] = np.cos(angle) @ (size * frequencies)
        a[:, k] = -np.sin(angle) @ (size * frequencies**2)
    case = Case(robot, model, time, angles, v, a, np.zeros_like(v), rng)
    effort = np.minimum(case.effort, 330.0)
    tau = case.torque() + rng.uniform(0.5, 1.0, nv) * noise_scale(effort) * 0.1 * rng.standard_normal(v.shape)
    tau += rng.uniform(-0.005, 0.005, nv) * effort
    tau += rng.uniform(0, 0.005, nv) * effort * np.tanh(v / 0.02) + rng.uniform(0, 0.005, nv) * effort * v
    step = 2e-5
    seen = case.v + 0.002 * rng.standard_normal(v.shape)
    return replace(case, angles=np.round(angles / step) * step, v=seen, tau=tau)


@cache
def _panda_free() -> tuple[np.ndarray, ...]:
    import sqlite3
    import struct

    con = sqlite3.connect(SHARED / "real" / "panda_free" / "panda_exciting_trajectory.db3")
    (topic,) = [i for i, n in con.execute("select id, name from topics") if n.endswith("joint_states")]
    found = []
    wanted = [f"fer_joint{i}" for i in range(1, 8)]
    for _, data in con.execute(
        "select timestamp, data from messages where topic_id=? order by timestamp", (topic,)
    ):
        at = 4

        def read(form: str, count: int = 1, data: bytes = data) -> tuple:
            nonlocal at
            size = struct.calcsize(f"<{form}")
            at += -(at - 4) % size
            values = struct.unpack_from(f"<{count}{form}", data, at)
            at += count * size
            return values

        def text(data: bytes = data) -> str:
            nonlocal at
            (length,) = read("I")
            at += length
            return data[at - length : at - 1].decode()

        seconds, nanoseconds = read("i")[0], read("I")[0]
        text()
        names = [text() for _ in range(read("I")[0])]
        columns = []
        for _ in range(3):
            (count,) = read("I")
            columns.append(np.array(read("d", count) if count else []))
        order = [names.index(name) for name in wanted]
        found.append((seconds + 1e-9 * nanoseconds, *(column[order] for column in columns)))
    time, q, v, tau = (np.array(column) for column in zip(*found, strict=True))
    kept = np.r_[True, np.diff(time) > 0]
    return tuple(column[kept] for column in (time - time[0], q, v, tau))


def real_panda(seed: int) -> Case:
    """Ten to twenty-four seconds of the real arm, at another place of the log for every seed."""
    rng = np.random.default_rng(seed)
    time, q, v, tau = _panda_free()
    seconds = rng.uniform(12, 24)
    start = rng.uniform(0, time[-1] - seconds)
    rows = (time >= start) & (time <= start + seconds)
    robot = arm("panda")
    t = time[rows]
    wide = np.array([np.convolve(np.gradient(x, t), np.ones(5) / 5, "same") for x in v[rows].T]).T
    return Case(robot, robot.model, t, q[rows], v[rows], wide, tau[rows], rng)


# Faults -----------------------------------------------------------------------------------------------------


def _one(case: Case) -> int:
    return int(case.rng.integers(case.model.nv))


def _audible(case: Case) -> int:
    """A joint whose torque is more than its errors."""
    sizes = case.tau.std(axis=0) / noise_scale(case.effort)
    return int(case.rng.choice(np.flatnonzero(sizes > 0.5)))


def sign_all(case):
    return replace(case, tau=-case.tau), {"code": "sign", "joint": None}


def sign_one(case):
    tau, joint = case.tau.copy(), _audible(case)
    tau[:, joint] *= -1
    return replace(case, tau=tau), {"code": "sign", "joint": joint}


def scale_all(case):
    factor = case.rng.choice([0.5, 2.0, 1.3, 100.0])
    return replace(case, tau=case.tau * factor), {"code": "scale", "joint": None, "value": factor}


def scale_one(case):
    tau, joint = case.tau.copy(), _audible(case)
    factor = case.rng.choice([0.5, 2.0, 1.3, 100.0])
    tau[:, joint] *= factor
    return replace(case, tau=tau), {"code": "scale", "joint": joint, "value": factor}


def gravity_free(case):
    still = replace(case, v=0 * case.v, a=0 * case.a)
    return replace(case, tau=case.tau - still.torque(case.robot.model)), {"code": "gravity_free"}


def permuted(case):
    order = np.arange(case.model.nv)
    if case.rng.random() < 0.5:
        pair = case.rng.choice(case.model.nv, 2, replace=False)
        order[pair] = order[pair[::-1]]
    else:
        while np.sum(order == np.arange(len(order))) > 2:
            order = case.rng.permutation(case.model.nv)
    return replace(case, tau=case.tau[:, order]), {"code": "permuted"}


def permuted_all(case):
    """Everything in the order in which ROS sorts names: here a swap of the first and the third joint."""
    order = np.arange(case.model.nv)
    order[[0, 2]] = [2, 0]
    return replace(case, angles=case.angles[:, order], v=case.v[:, order], tau=case.tau[:, order]), {
        "code": "permuted"
    }


def _loaded(case, mass, com):
    model = case.robot.model.copy()
    model.inertias[model.njoints - 1] += pin.Inertia(mass, com, 0.002 * mass * np.eye(3))
    return model


def _payload_size(case):
    moving = sum(inertia.mass for inertia in list(case.model.inertias)[1:])
    mass = np.clip(moving * case.rng.uniform(0.04, 0.2), 0.5, 5.0)
    com = np.r_[case.rng.uniform(-0.05, 0.05, 2), case.rng.uniform(0.05, 0.15)]
    return mass, com


def payload(case):
    mass, com = _payload_size(case)
    tau = case.tau + case.torque(_loaded(case, mass, com)) - case.torque(case.robot.model)
    return replace(case, tau=tau), {"code": "payload", "value": mass}


def tool(case):
    mass, com = _payload_size(case)
    geometry = case.robot.geometry_model
    robot = cs.Robot.from_pinocchio(_loaded(case, mass, com), geometry)
    return replace(case, robot=robot), {"code": "tool"}


def armature(case):
    mean = np.mean([np.diag(case.robot.mass_matrix(q)) for q in case.q[:: len(case.q) // 20]], axis=0)
    return replace(case, tau=case.tau + case.rng.uniform(0.6, 1.5, len(mean)) * mean * case.a), {
        "code": "armature"
    }


def friction(case):
    nv = case.model.nv
    effort = np.minimum(case.effort, 330.0)
    coulomb, viscous = case.rng.uniform(0.03, 0.08, nv), case.rng.uniform(0.0, 0.05, nv)
    return replace(case, tau=case.tau + effort * (coulomb * np.tanh(case.v / 0.03) + viscous * case.v)), {
        "code": "friction"
    }


def bias(case):
    tau, joint = case.tau.copy(), _one(case)
    tau[:, joint] += case.rng.choice([-1, 1]) * max(1.2, case.rng.uniform(0.05, 0.1) * case.effort[joint])
    return replace(case, tau=tau), {"code": "bias", "joint": joint}


def velocity_late(case):
    delay = case.rng.uniform(0.01, 0.05)
    return replace(case, v=case.late(case.v, delay)), {"code": "delay", "value": delay}


def torque_late(case):
    delay = case.rng.uniform(0.01, 0.05)
    return replace(case, tau=case.late(case.tau, delay)), {"code": "delay", "value": delay}


def filtered(case):
    fine = np.arange(case.time[0], case.time[-1], 1e-3)
    order = int(case.rng.integers(1, 3))
    kept = np.exp(-2 * np.pi * 5.0 * 1e-3)
    seen = []
    for column in case.v.T:
        x = np.interp(fine, case.time, column)
        for _ in range(order):
            y, state = np.empty_like(x), x[0]
            for k, value in enumerate(x):
                state = kept * state + (1 - kept) * value
                y[k] = state
            x = y
        seen.append(np.interp(case.time, fine, x))
    return replace(case, v=np.stack(seen, axis=1)), {"code": "filtered"}


def limit(case):
    joint = _one(case)
    model = case.robot.model.copy()
    j = next(j for j in list(model.joints)[1:] if j.idx_v == joint)
    if j.nq != 1:
        joint = next(j.idx_v for j in list(model.joints)[1:] if j.nq == 1)
        j = next(j for j in list(model.joints)[1:] if j.idx_v == joint)
    stop = np.quantile(case.angles[:, joint], case.rng.uniform(0.6, 0.85))
    upper = model.upperPositionLimit.copy()
    upper[j.idx_q] = stop
    model.upperPositionLimit = upper
    robot = cs.Robot.from_pinocchio(model, case.robot.geometry_model)
    angles, v, a = case.angles.copy(), case.v.copy(), case.a.copy()
    held = angles[:, joint] > stop
    over = angles[held, joint] - stop
    angles[held, joint] = stop
    v[held, joint] = 0.0
    a[held, joint] = 0.0
    moved = replace(case, robot=robot, angles=angles, v=v, a=a)
    tau = case.tau + moved.torque(model) - case.torque(model)
    tau[held, joint] += np.minimum(over * 100.0, 0.3 * case.effort[joint])
    return replace(moved, tau=tau), {"code": "limit", "joint": joint}


def gravity_direction(case):
    angle = case.rng.choice([case.rng.uniform(10, 90), 180.0])
    way = case.rng.uniform(0, 2 * np.pi)
    turn = pin.exp3(np.deg2rad(angle) * np.array([np.cos(way), np.sin(way), 0.0]))
    model = case.robot.model.copy()
    model.gravity = pin.Motion(turn @ case.model.gravity.linear, np.zeros(3))
    robot = cs.Robot.from_pinocchio(model, case.robot.geometry_model)
    return replace(case, robot=robot), {"code": "gravity_direction"}


def degrees(case):
    return replace(case, angles=np.rad2deg(case.angles), v=np.rad2deg(case.v)), {"code": "units"}


def millimetres(case):
    return replace(case, tau=1000.0 * case.tau), {"code": "units"}


FAULTS: dict[str, Callable[[Case], tuple[Case, dict]]] = {
    fault.__name__: fault
    for fault in (
        *(sign_all, sign_one, scale_all, scale_one, gravity_free, permuted, permuted_all, payload, tool),
        *(armature, friction, bias, velocity_late, torque_late, filtered, limit, gravity_direction),
        *(degrees, millimetres),
    )
}


def is_right(case: Case, finding, expected: dict) -> bool:
    """Whether a finding names the fault, its joint, and its size within 20 %."""
    if finding.code != expected["code"]:
        return False
    joint = expected.get("joint")
    if joint is not None and finding.joint != case.robot.joint_names[joint]:
        return False
    if "joint" in expected and joint is None and finding.joint is not None:
        return False
    value = expected.get("value")
    return value is None or abs(finding.value - value) <= 0.2 * abs(value) + 0.003


def case(name: str, seed: int) -> Case:
    """A faultless log of a simulated arm, or of the real one ("real")."""
    return real_panda(seed) if name == "real" else simulated(name, seed)


def shown(findings) -> str:
    """Findings in a line."""

    def one(finding) -> str:
        mark = "!" if finding.severity == "major" else ""
        return f"{finding.code}{mark} {finding.joint or ''} {finding.value:.3g} {finding.evidence:.2f}"

    return "; ".join(one(finding) for finding in findings)


def main() -> None:
    """Prints for each fault how often it was found first, and what was found instead."""
    import argparse

    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--arms", default="real,panda,ur5,iiwa14,kinova")
    parser.add_argument("--faults", default=",".join(["none", *FAULTS]))
    parser.add_argument("--verbose", action="store_true")
    given = parser.parse_args()
    arms = given.arms.split(",")
    for name in given.faults.split(","):
        right = 0
        misses = []
        count = given.cases
        for index in range(count):
            base = case(arms[index % len(arms)], given.first_seed + index)
            if name == "none":
                found = base.findings()
                good = not any(f.severity == "major" for f in found)
                quiet = not found
                expected = {}
            elif name == "permuted_all" and base.model.nq != base.model.nv:
                count -= 1  # (cos, sin) of a continuous joint cannot be taken for an angle
                continue
            else:
                faulty, expected = FAULTS[name](base)
                found = faulty.findings()
                good = bool(found) and is_right(faulty, found[0], expected)
                quiet = good
            right += good
            if not good or given.verbose or not quiet:
                misses.append(
                    f"    {arms[index % len(arms)]} {given.first_seed + index} {expected}: {shown(found)}"
                )
        print(f"{name:18s} {right}/{count}", flush=True)
        for miss in misses:
            print(miss, flush=True)


if __name__ == "__main__":
    main()
