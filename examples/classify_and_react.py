"""What kind a contact is, and a reaction to it: retreat from a clamped thing, yield to a person, else stop.

The hand of a simulated arm meets a wall and a ball, and a person pushes it.
Requires MuJoCo: pip install '.[sim]'
"""

from collections.abc import Callable

import numpy as np

import contactsense as cs
from contactsense import sim

DT = 0.001  # [s]
SPEED = 0.2  # of the hand [m/s]
START, END = 0.4, 2.0  # of the motion [s]
DECIDE = 0.15  # age of a contact at which its kind is taken [s]
GAP, STIFFNESS, BALL = 0.04, 10_000.0, 1.0  # to the wall or ball [m], [N/m], [kg]
LINK = "iiwa_link_7"

robot = cs.Robot.named("iiwa14")
Thing = Callable[[float, float], float]  # force on the hand [N], of the time [s] and the way of the hand [m]


def wall(time: float, way: float) -> float:
    return STIFFNESS * max(0.0, way - GAP)


class Ball:
    """Lies in front of the hand, and rolls away."""

    def __init__(self) -> None:
        self.place, self.speed = GAP, 0.0

    def __call__(self, time: float, way: float) -> float:
        force = STIFFNESS * max(0.0, way - self.place)
        self.speed += DT * force / BALL
        self.place += DT * self.speed
        return force


def person(time: float, way: float) -> float:
    return 30.0 * float(np.clip((time - 0.6) / 0.3, 0.0, 1.0) * (time < 1.6))


def choose(contact: cs.ContactClass) -> str:
    """The name of a reaction to a contact."""
    if contact.intended > 0.5:
        return "give way"
    return "retract" if contact.kind == "clamped" else "stop"


def meet(thing: Thing, moves: bool) -> tuple[cs.ContactClass, str, float, float]:
    """What the contact was said to be, the reaction, the largest force and the force at the end [N]."""
    real = sim.perturbed_model(robot.model, mass=0.02, seed=0)
    arm = sim.SimulatedRobot(real, dt=DT, noise=sim.TorqueNoise(newton_metres=0.05, seed=0))
    monitor = cs.ContactMonitor(robot, dt=DT, torque_threshold=1.0, bias_time_constant=0.3)
    classifier, reaction = cs.ContactClassifier(robot, dt=DT), cs.Reaction(robot, dt=DT)
    controller = sim.ComputedTorqueController(robot.model, kp=2500.0, kd=100.0)
    goal, v = np.array([0.3, 0.6, -0.4, -1.4, 0.5, 1.2, 0.1]), np.zeros(robot.nv)
    arm.reset(goal)
    point_local = robot.surface(LINK).closest_points([[0.3, 0.0, 0.04]]).points[0]
    first = (arm.link_pose(LINK) @ [*point_local, 1.0])[:3]
    way, said, forces = "go on", None, []
    while arm.time < END:
        point = (arm.link_pose(LINK) @ [*point_local, 1.0])[:3]
        forces.append(thing(arm.time, point[0] - first[0]))
        arm.clear_forces()
        arm.apply_force(LINK, point, [-forces[-1], 0.0, 0.0])
        if way == "give way":
            tau = reaction.gravity_compensation(arm.q, arm.v)
        else:
            tau = controller.torque(arm.q, arm.v, sim.TrajectoryPoint(goal, v, np.zeros(robot.nv)))
        measured = arm.step(tau)
        report = monitor.update(measured.q, measured.v, measured.tau_mean)
        contacts = classifier.update(measured.q, measured.v, report)
        if report.onset and way == "go on":
            way = "stop"  # at once, whatever it is
        if contacts and said is None and (contacts[0].duration >= DECIDE or not contacts[0].running):
            said = contacts[0]
            way = choose(said)
            reaction.reset()
        if way == "stop":
            v = reaction.stop(v)
        elif way == "retract":
            v = reaction.retract(v, report.collision_torque)
        elif moves and arm.time > START:
            v = np.linalg.pinv(robot.jacobian(goal, LINK, point)[:3], rcond=0.05) @ [SPEED, 0.0, 0.0]
        goal = goal + DT * v
    return said, way, max(forces), forces[-1]


for name, thing, moves in (("wall", wall, True), ("ball", Ball(), True), ("person", person, False)):
    said, way, largest, last = meet(thing, moves)
    print(
        f"{name}: {said.kind} {getattr(said, said.kind):.0%}, intended {said.intended:.0%}; {way}; ", end=""
    )
    print(f"{largest:.0f} N at most, {last:.0f} N at the end")
