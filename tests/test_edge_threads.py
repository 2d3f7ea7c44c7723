"""Threads, signals and memory at the edge between Python and the core."""

import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest
from described import describe_urdf
from robots import EXAMPLE_SHARE

import contactsense as cs
from contactsense import _core


@pytest.fixture(scope="module")
def robot():
    return cs.Robot.named("iiwa14")


def test_an_object_in_use_by_another_thread_is_refused_by_a_typed_error(robot):
    particle_filter = cs.ContactParticleFilter(robot, particles=200_000, seed=1)
    q, torque = np.full(7, 0.5), np.full(7, 3.0)
    refused, wrong = [], []
    done = threading.Event()

    def other():
        while not done.is_set():
            for call in (particle_filter.reset, lambda: particle_filter.particles):
                try:
                    call()
                except cs.InputError as error:
                    refused.append(str(error))
                except BaseException as error:
                    wrong.append(error)

    thread = threading.Thread(target=other)
    thread.start()
    try:
        for _ in range(1000):
            try:
                particle_filter.update(q, torque)
            except cs.InputError as error:
                refused.append(str(error))
            if refused:
                break
    finally:
        done.set()
        thread.join()
    assert not wrong
    assert refused
    assert "in use by another thread" in refused[0]
    particle_filter.update(q, torque)


def test_an_argument_may_use_the_object_it_is_given_to(robot):
    observer = cs.MomentumObserver(robot, dt=1e-3)
    zeros = np.zeros(7)

    class Reentrant:
        def __array__(self, dtype=None, copy=None):
            observer.update(zeros, zeros, zeros)
            observer.acceleration  # noqa: B018
            observer.reset()
            return zeros

    observer.update(zeros, zeros, Reentrant())


def test_other_threads_run_while_a_robot_is_built(tmp_path):
    """With a switch interval of an hour a thread runs only where the lock is released."""
    path = EXAMPLE_SHARE / "example-robot-data/robots/panda_description/urdf/panda.urdf"
    if not path.exists():
        pytest.skip(f"{path} is absent (example-robot-data)")
    described = describe_urdf(path, package_dirs=[EXAMPLE_SHARE])
    turns = 0
    started, done = threading.Event(), threading.Event()

    def other():
        nonlocal turns
        started.set()
        while not done.is_set():
            turns += 1
            time.sleep(0)  # hands the lock back

    interval = sys.getswitchinterval()
    thread = threading.Thread(target=other)
    thread.start()
    started.wait()
    sys.setswitchinterval(3600.0)
    try:
        before = turns
        for _ in range(100):  # so that a busy machine finds the time for the thread
            _core.Robot(tuple(described))
            if turns > before:
                break
        during = turns - before
    finally:
        sys.setswitchinterval(interval)
        done.set()
        thread.join()
    assert during > 0


SLOW = """
    import contactsense as cs, numpy as np, signal, threading, time
    robot = cs.Robot.named("iiwa14")
    surface = robot.surface(robot.link_names[-1])
    rows = np.random.default_rng(0).normal(size=(1_500_000, 3))
    if "{name}" == "update":
        tracker = cs.ContactParticleFilter(robot, particles=2_000_000)
        q, torque = np.full(7, 0.4), np.array([1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
    calls = {{
        "update": lambda: tracker.update(q, torque),
        "sample": lambda: surface.sample(30_000_000),
        "closest_points": lambda: surface.closest_points(rows),
        "cast_rays": lambda: surface.cast_rays(rows, rows),
        "exciting_motion": lambda: cs.exciting_motion(robot, 20.0),
    }}
    main = threading.main_thread().ident
    send = lambda: threading.Timer(0.01, signal.pthread_kill, (main, signal.SIGUSR1)).start()
    handled = []
    signal.signal(signal.SIGUSR1, lambda *_: handled.append(time.monotonic()))
    send()
    start = time.monotonic()
    calls["{name}"]()
    print((handled[0] - start) / (time.monotonic() - start))
    def interrupt(*_):
        raise KeyboardInterrupt
    signal.signal(signal.SIGUSR1, interrupt)
    send()
    try:
        calls["{name}"]()
    except KeyboardInterrupt:
        print("interrupted")
    if "{name}" == "update":
        assert tracker.update(q, torque).event == "started", "what was stopped is forgotten"
"""


def run(script, **options):
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)],
        capture_output=True,
        text=True,
        timeout=300,
        **options,
    )


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="signals of POSIX")
@pytest.mark.parametrize("name", ["sample", "closest_points", "cast_rays", "update", "exciting_motion"])
def test_a_long_call_is_interrupted_between_slices(name):
    """A handler of signals runs in the midst of the call; without slices it would run at its end."""
    ended = run(SLOW.format(name=name))
    assert not ended.returncode, ended.stderr
    share, interrupted = ended.stdout.split()
    assert float(share) < 0.9, ended.stderr
    assert interrupted == "interrupted"


MEMORY = """
    import resource
    import contactsense as cs, numpy as np
    robot = cs.Robot.named("iiwa14")
    surface = robot.surface(robot.link_names[-1])
    rows = np.ones((2_000_000, 3))
    with open("/proc/self/statm") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + {room}, used + {room}))
    try:
        {call}
    except MemoryError as error:
        print(str(error))
    print(len(surface.sample(100).points))
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="a limit on memory that Linux keeps")
@pytest.mark.parametrize(
    ("call", "room"),
    [
        ("surface.sample(100_000_000)", 200_000_000),
        ("surface.closest_points(rows)", 60_000_000),
        ("surface.closest_points(rows)", 20_000_000),
        ("surface.cast_rays(rows, -rows)", 200_000_000),
        ("surface.cast_rays(rows, rows)", 60_000_000),
        ("robot.mass_matrix(np.broadcast_to(np.float64(0.0), 100_000_000))", 200_000_000),
    ],
)
def test_an_answer_that_does_not_fit_into_memory_is_a_memory_error(call, room):
    ended = run(MEMORY.format(call=call, room=room))
    assert ended.returncode == 0, ended.stderr
    text, count = ended.stdout.splitlines()
    assert "memory" in text or "allocate" in text
    assert count == "100"
