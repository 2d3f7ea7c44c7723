"""A humanoid that is pushed while it stands: the pushes, drawn at random, and its settings."""

from __future__ import annotations

import numpy as np

from .. import ContactMonitor, Robot
from ..sim import FLOOR_TYPE, Floor, Measurement, Push, SimulatedRobot, TorqueNoise, WrenchNoise, named_geoms
from ..sim.atlas import FEET, SENSORS, controller, posture
from .loop import Setup, free_push, observe
from .result import Standing
from .settings import DEVIATIONS, DT, FloatArray, Settings, choose_gain, noise_passed

NAME = "atlas"
# Pushed in turn; of each group the seed picks one.
PLACES = (
    ("pelvis",),
    ("utorso",),
    ("l_uarm", "l_larm", "l_ufarm", "r_uarm", "r_larm", "r_ufarm"),
    ("l_hand", "r_hand"),
    ("l_uleg", "l_lleg", "r_uleg", "r_lleg"),
)
# Ranges that pushes are drawn from.
FORCE_RANGE = (50.0, 100.0)  # [N]
DURATION_RANGE = (0.1, 0.3)  # [s]
_FIRST, _SPACING, _LATER = 0.3, 0.7, 0.05  # [s]; a push may be later than its turn by up to the last
END = _FIRST + _SPACING * len(PLACES)  # [s]
# The next sensors behind a sensor, whose wrenches are taken out of its own.
BEHIND = {
    "l_clav": ("l_hand",),
    "r_clav": ("r_hand",),
    "l_uglut": ("l_foot",),
    "r_uglut": ("r_foot",),
    "utorso": ("l_clav", "r_clav"),
}
# What fast pushes and the edges of feet that come and go within a tick leave, without noise: of forces [N],
# and of moments [Nm] at the base, of joints, and at sensors.
FORCE_FLOOR, MOMENT_FLOOR, JOINT_FLOOR, SENSOR_FLOOR = 3.0, 3.0, 1.0, 0.5
# The ground answers a push at the chest by moments in each leg with this lever [m].
_LEG_LEVER = 0.65
# Before the run the robot settles on its soles; the monitor watches the last part, in which it starts up [s].
_SETTLING, _WATCHED = 1.0, 0.2
# The chest is 0.6 m wide, and thresholds are six standard deviations of the torques or more.
LOCATE_WITHIN = 0.1  # [m]


def prepare(seed: int, noise: TorqueNoise, sensor_noise: WrenchNoise, gain: float | None) -> Setup:
    """The humanoid standing still."""
    robot = Robot.named(NAME)
    q = posture(robot.model, seed)
    control = controller(robot.model, q)
    settings = choose(robot, q, control.torque(q, np.zeros(robot.nv)), noise, sensor_noise, gain)
    atlas = SimulatedRobot(
        robot.model,
        dt=DT,
        geoms=named_geoms(NAME, conaffinity=FLOOR_TYPE),
        floor=Floor(),
        sensors=SENSORS,
        noise=noise,
        wrench_noise=sensor_noise,
    )
    monitor = ContactMonitor(
        robot,
        dt=DT,
        sensors=SENSORS,
        wanted_contacts=FEET,
        observer_gain=settings.observer_gain,
        torque_threshold=settings.torque_threshold,
        wrench_threshold=settings.wrench_threshold,
        locate_within=LOCATE_WITHIN,
    )
    atlas.reset(q)
    for tick in range(round(_SETTLING / DT)):
        measured = atlas.step(control.torque(atlas.q, atlas.v))
        if tick >= round((_SETTLING - _WATCHED) / DT):
            observe(monitor, measured)
    start = atlas.q
    return Setup(
        name=NAME,
        robot=robot,
        simulated=atlas,
        monitor=monitor,
        settings=settings,
        pushes=plan_pushes(robot, q, seed),
        end=END,
        control=lambda time: control.torque(atlas.q, atlas.v),
        planned=lambda time: q,
        standing=lambda measured: _stood(start, measured),
    )


