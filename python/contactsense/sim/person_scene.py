"""An imperfect arm among people."""

from __future__ import annotations

from dataclasses import dataclass

from contactsense import Robot

from .imperfect_arm import ImperfectArm
from .imperfect_record import record_imperfect
from .imperfect_run import ImperfectRun
from .random_contacts import random_contacts
from .random_moves import random_moves


@dataclass(frozen=True)
class PersonScene:
    """Moves and rests of an arm, and a person who pushes it."""

    seconds: float = 60.0  # [s]
    contacts: int = 15  # 0: only free motion
    contact_free: float = 10.0  # at the start [s]; what there is of `seconds` if nobody pushes
    force: tuple[float, float] = (3.0, 60.0)  # [N], see `random_contacts`
    duration: tuple[float, float] = (0.1, 1.0)  # of a contact [s]
    friction: float = 0.5  # between person and arm
    links: tuple[str, ...] | None = None  # that are pushed; None: all that move
    speed: tuple[float, float] = (0.15, 0.6)  # share of the velocity limits, see `random_moves`
    rest: tuple[float, float] = (0.2, 3.0)  # after a move [s]
    floor: float | None = 0.0  # height of the ground [m]
    dt: float = 1e-3  # [s]
    seed: int = 0  # of moves, contacts and noise

    def record(self, robot: Robot, arm: ImperfectArm) -> ImperfectRun:
        """What `arm` measures in it, with the truth beside it. Same scene, same run.

        Args:
            robot: as described; fixed base.
            arm: what is wrong with it.

        Raises:
            InputError: names the argument or setting.
        """
        motion = random_moves(
            robot,
            self.seconds,
            dt=self.dt,
            speed=self.speed,
            rest=self.rest,
            floor=self.floor,
            seed=self.seed,
        )
        contacts = random_contacts(
            robot,
            motion,
            self.contacts,
            first=self.contact_free if self.contacts else 0.0,
            force=self.force,
            duration=self.duration,
            friction=self.friction,
            links=self.links,
            seed=self.seed,
        )
        return record_imperfect(robot, arm, motion, contacts, seed=self.seed)
