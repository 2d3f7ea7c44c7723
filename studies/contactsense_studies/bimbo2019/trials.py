"""The recorded runs: an arm under impedance control leans on an obstacle and moves a little, in MuJoCo."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from contactsense import InputError
from contactsense.sim import (
    ContactPath,
    ContactRun,
    Pace,
    TouchScene,
    joint_exploration,
    null_space_exploration,
    perturbed_model,
    record_run,
    sliding_exploration,
    touch_scene,
)
from contactsense.sim._arrays import FloatArray
from contactsense.sim.quasi_static import gravity_torques

from .arm import Arm
from .experiments import Experiment

COLUMNS = [field.name for field in fields(ContactRun) if field.name != "settings"]
TRIES = 10
RATE = 25.0  # of the filter's updates [Hz]
PACES = {  # some 10 s each
    "random": Pace(motions=40, duration=0.25),
    "deliberate": Pace(motions=20, duration=0.5),
    "null space": Pace(motions=20, duration=0.5),
}
TRAVEL = 0.08  # of the touched point, to and fro [m]
TURN = np.deg2rad(20.0)  # of a joint, at most, for that
ELBOW = np.deg2rad(12.0)  # of the joints, before they are projected
OBSERVER_GAIN = 200.0  # [1/s]
LEAST = 0.6  # share of the run that must be in contact
STIFFNESS = (1e3, 1e4)  # of the contact [N/m]
# Bent and clear of singular poses: shares of half of each joint's range, from its middle.
POSES = (
    (0.15, 0.3, -0.1, -0.5, 0.2, 0.4, 0.0),
    (-0.3, -0.35, 0.2, 0.55, -0.3, -0.5, 0.3),
    (0.5, 0.45, 0.35, -0.4, -0.25, 0.6, -0.3),
    (-0.6, -0.25, -0.3, -0.65, 0.4, -0.35, 0.5),
    (0.0, 0.5, 0.15, 0.6, -0.4, 0.45, 0.1),
)


def record(arm: Arm, experiment: Experiment, link: str, number: int, seed: int) -> ContactRun:
    """One run in which `link` touches the obstacle from the first sample to the last.

    Raises:
        InputError: the link cannot be touched so.
    """
    cause: InputError | None = None
    for chance in np.random.SeedSequence(seed).generate_state(TRIES).tolist():
        try:
            scene = _scene(arm, experiment, link, number, chance)
            run = _record(arm, experiment, scene, _path(arm, experiment, scene, chance), chance)
            return _in_contact(run)
        except InputError as refused:
            cause = refused
    raise InputError(f"link: '{link}' does not keep a contact in {TRIES} scenes") from cause


def _scene(arm: Arm, experiment: Experiment, link: str, number: int, seed: int) -> TouchScene:
    chosen = experiment.setup != "random"
    return touch_scene(
        arm.robot,
        link,
        kind=experiment.obstacle,
        q=_pose(arm, number) if chosen else None,
        force_range=(20.0, 40.0) if chosen else (5.0, 40.0),
        stiffness_range=STIFFNESS,
        least_torque=1.0 if chosen else 0.5,
        seed=seed,
    )


def _pose(arm: Arm, number: int) -> FloatArray:
    low = np.maximum(arm.robot.model.lowerPositionLimit, -np.pi)
    high = np.minimum(arm.robot.model.upperPositionLimit, np.pi)
    shares = np.resize(POSES[number % len(POSES)], arm.robot.nq)
    pose: FloatArray = 0.5 * (low + high) + 0.5 * shares * (high - low)
    return pose


def _path(arm: Arm, experiment: Experiment, scene: TouchScene, seed: int) -> ContactPath:
    pace = PACES[experiment.setup]
    if experiment.setup == "random":
        return joint_exploration(arm.robot, scene, pace=pace, seed=seed)
    if experiment.setup == "deliberate":
        return sliding_exploration(arm.robot, scene, travel=TRAVEL, largest=TURN, pace=pace, seed=seed)
    return null_space_exploration(arm.robot, scene, arm.links[-1], amplitude=ELBOW, pace=pace, seed=seed)


def _record(arm: Arm, experiment: Experiment, scene: TouchScene, path: ContactPath, seed: int) -> ContactRun:
    true_model = arm.robot.model
    if experiment.model_error:
        true_model = perturbed_model(arm.robot.model, mass=experiment.model_error, seed=seed)
    contact = scene.contact(arm.robot, friction=experiment.friction)
    run = record_run(arm.robot, contact, path, true_model=true_model, observer_gain=OBSERVER_GAIN, rate=RATE)
    # What is felt in the first pose without a contact is known before there is one.
    return replace(run, external_torque=run.external_torque - _offset(arm, true_model, path.q[0]))


def _offset(arm: Arm, true_model: Any, q: FloatArray) -> FloatArray:
    """External torque that an arm of other weight seems to feel at rest."""
    weight, known = (gravity_torques(model, q[None])[0] for model in (true_model, arm.robot.model))
    offset: FloatArray = known - weight
    return offset


def _in_contact(run: ContactRun) -> ContactRun:
    """The run to where the contact is lost first.

    Raises:
        InputError: that is too short.
    """
    held = [link == run.link[0] for link in run.link]
    end = held.index(False) if False in held else len(held)
    if end < LEAST * len(run):
        raise InputError("the contact is lost")
    return ContactRun(**{name: getattr(run, name)[:end] for name in COLUMNS}, settings=run.settings)
