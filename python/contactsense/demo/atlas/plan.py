"""Where and when Atlas is pushed, drawn at random."""

from __future__ import annotations

import numpy as np

from ... import Robot
from ...errors import ContactSenseError
from ...sim import Push, random_push
from ...sim.sampling import blocked
from ..settings import FloatArray

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
_TRIES = 1000


def plan_pushes(robot: Robot, q: FloatArray, seed: int) -> tuple[Push, ...]:
    """Pushes on `PLACES` in turn: half-sines at random points, within 30 degrees of the inward normal.

    What pushes comes along a straight line: points whose line of force is barred by the robot are redrawn.
    """
    generator = np.random.default_rng([seed, 1])
    pushes = []
    for number, links in enumerate(PLACES):
        link = links[generator.integers(len(links))]
        start = _FIRST + _SPACING * number + generator.uniform(0.0, _LATER)
        pushes.append(_free_push(robot, q, link, start, generator))
    return tuple(pushes)


def _free_push(robot: Robot, q: FloatArray, link: str, start: float, generator: np.random.Generator) -> Push:
    force, duration = generator.uniform(*FORCE_RANGE), generator.uniform(*DURATION_RANGE)
    surface, pose = robot.surface(link), robot.link_pose(q, link)
    for _ in range(_TRIES):
        seed = int(generator.integers(2**31))
        push = random_push(link, surface, peak_force=force, start=start, duration=duration, seed=seed)
        point, along = push.force_at(start + 0.5 * duration, pose)
        if not blocked(robot, q, link, point[None], along[None] / force)[0]:
            return push
    raise ContactSenseError(f"seed: '{link}' cannot be pushed along a free line; try another seed")
