"""Array arguments: code that runs while one is read cannot harm the others."""

import contextlib

import numpy as np
import pytest

import contactsense as cs

N = 7


class Saboteur:
    """An array-like whose conversion takes other arrays' memory away."""

    def __init__(self, value, *victims):
        self.value, self.victims = value, victims

    def __array__(self, dtype=None, copy=None):
        for victim in self.victims:
            victim.resize((1 << 20, *victim.shape[1:]), refcheck=False)
            victim.resize((0, *victim.shape[1:]), refcheck=False)
        return np.array(self.value)


class Raising:
    """An array-like and number whose conversion raises."""

    def __init__(self, error):
        self.error = error

    def __array__(self, dtype=None, copy=None):
        raise self.error

    def __float__(self):
        raise self.error

    def __index__(self):
        raise self.error


@pytest.fixture(scope="module")
def robot():
    return cs.Robot.named("iiwa14")


def sensor_of(robot):
    return cs.ForceTorqueSensor("wrist", robot.link_names[-1])


def calls(robot):
    """Functions of array arguments with valid values, by name."""
    sensors = [sensor_of(robot)]
    zeros, wrench = np.zeros(N), np.zeros((1, 6))
    observer = cs.MomentumObserver(robot, dt=1e-3)
    monitor = cs.ContactMonitor(robot, dt=1e-3, sensors=sensors)
    isolator = cs.ContactIsolator(robot, sensors=sensors)
    compensator = cs.LoadCompensator(robot, sensors)
    particle_filter = cs.ContactParticleFilter(robot, particles=10)
    surface = robot.surface(robot.link_names[-1])
    points, direction = np.zeros((3, 3)), np.ones((3, 3))
    return {
        "observer": (
            lambda q, v, tau, friction: observer.update(q, v, tau, friction=friction),
            (zeros, zeros, zeros, zeros),
        ),
        "monitor": (
            lambda q, v, tau, friction, w: monitor.update(q, v, tau, w, friction=friction),
            (zeros, zeros, zeros, zeros, wrench),
        ),
        "isolator": (isolator.isolate, (zeros, zeros, wrench)),
        "compensator": (compensator.update, (zeros, zeros, zeros, wrench)),
        "filter": (particle_filter.update, (zeros, zeros)),
        "inverse_dynamics": (robot.inverse_dynamics, (zeros, zeros, zeros)),
        "forward_dynamics": (robot.forward_dynamics, (zeros, zeros, zeros, zeros)),
        "jacobian": (lambda q, point: robot.jacobian(q, robot.link_names[-1], point), (zeros, np.zeros(3))),
        "cast_rays": (surface.cast_rays, (points, direction)),
    }


NAMES = (
    "observer",
    "monitor",
    "isolator",
    "compensator",
    "filter",
    "inverse_dynamics",
    "forward_dynamics",
    "jacobian",
    "cast_rays",
)


@pytest.mark.parametrize("name", NAMES)
def test_an_argument_that_resizes_the_others_does_no_harm(robot, name):
    call, values = calls(robot)[name]
    for attacker in range(len(values)):
        arguments = [value.copy() for value in values]
        victims = [argument for index, argument in enumerate(arguments) if index != attacker]
        arguments[attacker] = Saboteur(values[attacker], *victims)
        # An array that was converted after the attack is too short; any other was read before it.
        with contextlib.suppress(cs.InputError):
            call(*arguments)
    call(*values)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, MemoryError])
def test_what_is_no_fault_of_an_argument_passes_through(robot, name, error):
    call, values = calls(robot)[name]
    for index in range(len(values)):
        arguments = list(values)
        arguments[index] = Raising(error())
        with pytest.raises(error):
            call(*arguments)


def test_an_exception_of_an_argument_is_the_cause(robot):
    with pytest.raises(cs.InputError, match="q: expected an array of real numbers") as caught:
        robot.mass_matrix(Raising(RuntimeError("mine")))
    assert isinstance(caught.value.__cause__, RuntimeError)


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError])
def test_an_interrupt_in_a_number_passes_through(robot, error):
    with pytest.raises(error):
        cs.MomentumObserver(robot, dt=Raising(error()))
    with pytest.raises(error):
        cs.MomentumObserver(robot, dt=1e-3, gain=Raising(error()))
    with pytest.raises(error):
        robot.surface(robot.link_names[-1]).sample(Raising(error()))


def test_readings_in_column_order_are_read_by_rows(robot):
    sensors = [cs.ForceTorqueSensor(name, name) for name in robot.link_names[-2:]]
    wrenches = np.arange(12.0).reshape(2, 6)
    compensator = cs.LoadCompensator(robot, sensors)
    zeros = np.zeros(N)
    expected = compensator.update(zeros, zeros, zeros, wrenches)
    np.testing.assert_array_equal(
        compensator.update(zeros, zeros, zeros, np.asfortranarray(wrenches)), expected
    )


@pytest.mark.parametrize("count", [100, 5000])
def test_more_numbers_than_joints_are_counted(robot, count):
    with pytest.raises(cs.InputError, match=rf"q: .*7.*{count}"):
        robot.mass_matrix(np.zeros(count))


def test_rows_may_have_any_layout(robot):
    surface = robot.surface(robot.link_names[-1])
    rows = np.arange(12.0).reshape(4, 3)
    packed = np.zeros(4, dtype=[("flag", "u1"), ("row", "f8", 3)])
    packed["row"] = rows
    expected = surface.closest_points(rows).points
    for given in (
        np.asfortranarray(rows),
        np.repeat(rows, 2, axis=0)[::2],
        packed["row"],
        rows.astype(int),
        rows.tolist(),
    ):
        np.testing.assert_array_equal(surface.closest_points(given).points, expected)
    np.testing.assert_array_equal(surface.closest_points(rows[1]).points, expected[1:2])
    for wrong in (rows.T, rows[0, :2], rows[None], 1.0):
        with pytest.raises(cs.InputError, match=r"points: expected an array of shape \(n, 3\)"):
            surface.closest_points(wrong)
    rows[2, 1] = np.nan
    with pytest.raises(cs.InputError, match="points: row 2 must be finite"):
        surface.closest_points(rows)
