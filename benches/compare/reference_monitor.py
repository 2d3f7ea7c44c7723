"""The monitor for single contacts as one would write it with Pinocchio, NumPy, trimesh and embree."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import contactsense as cs

from .reference_observer import ReferenceObserver
from .reference_surface import ReferenceSurface

FloatArray = NDArray[np.float64]

ROUNDS = 10
RANK_TOLERANCE = 1e-7


class ReferenceContact(NamedTuple):
    """World frame; the wrench is at the link's origin."""

    link: str
    point: FloatArray
    force: FloatArray
    normal: FloatArray
    wrench: FloatArray


class ReferenceReport(NamedTuple):
    """What the reference says of one tick."""

    collision: bool
    links: list[str]
    external_torque: FloatArray
    acceleration: FloatArray
    contact: ReferenceContact | None


class _Link(NamedTuple):
    name: str
    placement: Any  # of the link in its joint
    surface: ReferenceSurface


class ReferenceMonitor:
    """The same steps as `ContactMonitor` on a contact that the torques determine."""

    def __init__(
        self, model: Any, robot: cs.Robot, *, dt: float, threshold: float, hold_time: float = 0.02
    ) -> None:
        self.model = model
        self.observer = ReferenceObserver(model, dt=dt)
        self.data = self.observer.data
        self.aba_data = model.createData()
        self.dt, self.threshold, self.hold_time = dt, threshold, hold_time
        self.remaining = np.full(model.nv, -1.0)
        self.total = np.zeros(model.nv)
        joints = range(model.njoints)
        self.links: list[list[_Link]] = [[] for _ in joints]
        for name in robot.link_names:
            frame = model.frames[model.getFrameId(name, pin.FrameType.BODY)]
            surface = robot.surface(name)
            shape = ReferenceSurface(surface.vertices, surface.triangles)
            self.links[frame.parentJoint].append(_Link(name, frame.placement, shape))
        self.behind = [list(model.subtrees[joint])[1:] for joint in joints]
        self.parents = list(model.parents)
        ranges = [range(joint.idx_v, joint.idx_v + joint.nv) for joint in model.joints]
        self.columns = [np.array([k for j in model.supports[i] if j for k in ranges[j]], int) for i in joints]
        self.joint_of = np.array([j for j in joints if j for _ in ranges[j]])
        self.own = [slice(columns.start, columns.stop) for columns in ranges]
        self.velocities_behind = np.zeros((model.nv, model.nv), dtype=bool)
        for k, joint in enumerate(self.joint_of):
            for other in self.behind[joint]:
                self.velocities_behind[k, self.own[other]] = True

    def reset(self) -> None:
        """Forgets all ticks."""
        self.observer = ReferenceObserver(self.model, dt=self.dt)
        self.data = self.observer.data
        self.remaining.fill(-1.0)

    def update(self, q: FloatArray, v: FloatArray, tau: FloatArray) -> ReferenceReport:
        """One control tick; `tau` is `(nv,)`."""
        torque = self.observer.update(q, v, tau)
        np.add(tau, torque, out=self.total)
        acceleration = pin.aba(self.model, self.aba_data, q, v, self.total)
        over = np.abs(torque) > self.threshold
        self.remaining -= self.dt
        self.remaining[over] = self.hold_time
        if self.remaining.max() < 0.0:
            return ReferenceReport(False, [], torque, acceleration.copy(), None)
        links = [link.name for tip in self._tips(self.remaining >= 0.0) for link in self.links[tip]]
        tips = self._tips(over)
        contact = self._isolate(tips.pop(), torque) if len(tips) == 1 else None
        return ReferenceReport(True, links, torque, acceleration.copy(), contact)

    def _tips(self, felt: NDArray[np.bool_]) -> set[int]:
        """Joints that feel the contact while none behind them does."""
        last = felt & ~self.velocities_behind[:, felt].any(axis=1)
        return set(self.joint_of[last].tolist())

    def _isolate(self, tip: int, torque: FloatArray) -> ReferenceContact | None:
        # The Coriolis matrix left the joints' Jacobian (world frame) and placements in the observer's data.
        jacobian = self.data.J
        joint = tip
        for _ in range(ROUNDS):
            columns = self.columns[joint]
            rows = jacobian[:, columns].T
            wrench, _, rank, _ = np.linalg.lstsq(rows, torque[columns], rcond=RANK_TOLERANCE)
            if rank < 6:
                return None
            force, moment = wrench[:3], wrench[3:]
            size = float(np.sqrt(force.dot(force)))
            direction = force / size
            start = pin.skew(direction).dot(moment) / size
            best = None
            for body in self._bodies(tip, jacobian.T.dot(wrench) - torque):
                for link in self.links[body]:
                    pose = self.data.oMi[body].act(link.placement)
                    rotation, translation = pose.rotation, pose.translation
                    local = (start - translation).dot(rotation)
                    hits = link.surface.line_hits(local, direction.dot(rotation))
                    first = next((hit for hit in hits if hit.pushing), None)
                    if first and (best is None or first.distance < best[0].distance):
                        best = (first, body, link.name, rotation, translation)
            if best is None:
                return None
            hit, body, name, rotation, translation = best
            if body == joint:
                point = rotation.dot(hit.point) + translation
                force = self._force_at(point, joint, torque)
                moment = pin.skew(point - translation).dot(force)
                wrench = np.concatenate([force, moment])
                return ReferenceContact(name, point, force, rotation.dot(hit.normal), wrench)
            joint = body
        return None

    def _bodies(self, tip: int, misfit: FloatArray) -> list[int]:
        """`tip`, and the bodies behind it whose joints would not feel the wrench more than they do."""
        member = {tip}
        silent = np.abs(misfit) <= self.threshold
        for joint in self.behind[tip]:
            if self.parents[joint] in member and silent[self.own[joint]].all():
                member.add(joint)
        return sorted(member)

    def _force_at(self, point: FloatArray, joint: int, torque: FloatArray) -> FloatArray:
        columns = self.columns[joint]
        jacobian = self.data.J[:, columns]
        rows = jacobian[:3] - pin.skew(point).dot(jacobian[3:])
        force: FloatArray = np.linalg.lstsq(rows.T, torque[columns], rcond=None)[0]
        return force
