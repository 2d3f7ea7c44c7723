"""Random objects to everything public, several threads on one object: typed errors, never a crash."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import contactsense as cs

PROGRAM = Path(__file__).with_name("fuzzed_calls.py")
# Longer by CONTACTSENSE_FUZZED_CALLS=100000 and CONTACTSENSE_FUZZ_SEED=7.
COUNT = os.environ.get("CONTACTSENSE_FUZZED_CALLS")
SEED = os.environ.get("CONTACTSENSE_FUZZ_SEED", "2")
# Of the short run (s), and of the longest.
SHORT, LONG = "10", "3600"


def test_random_objects_are_answered_or_refused_by_a_typed_error(tmp_path):
    run = [sys.executable, str(PROGRAM), LONG if COUNT else SHORT, COUNT or "1000000", SEED]
    ended = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, timeout=2 * float(LONG))
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert int(ended.stdout.split()[0]) >= min(int(COUNT or 100), 100)


@pytest.mark.parametrize("odd", [np.zeros(3), np.zeros(0), [1.0], 3])
def test_arrays_in_place_of_words_are_refused_by_name(odd, tmp_path):
    robot = cs.Robot.named("iiwa14")
    with pytest.raises(cs.InputError, match="name: "):
        cs.Robot.named(odd)
    for argument in ["external", "columns", "units"]:
        with pytest.raises(cs.InputError, match=f"{argument}: expected"):
            cs.read_log(tmp_path / "log.csv", robot, **{argument: odd})
    with pytest.raises(cs.InputError, match="rate: expected"):
        cs.read_log(tmp_path / "log.csv", robot, rate="fast")


@pytest.mark.parametrize("name", ["monitor", "filter", "sampler", "map", "isolator"])
def test_two_threads_on_one_object_get_answers_or_typed_errors(name):
    robot = cs.Robot.named("iiwa14")
    q, torque = np.full(7, 0.5), np.full(7, 3.0)
    monitor = cs.ContactMonitor(robot, dt=1e-3)
    particle_filter = cs.ContactParticleFilter(robot, particles=2000)
    sampler = cs.StaticObstacleSampler(robot, particles=2000)
    contact_map = cs.ContactMap(robot, samples=2000)
    isolator = cs.ContactIsolator(robot, torque_threshold=0.5)
    call = {
        "monitor": lambda: monitor.update(q, torque, torque),
        "filter": lambda: particle_filter.update(q, torque),
        "sampler": lambda: sampler.update(q, torque),
        "map": lambda: contact_map.evaluate(q, torque),
        "isolator": lambda: isolator.isolate(q, torque),
    }[name]
    answers, wrong = [], []

    def work():
        for _ in range(50):
            try:
                answers.append(call())
            except cs.InputError as error:
                if "in use by another thread" not in str(error):
                    wrong.append(error)
            except BaseException as error:
                wrong.append(error)

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
    assert answers
    assert call() is not None
