"""Soft control: joints, or the hand, held by springs and dampers, as arms for work beside people do."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from contactsense.errors import InputError

from ._arrays import FloatArray, gains, not_negative, positive, symmetric

_AXES = pin.LOCAL_WORLD_ALIGNED


class ImpedanceController:
    """`tau = K (q_d - q) + D (v_d - v) + C v + g`, for a fixed base.

    Args:
        model: Pinocchio model, all joints with one coordinate.
        stiffness: K, one for all or (nv,) [Nm/rad, N/m].
        damping_ratio: of every mode: D is chosen by double diagonalisation of M(q) and K (Albu-Schaeffer
            2003).
        bandwidth: modes faster than this are made softer [1/s]. A light wrist on a stiff spring swings faster
            than control at 1 kHz can follow.

    Raises:
        InputError: names the argument.
    """

    def __init__(
        self,
        model: pin.Model,
        *,
        stiffness: ArrayLike = 1000.0,
        damping_ratio: float = 0.7,
        bandwidth: float = 150.0,
    ) -> None:
        _fixed(model)
        self._model, self._data = model, model.createData()
        self.stiffness = gains("stiffness", stiffness, model.nv)
        if not self.stiffness.all():
            raise InputError("stiffness must be positive")
        self.damping_ratio = not_negative("damping_ratio", damping_ratio)
        self.bandwidth = positive("bandwidth", bandwidth)

    def torque(
        self,
        q: FloatArray,
        v: FloatArray,
        desired: FloatArray,
        desired_v: FloatArray | None = None,
        feedforward: FloatArray | None = None,
    ) -> FloatArray:
        """(nv,) motor torque [Nm] at `q`, `v`, drawn towards `desired` (nq,).

        `desired_v` (nv,) is v_d, zero by default; `feedforward` (nv,) is added.
        """
        slip = v if desired_v is None else v - desired_v
        torque = self._feedback(q, v, desired, slip)
        return torque if feedforward is None else torque + feedforward

    def _feedback(self, q: FloatArray, v: FloatArray, desired: FloatArray, slip: FloatArray) -> FloatArray:
        """(nv,) what springs and dampers ask for, gravity and bias forces included; `slip` is `v - v_d`."""
        mass = symmetric(pin.crba(self._model, self._data, q))
        bias = pin.nonLinearEffects(self._model, self._data, q, v)
        torque: FloatArray = self._joint_springs(mass, desired - q, slip) + bias
        return torque

    def _joint_springs(self, mass: FloatArray, error: FloatArray, slip: FloatArray) -> FloatArray:
        stiffness, damping = _gains_at(mass, self.stiffness, self.damping_ratio, self.bandwidth)
        torque: FloatArray = stiffness @ error - damping @ slip
        return torque


class HandImpedanceController(ImpedanceController):
    """A hand held by a spring in its six directions; the joints are drawn to `q_d` in what is left free.

    `tau = J^T (K_x e + D_x J (v_d - v)) + N^T (K (q_d - q) + D (v_d - v)) + C v + g`, where the hand's pose
    error `e` is that to its pose at `q_d`, and `N = I - M^-1 J^T (J M^-1 J^T)^-1 J` projects on motions that
    leave the hand where it is (Khatib 1987). An arm with seven joints can so move its elbow.

    Args:
        model: Pinocchio model, all joints with one coordinate.
        link: the hand.
        translation: stiffness [N/m].
        rotation: stiffness [Nm/rad].
        stiffness: K of the joints, in the null space, one for all or (nv,) [Nm/rad].
        damping_ratio: of both.
        bandwidth: as for `ImpedanceController`.

    Raises:
        InputError: names the argument.
    """

    def __init__(
        self,
        model: pin.Model,
        link: str,
        *,
        translation: float = 2000.0,
        rotation: float = 200.0,
        stiffness: ArrayLike = 500.0,
        damping_ratio: float = 0.7,
        bandwidth: float = 150.0,
    ) -> None:
        super().__init__(model, stiffness=stiffness, damping_ratio=damping_ratio, bandwidth=bandwidth)
        if not model.existFrame(link, pin.FrameType.BODY):
            raise InputError(f"link: no link '{link}'")
        self._frame = model.getFrameId(link, pin.FrameType.BODY)
        sizes = [positive("translation", translation)] * 3 + [positive("rotation", rotation)] * 3
        self._hand_stiffness = np.array(sizes)

    def _feedback(self, q: FloatArray, v: FloatArray, desired: FloatArray, slip: FloatArray) -> FloatArray:
        model, data = self._model, self._data
        pin.forwardKinematics(model, data, desired)
        goal = pin.updateFramePlacement(model, data, self._frame).copy()
        pin.computeAllTerms(model, data, q, v)
        here = pin.updateFramePlacement(model, data, self._frame)
        jacobian = pin.getFrameJacobian(model, data, self._frame, _AXES)
        turn = here.rotation @ pin.log3(here.rotation.T @ goal.rotation)
        error = np.concatenate([goal.translation - here.translation, turn])
        mass = symmetric(data.M)
        by_mass = np.linalg.solve(mass, jacobian.T)
        # The small term keeps a singular arm, whose hand cannot move some way, from blowing up.
        inertia = np.linalg.inv(jacobian @ by_mass + 1e-4 * np.eye(6))
        inertia = 0.5 * (inertia + inertia.T)
        spring, damper = _gains_at(inertia, self._hand_stiffness, self.damping_ratio, self.bandwidth)
        wrench = spring @ error - damper @ (jacobian @ slip)
        free = self._joint_springs(mass, desired - q, slip)
        free -= jacobian.T @ (inertia @ (by_mass.T @ free))
        torque: FloatArray = jacobian.T @ wrench + free + data.nle
        return torque


def _gains_at(
    mass: FloatArray, stiffness: FloatArray, ratio: float, bandwidth: float
) -> tuple[FloatArray, FloatArray]:
    """Stiffness and damping, each (n, n): every mode with the damping ratio, none above `bandwidth`."""
    root = np.linalg.cholesky(mass)
    inverse = np.linalg.inv(root)
    squares, modes = np.linalg.eigh((inverse * stiffness) @ inverse.T)
    speed = np.minimum(np.sqrt(np.maximum(squares, 0.0)), bandwidth)
    shape = root @ modes
    return (shape * speed**2) @ shape.T, (shape * (2.0 * ratio * speed)) @ shape.T


def _fixed(model: pin.Model) -> None:
    if model.nq != model.nv:
        raise InputError("model: impedance control needs a fixed base and joints with one coordinate each")
