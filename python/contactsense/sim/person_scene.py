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
    """Moves and rests of an arm, and a person who pushes it.

    Args:
        seconds: in all [s].
        contacts: how many; 0 for free motion alone.
        contact_free: time without contact at the start [s].
        force: the largest of a contact, from and to [N]; see `random_contacts`.
        duration: of a contact, from and to [s].
        friction: coefficient between person and arm.
        links: that are pushed; None: all that move.
        speed: of a move, from and to, as a share of the velocity limits; see `random_moves`.
        rest: after a move, from and to [s].
        floor: height of the ground [m]; None: there is none.
        dt: between rows [s].
        seed: of moves, contacts and noise.
    """

    seconds: float = 60.0
    contacts: int = 15
    contact_free: float = 10.0
    force: tuple[float, float] = (3.0, 60.0)
    duration: tuple[float, float] = (0.1, 1.0)
    friction: float = 0.5
    links: tuple[str, ...] | None = None
    speed: tuple[float, float] = (0.15, 0.6)
    rest: tuple[float, float] = (0.2, 3.0)
    floor: float | None = 0.0
    dt: float = 1e-3
    seed: int = 0

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
            contact_free=self.contact_free if self.contacts else 0.0,
            force=self.force,
            duration=self.duration,
            friction=self.friction,
            links=self.links,
            seed=self.seed,
        )
        return record_imperfect(robot, arm, motion, contacts, seed=self.seed)