def _stood(start: FloatArray, measured: list[Measurement]) -> Standing:
    feet = [index for index, sensor in enumerate(SENSORS) if sensor.name in FEET]
    q = np.array([each.q for each in measured])
    # The scalar product of quaternions is the cosine of half the angle between them.
    cosine = np.minimum(1.0, np.abs(q[:, 3:7] @ start[3:7]))
    return Standing(
        feet=FEET,
        ground=np.array([np.linalg.norm(each.wrenches[feet, :3], axis=1) for each in measured]),
        moved=float(np.linalg.norm(q[:, :3] - start[:3], axis=1).max()),
        turned=float(2.0 * np.arccos(cosine.min())),
    )


def plan_pushes(robot: Robot, q: FloatArray, seed: int) -> tuple[Push, ...]:
    """Free pushes on `PLACES` in turn, half-sines."""
    generator = np.random.default_rng([seed, 1])
    pushes = []
    for number, links in enumerate(PLACES):
        link = links[generator.integers(len(links))]
        start = _FIRST + _SPACING * number + generator.uniform(0.0, _LATER)
        force, duration = generator.uniform(*FORCE_RANGE), generator.uniform(*DURATION_RANGE)
        pushes.append(
            free_push(robot, q, link, start=start, duration=duration, force=force, generator=generator)
        )
    return tuple(pushes)


def choose(
    robot: Robot,
    q: FloatArray,
    torque: FloatArray,
    noise: TorqueNoise,
    sensor_noise: WrenchNoise,
    gain: float | None = None,
) -> Settings:
    """Thresholds `max(floor, DEVIATIONS s)`, `s` the deviation of the observed torque or wrench.

    Sensors take out the torques of the ground on the feet; their noise thus comes to all joints before them.

    Args:
        robot: the humanoid.
        q: (nq,) posture.
        torque: (nv - 6,) of the motors in it [Nm].
        noise: of the measured torques.
        sensor_noise: of the force/torque sensors.
        gain: in place of the chosen one [1/s].
    """
    gain = choose_gain(gain, noise.none and sensor_noise.none)
    feet = np.vstack([robot.jacobian(q, foot) for foot in FEET])
    variance = (feet**2).T @ np.tile(sensor_noise.deviation**2, len(FEET))
    variance[6:] += noise.deviation(np.abs(torque) + _push_torque(feet)) ** 2
    floor = np.concatenate([np.repeat([FORCE_FLOOR, MOMENT_FLOOR], 3), np.full(torque.size, JOINT_FLOOR)])
    scale = DEVIATIONS * noise_passed(gain)
    return Settings(
        gain,
        np.maximum(floor, scale * np.sqrt(variance)),
        np.maximum(
            np.repeat([FORCE_FLOOR, SENSOR_FLOOR], 3),
            # Without a low-pass a wrench is the mean of two readings.
            (scale if gain * DT < 0.5 else DEVIATIONS * np.sqrt(0.5))
            * np.sqrt(_wrench_variance(robot, q, sensor_noise)),
        ),
    )


def _wrench_variance(robot: Robot, q: FloatArray, noise: WrenchNoise) -> FloatArray:
    """(sensors, 6) of a wrench less those of the next sensors behind, moved to the sensor's origin."""
    force, moment = noise.newtons**2, noise.newton_metres**2
    variance = np.tile(noise.deviation**2, (len(SENSORS), 1))
    for row, sensor in zip(variance, SENSORS, strict=True):
        for other in BEHIND.get(sensor.name, ()):
            arm = robot.link_pose(q, other)[:3, 3] - robot.link_pose(q, sensor.link)[:3, 3]
            row += np.concatenate([np.full(3, force), moment + force * (arm @ arm - arm**2)])
    return variance


def _push_torque(feet: FloatArray) -> FloatArray:
    """(nv - 6,) what a push may add to the motors' torque, by which noise in percent counts [Nm]."""
    in_leg = feet[:, 6:].any(axis=0)
    return np.where(in_leg, FORCE_RANGE[1] * _LEG_LEVER, 0.0)
