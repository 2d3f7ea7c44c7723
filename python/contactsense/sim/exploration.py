"""Small motions in contact, planned so that the contact is kept.

From pose to pose the arm moves by random or deliberate steps; each pose is then corrected, by the least
change of the joints, until the link is as deep in the obstacle as planned. So the force stays within a band,
while the contact wanders over the surface.
"""

from __future__ import annotations

import numpy as np

from contactsense import Robot
from contactsense.errors import InputError

from ._arrays import FloatArray, positive, tangents
from .contact_path import ContactPath, Pace
from .contact_plan import HeldLink, plan
from .scene import TouchScene


def joint_exploration(
    robot: Robot,
    scene: TouchScene,
    *,
    amplitude: float = np.deg2rad(2.0),
    force_band: tuple[float, float] = (0.5, 1.5),
    pace: Pace | None = None,
    seed: int = 0,
) -> ContactPath:
    """Random poses around the scene's: each joint is drawn uniformly, then the pose is corrected.

    Args:
        robot: on a fixed base, its joints with one coordinate each.
        scene: the contact that is kept.
        amplitude: largest change of a joint before the correction [rad].
        force_band: the planned force, as shares of the scene's; uniform in the band.
        pace: of the motions.
        seed: same seed, same path.

    Raises:
        InputError: names the argument; also if the contact cannot be kept.
    """
    positive("amplitude", amplitude)

    def step(_: int, rng: np.random.Generator) -> FloatArray:
        offset: FloatArray = amplitude * rng.uniform(-1.0, 1.0, robot.nv)
        return offset

    return plan(robot, scene, step, force_band, pace or Pace(), seed)


def sliding_exploration(
    robot: Robot,
    scene: TouchScene,
    *,
    travel: float = 0.04,
    largest: float = np.deg2rad(10.0),
    force_band: tuple[float, float] = (0.5, 1.5),
    pace: Pace | None = None,
    seed: int = 0,
) -> ContactPath:
    """Deliberate motions that move the contact along the surface, to and fro in all tangential directions.

    Args:
        robot: on a fixed base, its joints with one coordinate each.
        scene: the contact that is kept.
        travel: of the contact point from where it was, along the obstacle [m]; as far as the joints allow.
        largest: change of a joint [rad].
        force_band: as for `joint_exploration`.
        pace: of the motions.
        seed: same seed, same path.

    Raises:
        InputError: names the argument; also if the contact cannot be kept.
    """
    positive("travel", travel)
    positive("largest", largest)
    jacobian = robot.jacobian(scene.q, scene.link, scene.point)[:3]
    # Damped, so that directions which the joints hardly move do not ask for large turns.
    along = np.stack(tangents(scene.normal)) @ jacobian
    inverse = along.T @ np.linalg.inv(along @ along.T + 1e-2 * np.trace(along @ along.T) * np.eye(2))
    golden = np.pi * (3.0 - np.sqrt(5.0))

    def step(k: int, rng: np.random.Generator) -> FloatArray:
        # Successive directions differ by the golden angle: any few of them cover all directions.
        angle = golden * k + 0.2 * rng.normal()
        offset = inverse @ (travel * np.array([np.cos(angle), np.sin(angle)]))
        bounded: FloatArray = offset * min(1.0, largest / max(float(np.abs(offset).max()), 1e-12))
        return bounded

    return plan(robot, scene, step, force_band, pace or Pace(), seed)


def null_space_exploration(
    robot: Robot,
    scene: TouchScene,
    hand: str,
    *,
    amplitude: float = np.deg2rad(5.0),
    hold: str = "position",
    force_band: tuple[float, float] = (0.3, 1.7),
    pace: Pace | None = None,
    seed: int = 0,
) -> ContactPath:
    """Motions in the null space of the hand's task: the hand stays where it is, the elbow moves.

    Args:
        robot: on a fixed base, its joints with one coordinate each.
        scene: the contact that is kept.
        hand: link whose origin is held; not the contact link, nor before it.
        amplitude: of the random turns that are projected into the null space [rad].
        hold: "position", which leaves a seven-joint arm four directions, or "pose", which leaves it one: then
            the force band alone says how far the elbow goes.
        force_band: as for `joint_exploration`.
        pace: of the motions.
        seed: same seed, same path.

    Raises:
        InputError: names the argument; also if the contact cannot be kept.
    """
    positive("amplitude", amplitude)
    if hold not in ("position", "pose"):
        raise InputError(f"hold must be 'position' or 'pose', not {hold!r}")
    rows = 3 if hold == "position" else 6
    task = robot.jacobian(scene.q, hand)[:rows]
    if robot.nv <= rows or not np.abs(task).max() > 0.0:
        raise InputError(f"hand: holding '{hand}' leaves this robot no motion, or it does not move")
    _, _, rest = np.linalg.svd(task)
    basis = rest[rows:]

    def step(_: int, rng: np.random.Generator) -> FloatArray:
        offset: FloatArray = basis.T @ (basis @ (amplitude * rng.uniform(-1.0, 1.0, robot.nv)))
        return offset

    return plan(robot, scene, step, force_band, pace or Pace(), seed, HeldLink(robot, hand, scene.q, rows))
