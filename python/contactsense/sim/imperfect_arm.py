"""What stands between a real arm and its description."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from contactsense import Robot
from contactsense.errors import InputError

from ._arrays import FloatArray, not_negative, positive, whole
from .disturbance import perturbed_model
from .friction import Friction
from .joint_size import rated_torque
from .payload import Payload
from .per_joint import PerJoint, kept, spread

_DELAYS = ("torque_delay", "velocity_delay")
_AT_LEAST_ZERO = (*_DELAYS, "torque_noise", "hysteresis", "rotor_inertia", "compliance")
# The finest encoder whose counts doubles hold over many turns [bit].
_FINEST = 48


@dataclass(frozen=True)
class ImperfectArm:
    """The errors of one arm: what is wrong in its description and in what it measures.

    Values are of this very arm, not distributions: each is what a calibration should find. Two scenes of one
    arm have the same errors and other noise. Where a setting is "per joint", one number stands for all
    joints, an array (nv,) for one each. For sliding joints, read N for Nm and m for rad.

    Measured torque: `torque_scale h(tau + friction)(t - torque_delay) + torque_bias + noise`, where `h` is
    the hysteresis, `tau` what moves the true robot, rotors included, and `friction` the part of it that the
    sensor sees. Measured position: what the encoder counts. Measured velocity: its differences through a
    low-pass.

    Args:
        torque_noise: per joint, standard deviation of white noise, new in each row [Nm].
        torque_bias: per joint, constant [Nm].
        torque_scale: per joint; negative where the sign is the other way round.
        torque_delay: per joint [s].
        hysteresis: per joint, share of a change of torque that stays in the reading after the change is
            undone, see `with_hysteresis`; gears leave 3 to 8 %.
        friction: of the joints, and how much of it the torques contain.
        rotor_inertia: per joint, of the rotor through the gear, as far as the description lacks it and the
            torque contains it [kg m^2]: motor currents do, a sensor between gear and link does not.
        mass_error: standard deviation of each body's mass against the description, as a share of it; drawn
            with `seed`, as the next two (`perturbed_model`).
        com_error: of each coordinate of its centre of mass [m].
        inertia_error: of its rotational inertia, as a share, besides what follows from the mass.
        payload: that the description lacks.
        encoder_bits: an encoder counts `2^bits` steps a turn, or a metre of a sliding joint; None: exact.
        velocity_cutoff: corner of each stage of the low-pass on differenced positions [Hz]; a stage is late
            by `1 / (2 pi cutoff)`. None: the velocity is exact.
        velocity_order: stages of the low-pass, 1 or 2.
        velocity_delay: per joint, besides that of the low-pass [s].
        compliance: per joint, by how much gear and controller give way to an external torque [rad/Nm].
        dropped_ticks: share of the rows that are missing.
        drop_length: mean length of a gap [s]; networks lose several ticks in a row.
        jitter: standard deviation of the error of time stamps [s]. Rows are taken on time, and stamps stay in
            order.
        seed: of what is wrong with the masses; the noise comes with a scene's seed.

    Raises:
        InputError: names the setting.
    """

    torque_noise: PerJoint = 0.0
    torque_bias: PerJoint = 0.0
    torque_scale: PerJoint = 1.0
    torque_delay: PerJoint = 0.0
    hysteresis: PerJoint = 0.0
    friction: Friction = field(default_factory=Friction)
    rotor_inertia: PerJoint = 0.0
    mass_error: float = 0.0
    com_error: float = 0.0
    inertia_error: float = 0.0
    payload: Payload | None = None
    encoder_bits: int | None = None
    velocity_cutoff: float | None = None
    velocity_order: int = 1
    velocity_delay: PerJoint = 0.0
    compliance: PerJoint = 0.0
    dropped_ticks: float = 0.0
    drop_length: float = 5e-3
    jitter: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name in (*_AT_LEAST_ZERO, "torque_bias", "torque_scale"):
            lowest = 0.0 if name in _AT_LEAST_ZERO else -np.inf
            object.__setattr__(self, name, kept(name, getattr(self, name), lowest=lowest))
        if np.any(np.array(self.torque_scale) == 0.0):
            raise InputError("torque_scale: must not be zero")
        for name in ("mass_error", "com_error", "inertia_error", "dropped_ticks", "jitter"):
            not_negative(name, getattr(self, name))
        if self.dropped_ticks >= 1.0:
            raise InputError(f"dropped_ticks: must be a share below 1, not {self.dropped_ticks}")
        positive("drop_length", self.drop_length)
        whole("seed", self.seed)
        if self.encoder_bits not in (None, *range(1, _FINEST + 1)):
            raise InputError(
                f"encoder_bits: must be a whole number from 1 to {_FINEST}, or None, not {self.encoder_bits}"
            )
        if self.velocity_cutoff is not None:
            positive("velocity_cutoff", self.velocity_cutoff)
        if self.velocity_order not in (1, 2):
            raise InputError(f"velocity_order: must be 1 or 2, not {self.velocity_order}")
        if not isinstance(self.friction, Friction):
            raise InputError("friction: must be a Friction")
        if not (self.payload is None or isinstance(self.payload, Payload)):
            raise InputError("payload: must be a Payload or None")

    @classmethod
    def ideal(cls) -> ImperfectArm:
        """An arm that is as described and measures exactly."""
        return cls()

    @classmethod
    def typical(cls, robot: Robot, seed: int = 0) -> ImperfectArm:
        """An arm with torque sensors between gears and links, drawn with `seed`; sized joint by joint.

        Errors of a joint of 100 Nm are about those of a Panda's large joints: bias 0.2 Nm, noise 0.05 Nm,
        friction in the torque 0.3 Nm. They grow with the square root of the rated torque: small sensors are
        finer in Nm (0.07, 0.017 and 0.10 Nm at 12 Nm) and coarser as a share of their range. The gear's own
        friction is 5 % of the rated torque, most of which the sensor does not see.
        """
        rng = np.random.default_rng([whole("seed", seed), 0])
        rated = rated_torque(robot)
        size = np.sqrt(rated / 100.0)
        coulomb = 0.05 * rated * rng.uniform(0.7, 1.3, robot.nv)
        return cls(
            torque_noise=0.05 * size,
            torque_bias=0.2 * size * rng.standard_normal(robot.nv),
            # Strain gauges are trimmed to about a per cent.
            torque_scale=1.0 + 0.01 * rng.standard_normal(robot.nv),
            torque_delay=1e-3,
            hysteresis=0.03,
            friction=Friction(
                coulomb=coulomb,
                viscous=coulomb / _speed(robot),
                seen=np.minimum(1.0, 0.3 * size / (0.05 * rated)),
            ),
            # CAD masses without cables, screws and paint.
            mass_error=0.02,
            com_error=2e-3,
            inertia_error=0.05,
            encoder_bits=17,
            velocity_cutoff=60.0,
            velocity_delay=1e-3,
            dropped_ticks=1e-4,
            jitter=1e-5,
            seed=seed,
        )

    @classmethod
    def motor_currents(cls, robot: Robot, seed: int = 0) -> ImperfectArm:
        """An arm whose torques are motor currents times a constant: friction and rotors are all in them.

        As on a UR arm: Coulomb friction 5 % of the rated torque and as much viscous friction at full speed,
        2 % more to break away; rotors that the rated torque alone would accelerate at 150 rad/s^2.
        """
        rng = np.random.default_rng([whole("seed", seed), 1])
        rated = rated_torque(robot)
        coulomb = 0.05 * rated * rng.uniform(0.7, 1.3, robot.nv)
        return replace(
            cls.typical(robot, seed),
            # Current ripple, a per cent of the range of the current sensor.
            torque_noise=0.01 * rated,
            torque_bias=0.005 * rated * rng.standard_normal(robot.nv),
            # Torque constants vary with magnets and temperature.
            torque_scale=1.0 + 0.03 * rng.standard_normal(robot.nv),
            hysteresis=0.05,
            friction=Friction(coulomb=coulomb, viscous=coulomb / _speed(robot), stribeck=0.4 * coulomb),
            rotor_inertia=rated / 150.0,
        )

    def per_joint(self, name: str, nv: int) -> FloatArray:
        """(nv,) of a setting."""
        return spread(name, getattr(self, name), nv)

    def true_robot(self, robot: Robot) -> Robot:
        """`robot` as it is: with its real masses, rotors and payload."""
        rotors = self.per_joint("rotor_inertia", robot.nv)
        errors = {"mass": self.mass_error, "centre": self.com_error, "inertia": self.inertia_error}
        if not any(errors.values()) and not rotors.any() and self.payload is None:
            return robot
        model = perturbed_model(robot.model, seed=self.seed, **errors)
        model.armature = np.array(model.armature) + rotors
        true = Robot.from_pinocchio(model, robot.geometry_model)
        load = self.payload
        return true if load is None else true.with_payload(load.link, load.mass, load.com, load.inertia)


def _speed(robot: Robot) -> FloatArray:
    """(nv,) velocity limits; 2 rad/s where there are none."""
    limits = np.array(robot.model.velocityLimit)
    return np.where(np.isfinite(limits) & (limits > 0.0), limits, 2.0)
