"""What a user sees where something is wrong: the package's exceptions, by name of the argument."""

import pickle

import numpy as np
import pytest

import contactsense as cs
from contactsense import errors


@pytest.fixture(scope="module")
def robot():
    return cs.Robot.named("iiwa14")


@pytest.mark.parametrize("name", ["ContactSenseError", "ModelError", "GeometryError", "InputError"])
def test_exceptions_read_and_pickle_as_the_packages(name):
    kind = getattr(cs, name)
    assert kind is getattr(errors, name)
    assert f"{kind.__module__}.{kind.__qualname__}" == f"contactsense.{name}"
    assert kind.__doc__
    copy = pickle.loads(pickle.dumps(kind("said")))
    assert type(copy) is kind
    assert copy.args == ("said",)


def test_an_input_error_is_a_value_error():
    assert cs.InputError.__mro__[1:4] == (cs.ContactSenseError, ValueError, Exception)
    with pytest.raises(ValueError, match="name"):
        cs.Robot.named("nobody")


WRONG = {
    "pushing: expected True or False, got 1": lambda r: cs.ContactIsolator(r, pushing=1),
    "pushing: expected True or False, got 'no'": lambda r: cs.ContactMonitor(r, dt=1e-3, pushing="no"),
    "dt: expected a number, got 'fast'": lambda r: cs.MomentumObserver(r, dt="fast"),
    "dt: expected a number, got None": lambda r: cs.ContactMonitor(r, dt=None),
    "dt: expected a number, got \\[\\]": lambda r: cs.MomentumObserver(r, dt=1e-3).update(
        np.zeros(7), np.zeros(7), np.zeros(7), dt=[]
    ),
    "hold_time: expected a number": lambda r: cs.ContactMonitor(r, dt=1e-3, hold_time="x"),
    "wrench_gain: expected a number": lambda r: cs.ContactMonitor(r, dt=1e-3, wrench_gain="x"),
    "bias_time_constant: expected a number": lambda r: cs.ContactMonitor(r, dt=1e-3, bias_time_constant="x"),
    "bias_settle_time: expected a number": lambda r: cs.ContactMonitor(r, dt=1e-3, bias_settle_time="x"),
    "observer_gain": lambda r: cs.ContactMonitor(r, dt=1e-3, observer_gain="x"),
    "torque_threshold": lambda r: cs.ContactIsolator(r, torque_threshold={}),
    "wrench_threshold": lambda r: cs.ContactIsolator(r, wrench_threshold="x"),
    "sensors: expected": lambda r: cs.ContactIsolator(r, sensors=5),
    "sensors: expected ": lambda r: cs.LoadCompensator(r, ["wrist"]),
    "wanted_contacts: expected": lambda r: cs.ContactIsolator(r, wanted_contacts="hand"),
    "wanted_contacts: expected an": lambda r: cs.ContactMonitor(r, dt=1e-3, wanted_contacts=[5]),
    "max_contacts": lambda r: cs.ContactIsolator(r, max_contacts=2.5),
    "robot: expected a contactsense.Robot": lambda r: cs.MomentumObserver("iiwa14", dt=1e-3),
    "robot: expected a": lambda r: cs.ContactMonitor(None, dt=1e-3),
    "robot: expected": lambda r: cs.ContactIsolator(5),
    "robot: ": lambda r: cs.LoadCompensator(5, []),
    "robot: expected a contactsense.Robot, got": lambda r: cs.ContactParticleFilter("iiwa14"),
    "link: expected a string, got 5": lambda r: r.link_pose(np.zeros(7), 5),
    "link: expected a string, got None": lambda r: r.jacobian(np.zeros(7), None),
    "link: expected a string": lambda r: r.surface(b"hand"),
    "name: expected a string": lambda r: cs.ForceTorqueSensor(1, "hand"),
    "link: expected a string, got 1": lambda r: cs.ForceTorqueSensor("wrist", 1),
    "convention: expected a string": lambda r: cs.ForceTorqueSensor("wrist", "hand", convention=1),
    "geometry": lambda r: cs.Robot.from_urdf("x.urdf", geometry=5),
    "geometry: must": lambda r: cs.Robot.from_urdf("x.urdf", geometry=np.zeros(2)),
    "floating_base": lambda r: cs.Robot.from_urdf("x.urdf", floating_base="no"),
    "package_dirs": lambda r: cs.Robot.from_urdf("x.urdf", package_dirs=7),
}


@pytest.mark.parametrize("text", WRONG)
def test_a_wrong_type_is_refused_by_name(robot, text):
    with pytest.raises(cs.InputError, match=text):
        WRONG[text](robot)


def test_a_number_that_is_nan_is_not_called_another_type(robot):
    with pytest.raises(cs.InputError, match="dt"):
        cs.MomentumObserver(robot, dt=float("nan"))
