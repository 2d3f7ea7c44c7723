"""One trial, watched: the particles at several moments, after Fig. 3."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contactsense.sim import ContactRun
from contactsense.sim._arrays import FloatArray

from .arm import Arm, load_arm
from .experiments import BY_NAME
from .options import Options
from .study import Trial, trial_seed
from .tracking import track
from .trials import record


@dataclass(frozen=True)
class Moment:
    """The particles after one update; world frame."""

    update: int
    time: float  # [s] since the first
    q: FloatArray
    points: FloatArray  # (n, 3)
    normals: FloatArray  # (n, 3)
    forces: FloatArray  # (n,) [N]
    misfit: FloatArray  # (n,) of the torques, relative to those felt
    weights: FloatArray  # (n,)
    estimate: FloatArray  # (3,)
    true_point: FloatArray
    true_force: FloatArray


@dataclass(frozen=True)
class Progress:
    """One trial of one filter."""

    arm: Arm
    link: str
    run: ContactRun
    moments: tuple[Moment, ...]


def watch(options: Options, trial: Trial, shares: tuple[float, ...]) -> Progress:
    """A trial of the study again, with its experiment's first filter, seen at `shares` of the run."""
    arm, experiment = load_arm(options), BY_NAME[trial.experiment]
    seed = trial_seed(options.seed, trial.experiment, trial.link, trial.number)
    run = record(arm, experiment, trial.link, trial.number, seed)
    rows = {round(share * (len(run) - 1)) for share in shares}
    moments: list[Moment] = []

    def keep(row: int, particles: Any, estimate: Any) -> None:
        if row in rows:
            moments.append(_moment(arm, run, row, particles.particles, estimate))

    track(arm, run, experiment.filters[0], options, seed, keep)
    return Progress(arm, trial.link, run, tuple(moments))


def _moment(arm: Arm, run: ContactRun, row: int, particles: Any, estimate: Any) -> Moment:
    q, torque = run.q[row], run.external_torque[row]
    points, normals = np.asarray(particles.point), np.asarray(particles.normal)
    forces = np.asarray(particles.force)
    push = -forces[:, None] * normals
    felt = np.empty((len(points), arm.robot.nv))
    for number, name in enumerate(arm.robot.link_names):
        own = np.asarray(particles.link) == number
        if own.any():
            origin, jacobian = arm.robot.link_pose(q, name)[:3, 3], arm.robot.jacobian(q, name)
            moment = np.cross(points[own] - origin, push[own])
            felt[own] = push[own] @ jacobian[:3] + moment @ jacobian[3:]
    misfit = np.linalg.norm(felt - torque, axis=1) / max(float(np.linalg.norm(torque)), 1e-12)
    return Moment(
        row,
        float(run.time[row] - run.time[0]),
        q,
        points.copy(),
        normals.copy(),
        forces.copy(),
        misfit,
        np.asarray(particles.weight).copy(),
        np.asarray(estimate.point),
        run.point[row],
        run.force[row],
    )
