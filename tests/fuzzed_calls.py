"""Calls everything public with random objects; run as a program, so that an abort is seen by its parent.

python tests/fuzzed_calls.py SECONDS COUNT SEED
"""

import inspect
import signal
import sys
import time
import warnings
from collections import Counter
from types import FrameType

import numpy as np

import contactsense as cs

# Names that serve, listen or read folders: they have tests of their own, and wait by design.
LEFT_OUT = {"view", "View", "replay_fleet", "FleetReplay"}
# What a call may raise besides the errors of the package.
EXPECTED = (cs.ContactSenseError, TypeError, MemoryError, OSError)
# A call that takes longer is stopped: some arguments ask for much work (s).
LONGEST = 2.0


class Raising:
    """An array-like whose conversion fails."""

    def __array__(self, dtype=None, copy=None):
        raise TypeError("not an array")

    def __float__(self):
        raise TypeError("not a number")


class Stopped(BaseException):
    """A call that took too long."""


def stop(_signal: int, _frame: FrameType | None) -> None:
    raise Stopped


def array(random: np.random.Generator) -> np.ndarray:
    """An array of any type, shape and stride."""
    dtype = random.choice(["f8", "f4", "f2", "i8", "u1", "?", "c16", "U3", "O", ">f8", "M8[s]"])
    shape = tuple(random.choice([0, 1, 3, 6, 7, 8], size=random.integers(0, 4)))
    made = np.zeros(shape, dtype=dtype)
    if made.dtype.kind == "f" and made.size:
        made.reshape(-1)[0] = random.choice([np.nan, np.inf, 1.0, 6e4])
    match random.integers(5):
        case 0:
            return made.T
        case 1 if made.ndim:
            return made[::-1]
        case 2:
            return np.ma.masked_array(made)
        case 3:
            return np.broadcast_to(made, (2, *made.shape))
    return made


def value(random: np.random.Generator, valid: list[object]) -> object:
    """Anything: often what would be right somewhere."""
    match random.integers(8):
        case 0 | 1 | 2:
            return valid[random.integers(len(valid))]
        case 3 | 4:
            return array(random)
        case 5:
            return random.choice([np.nan, np.inf, -1.0, 0.0, 5e-324, 1e308, 0.5])
        case 6:
            odd = [None, "", "\0", "é" * 50, b"x", 2**70, -(2**63), 3, True, 1j, object(), Raising(), print]
            return odd[random.integers(len(odd))]
    return random.choice([0, 1]) * [[1.0, [2.0, [3.0]]], {"a": 1}] or [[0.0] * 7] * 3


def made(robot: cs.Robot) -> list[object]:
    """One object of each class that is easily made."""
    q = np.full(7, 0.3)
    sensor = cs.ForceTorqueSensor("wrist", robot.link_names[-1])
    monitor = cs.ContactMonitor(robot, dt=1e-3, samples=50)
    contacts = cs.ContactIsolator(robot, torque_threshold=0.5, samples=50)
    contact_map = cs.ContactMap(robot, samples=50)
    particle_filter = cs.ContactParticleFilter(robot, particles=20)
    sampler = cs.StaticObstacleSampler(robot, particles=20, window=5)
    report = monitor.update(q, np.zeros(7), np.ones(7))
    return [
        robot,
        robot.surface(robot.link_names[-1]),
        sensor,
        monitor,
        contacts,
        contact_map,
        particle_filter,
        sampler,
        cs.MomentumObserver(robot, dt=1e-3),
        cs.LoadCompensator(robot, [sensor]),
        cs.Calibration.of_description(robot),
        cs.NoiseModel(),
        report,
        contacts.isolate(q, np.ones(7)),
        contact_map.evaluate(q, np.ones(7)),
        particle_filter.particles,
    ]


def callables(objects: list[object]) -> list[tuple[str, object]]:
    """Every public name of the package, and every public method of the objects."""
    found = [(name, getattr(cs, name)) for name in cs.__all__ if name not in LEFT_OUT]
    for item in objects:
        for name, _ in inspect.getmembers(type(item)):
            if not name.startswith("_") and callable(method := getattr(item, name, None)):
                found.append((f"{type(item).__name__}.{name}", method))
    return [(name, call) for name, call in found if callable(call)]


def arguments(call: object, random: np.random.Generator, valid: list[object]) -> tuple[list, dict]:
    """Positional arguments and some by name, as the signature has them."""
    try:
        parameters = list(inspect.signature(call).parameters.values())
    except (TypeError, ValueError):
        return [value(random, valid) for _ in range(random.integers(4))], {}
    named = [p for p in parameters if p.kind is p.KEYWORD_ONLY]
    placed = [p for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD]
    count = len(placed) if random.integers(8) else random.integers(len(placed) + 2)
    chosen = {p.name: value(random, valid) for p in named if p.default is p.empty or not random.integers(3)}
    return [value(random, valid) for _ in range(count)], chosen


def main(seconds: float, count: int, seed: int) -> int:
    """Calls until the time or the count is over; the number of wrong outcomes."""
    warnings.simplefilter("ignore")
    signal.signal(signal.SIGALRM, stop)
    random = np.random.default_rng(seed)
    robot = cs.Robot.named("iiwa14")
    objects = made(robot)
    calls = callables(objects)
    valid = [
        *objects,
        np.full(7, 0.3),
        np.zeros(7),
        np.zeros(6),
        np.zeros((4, 3)),
        1e-3,
        0.1,
        10,
        robot.link_names[-1],
    ]
    outcomes: Counter[str] = Counter()
    wrong: Counter[str] = Counter()
    start, done = time.monotonic(), 0
    while done < count and time.monotonic() - start < seconds:
        name, call = calls[random.integers(len(calls))]
        if isinstance(call, type) and issubclass(call, BaseException):
            continue
        placed, named = arguments(call, random, valid)
        done += 1
        try:
            signal.setitimer(signal.ITIMER_REAL, LONGEST)
            call(*placed, **named)
            outcomes["answered"] += 1
        except EXPECTED as error:
            outcomes[type(error).__name__] += 1
        except Stopped:
            outcomes["stopped"] += 1
        except BaseException as error:
            wrong[f"{name}: {type(error).__name__}: {str(error)[:100]}"] += 1
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
    robot.mass_matrix(np.zeros(7))
    print(
        f"{done} calls of {len(calls)} callables, seed {seed}: {dict(outcomes)}; {sum(wrong.values())} wrong"
    )
    for text, times in wrong.most_common(40):
        print(f"  {times} x {text}")
    return len(wrong)


if __name__ == "__main__":
    sys.exit(min(main(float(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])), 1))
