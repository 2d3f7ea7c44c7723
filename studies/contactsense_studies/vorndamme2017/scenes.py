"""What is done to the robot: one, two or five pushes at once, in one pose or in many (VI-A to VI-C)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, cycle, islice
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from contactsense import InputError, Robot
from contactsense.sim._arrays import FloatArray
from contactsense.sim.sampling import (
    CONE,
    FORCES,
    Touch,
    lines,
    random_configuration,
    touches_in_pose,
)

# Standing with bent knees, arms ahead with bent elbows: no chain is stretched. Mirrored for the right side.
STANDING = {
    "back_bkz": 0.1,
    "back_bky": 0.15,
    "back_bkx": -0.05,
    "neck_ry": 0.2,
    "l_arm_shz": -0.4,
    "l_arm_shx": -0.9,
    "l_arm_ely": 2.0,
    "l_arm_elx": 1.3,
    "l_arm_wry": -0.4,
    "l_arm_wrx": 0.5,
    "l_arm_wry2": 0.3,
    "l_leg_hpz": 0.1,
    "l_leg_hpx": 0.15,
    "l_leg_hpy": -0.6,
    "l_leg_kny": 1.1,
    "l_leg_aky": -0.5,
    "l_leg_akx": -0.15,
}
# Sign of the right joint's angle where the left one's is positive.
MIRRORED = {"shz": -1, "shx": -1, "ely": 1, "elx": -1, "wry": 1, "wrx": -1, "wry2": 1}
MIRRORED |= {"hpz": -1, "hpx": -1, "hpy": 1, "kny": 1, "aky": 1, "akx": -1}

HANDS_AND_FEET = ("l_hand", "r_hand", "l_foot", "r_foot")
FIFTH_LINKS = ("ltorso", "mtorso", "utorso", "l_clav", "r_clav")
SCENES_PER_POSE = 25
FRUITLESS_POSES = 20

Draw: TypeAlias = Callable[[FloatArray, int, np.random.Generator], "list[Scene]"]


class Scene(NamedTuple):
    """A pose and the pushes in it, all at once."""

    q: FloatArray  # (nq,)
    touches: list[Touch]

    @property
    def links(self) -> tuple[str, ...]:
        """The links touched."""
        return tuple(touch.link for touch in self.touches)


def standing_pose(robot: Robot) -> FloatArray:
    """Atlas standing with bent knees and elbows `(nq,)`; joints of other names stay at neutral."""
    angles = dict(STANDING)
    for name, angle in STANDING.items():
        side, _, rest = name.partition("_")
        if side == "l":
            angles[f"r_{rest}"] = angle * MIRRORED[rest.rpartition("_")[2]]
    return robot.configuration({name: angle for name, angle in angles.items() if name in robot.joint_names})


def singles(
    robot: Robot, count: int, seed: int = 0, *, cone: float = CONE, random_poses: bool = False
) -> list[Scene]:
    """One push each, its point uniform over all of the surface that a straight line can reach.

    Forces of 1 to 50 N push within `cone` [rad] of the inward normal. The pose is `standing_pose`, or a
    random one for every few scenes.
    """

    def draw(q: FloatArray, wanted: int, rng: np.random.Generator) -> list[Scene]:
        return [Scene(q, [touch]) for touch in _by_area(robot, q, wanted, rng, cone)]

    return _collect(robot, count, [seed, 1], draw, random_poses)


def pairs(
    robot: Robot,
    count: int,
    seed: int = 0,
    *,
    by: Literal["links", "area"] = "links",
    cone: float = CONE,
    random_poses: bool = False,
) -> list[Scene]:
    """Two pushes on different links.

    Args:
        robot: whose surface is pushed.
        count: how many pairs.
        seed: same seed, same pairs.
        by: "links": every pair of links equally often, points by area on each; "area": both points uniform
            over all of the surface, as in `singles`.
        cone: greatest angle between a force and the inward normal [rad].
        random_poses: a random pose for every few scenes in place of `standing_pose`.
    """
    if by not in ("links", "area"):
        raise InputError(f"by: must be 'links' or 'area', not {by!r}")
    order = list(combinations(robot.link_names, 2))
    np.random.default_rng([seed, 0]).shuffle(order)
    every = cycle(order)

    def draw_links(q: FloatArray, wanted: int, rng: np.random.Generator) -> list[Scene]:
        return _on_links(robot, q, list(islice(every, wanted)), rng, cone)

    def draw_area(q: FloatArray, wanted: int, rng: np.random.Generator) -> list[Scene]:
        found = _by_area(robot, q, 2 * wanted, rng, cone)
        both = zip(found[::2], found[1::2], strict=False)
        return [Scene(q, [first, second]) for first, second in both if first.link != second.link]

    return _collect(robot, count, [seed, 2], draw_links if by == "links" else draw_area, random_poses)


def fives(
    robot: Robot, count: int, seed: int = 0, *, cone: float = CONE, random_poses: bool = False
) -> list[Scene]:
    """Five pushes: both hands, both feet, and a torso or first shoulder link.

    Raises:
        InputError: the robot lacks these links.
    """
    lacking = sorted({*HANDS_AND_FEET, *FIFTH_LINKS}.difference(robot.link_names))
    if lacking:
        raise InputError(f"robot: has no surface on {', '.join(lacking)}; this study needs Atlas")
    order = cycle([(*HANDS_AND_FEET, link) for link in FIFTH_LINKS])

    def draw(q: FloatArray, wanted: int, rng: np.random.Generator) -> list[Scene]:
        return _on_links(robot, q, list(islice(order, wanted)), rng, cone)

    return _collect(robot, count, [seed, 5], draw, random_poses)


def _on_links(
    robot: Robot, q: FloatArray, groups: Sequence[tuple[str, ...]], rng: np.random.Generator, cone: float
) -> list[Scene]:
    """A scene for each group of links, where all can be reached."""
    needed = Counter(link for group in groups for link in group)
    found = {link: touches_in_pose(robot, q, link, n, rng, cone) for link, n in sorted(needed.items())}
    reached = {link: _spread(found[link], needed[link]) for link in found}
    scenes = []
    for group in groups:
        touches = [next(reached[link], None) for link in group]
        if all(touches):
            scenes.append(Scene(q, [touch for touch in touches if touch is not None]))
    return scenes


def _spread(touches: Sequence[Touch], wanted: int) -> Iterator[Touch]:
    """All of `touches`, those of a link that can hardly be reached more than once."""
    return islice(cycle(touches), wanted)


def _by_area(robot: Robot, q: FloatArray, count: int, rng: np.random.Generator, cone: float) -> list[Touch]:
    """About `count` touches uniform over all surfaces, in random order."""
    areas = np.array([robot.surface(link).area for link in robot.link_names])
    counts = rng.multinomial(3 * count, areas / areas.sum())
    found = []
    for link, drawn in zip(robot.link_names, counts, strict=True):
        if drawn:
            points, directions = lines(robot, q, link, int(drawn), rng, cone)
            found += [(link, p, d) for p, d in zip(points, directions, strict=True)]
    chosen = rng.permutation(len(found))[:count]
    sizes = rng.uniform(*FORCES, len(chosen))
    return [
        Touch(found[i][0], q, found[i][1], found[i][2] * size) for i, size in zip(chosen, sizes, strict=True)
    ]


def _collect(robot: Robot, count: int, seed: list[int], draw: Draw, random_poses: bool) -> list[Scene]:
    if count < 1:
        raise InputError(f"count: must be at least 1, not {count}")
    rng = np.random.default_rng(seed)
    scenes: list[Scene] = []
    fruitless = 0
    while len(scenes) < count:
        q = random_configuration(robot, rng) if random_poses else standing_pose(robot)
        missing = count - len(scenes)
        more = draw(q, min(missing, SCENES_PER_POSE) if random_poses else missing, rng)
        fruitless = 0 if more else fruitless + 1
        if fruitless > FRUITLESS_POSES:
            raise InputError("robot: these links cannot be reached on a straight line")
        scenes += more
    return scenes[:count]
