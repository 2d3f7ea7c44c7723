"""What is wrong is named; what is well is not. `python tests/faulty_logs.py` is the long version."""

import copy
import doctest
import pickle

import faulty_logs
import numpy as np
import pinocchio as pin
import pytest
from faulty_logs import FAULTS, is_right, shown, simulated
from robots import shared_is_there

import contactsense as cs

# One arm and seed for each fault; the long version takes many.
ARMS = ("iiwa14", "panda", "ur5")
SHORT = {"seconds": 12.0, "rate": 100.0}


@pytest.fixture(scope="module")
def plain():
    return simulated("iiwa14", 70, **SHORT)


@pytest.mark.parametrize("index", range(6))
def test_a_normal_arm_has_no_major_fault(index):
    found = simulated(ARMS[index % 3], 300 + index, **SHORT).findings()
    assert not found, shown(found)


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_is_found_first(name):
    base = simulated(ARMS[list(FAULTS).index(name) % 3], 400, **SHORT)
    case, expected = FAULTS[name](base)
    found = case.findings()
    assert found, expected
    assert is_right(case, found[0], expected), (expected, shown(found))
    assert found[0].severity == "major"
    assert 0.0 <= found[0].evidence <= 1.0


@pytest.mark.shared
def test_faults_of_the_real_arm_are_found():
    assert shared_is_there()
    base = faulty_logs.real_panda(400)
    # Its description has a hand of 0.73 kg, which this arm seems not to carry.
    assert all(finding.severity == "minor" for finding in base.findings())
    for name in ("sign_all", "scale_one", "gravity_free", "permuted", "bias", "velocity_late", "filtered"):
        case, expected = FAULTS[name](base)
        found = case.findings()
        assert found, name
        assert is_right(case, found[0], expected), (name, expected, shown(found))


def test_the_size_and_centre_of_a_payload(plain):
    model = plain.robot.model.copy()
    centre = np.array([0.02, -0.03, 0.12])
    model.inertias[7] += pin.Inertia(2.0, centre, 0.004 * np.eye(3))
    tau = plain.tau + plain.torque(model) - plain.torque(plain.robot.model)
    finding = cs.diagnose(plain.robot, plain.q, plain.v, tau, time=plain.time)[0]
    assert (finding.code, finding.link, finding.unit) == ("payload", "iiwa_link_7", "kg")
    assert finding.value == pytest.approx(2.0, abs=0.2)
    np.testing.assert_allclose(finding.vector, centre, atol=0.03)


def test_the_direction_of_gravity(plain):
    turned = pin.exp3(np.array([0.5, 0.0, 0.0])) @ np.array([0.0, 0.0, -9.81])
    model = plain.robot.model.copy()
    model.gravity = pin.Motion(turned, np.zeros(3))
    tau = plain.tau + plain.torque(model) - plain.torque(plain.robot.model)
    finding = cs.diagnose(plain.robot, plain.q, plain.v, tau)[0]
    assert finding.code == "gravity_direction"
    assert finding.value == pytest.approx(np.rad2deg(0.5), abs=1.5)
    np.testing.assert_allclose(finding.vector, turned, atol=0.25)


def test_two_faults_are_both_found(plain):
    tau = plain.tau.copy()
    tau[:, 1] *= -1
    tau[:, 3] += 12.0
    found = cs.diagnose(plain.robot, plain.q, plain.v, tau)
    assert {(f.code, f.joint) for f in found if f.severity == "major"} == {
        ("sign", plain.robot.joint_names[1]),
        ("bias", plain.robot.joint_names[3]),
    }


def test_a_few_contacts_do_no_harm(plain):
    tau = plain.tau.copy()
    tau[300:350] += [8.0, 20.0, 5.0, 10.0, 1.0, 2.0, 0.5]
    tau[800:830] -= [3.0, 15.0, 2.0, 8.0, 1.0, 1.0, 0.3]
    assert cs.diagnose(plain.robot, plain.q, plain.v, tau) == ()


@pytest.mark.parametrize(("rate", "noise"), [(100, 0.0), (100, 1.0), (500, 1.0)])
@pytest.mark.parametrize("timed", [True, False])
@pytest.mark.parametrize("delay", [0.0, 0.02, 0.05])
def test_a_late_velocity_on_the_recommended_motion(rate, noise, timed, delay):
    # All joints speed up and slow down together: another clock would explain the delay as well.
    robot = cs.Robot.named("iiwa14")
    m = cs.exciting_motion(robot, 15.0, dt=1.0 / rate, seed=1)
    tau = np.array([robot.inverse_dynamics(*row) for row in zip(m.q, m.v, m.a, strict=True)])
    rng = np.random.default_rng(0)
    q, v = (x + noise * sd * rng.standard_normal(x.shape) for x, sd in ((m.q, 1e-5), (m.v, 2e-3)))
    late = round(delay * rate)
    rows = len(q) - late
    found = cs.diagnose(robot, q[late:], v[:rows], tau[late:], time=m.time[late:] if timed else None)
    if not delay:
        assert found == ()
        return
    (finding,) = found
    assert (finding.code, finding.severity) == ("delay", "major")
    assert finding.value == pytest.approx(delay, abs=1e-3)
    assert "the velocity is" in finding.message


def _codes(found):
    return [(finding.code, finding.severity) for finding in found]


@pytest.mark.parametrize("factor", [0.01, 100.0, 1e4, 1e9])
def test_velocities_out_of_all_proportion_are_named(plain, factor):
    finding = cs.diagnose(plain.robot, plain.q, factor * plain.v, plain.tau, time=plain.time)[0]
    assert (finding.code, finding.severity) == ("units", "major")
    assert finding.value == pytest.approx(factor, rel=0.05)


@pytest.mark.parametrize("factor", [100.0, 1e4, 1e6, 1e12])
def test_velocities_that_leave_no_time_are_named(plain, factor):
    (finding,) = cs.diagnose(plain.robot, plain.q, factor * plain.v, plain.tau)
    assert (finding.code, finding.severity) == ("not_judged", "major")
    assert "other units" in finding.message


def test_velocities_that_are_not_those_of_the_positions_are_named(plain):
    v = np.random.default_rng(0).standard_normal(plain.v.shape)
    found = cs.diagnose(plain.robot, plain.q, v, plain.tau, time=plain.time)
    assert ("not_judged", "major") in _codes(found)
    assert any("velocities do not belong" in finding.message for finding in found)


def test_torques_that_have_nothing_to_do_with_the_model_are_named(plain):
    noise = np.random.default_rng(0).normal(0.0, 1000.0, plain.tau.shape)
    for tau in (noise, 1e9 * plain.tau, 1e50 * plain.tau):
        found = cs.diagnose(plain.robot, plain.q, plain.v, tau, time=plain.time)
        assert any(finding.severity == "major" for finding in found)
        assert {finding.code for finding in found} <= {"not_judged", "scale"}
    assert "nothing to do with the model" in found[-1].message


@pytest.mark.parametrize("value", [0.0, 3.0])
def test_missing_torques_are_named(plain, value):
    (finding,) = cs.diagnose(plain.robot, plain.q, plain.v, np.full_like(plain.tau, value), time=plain.time)
    assert (finding.code, finding.severity) == ("not_judged", "major")
    assert "missing" in finding.message


@pytest.mark.parametrize("timed", [True, False])
def test_no_finite_numbers_break_it(plain, timed):
    rows = slice(0, 200)
    sizes = (0.0, 1e-300, 1e-9, 1e6, 1e57)
    for at in range(3):
        for size in sizes:
            given = [plain.q[rows], plain.v[rows], plain.tau[rows]]
            given[at] = given[at] * size
            found = cs.diagnose(plain.robot, *given, time=plain.time[rows] if timed else None)
            assert found
    for step in (1e-300, 1e-12, 1e9, 1e300):
        cs.diagnose(plain.robot, plain.q[rows], plain.v[rows], plain.tau[rows], time=step * np.arange(200))


def test_rows_in_random_order_say_so_and_still_show_the_sign(plain):
    order = np.random.default_rng(1).permutation(len(plain.time))
    found = cs.diagnose(plain.robot, plain.q[order], plain.v[order], plain.tau[order])
    assert [f.code for f in found] == ["not_judged"]
    found = cs.diagnose(plain.robot, plain.q[order], plain.v[order], -plain.tau[order])
    assert [f.code for f in found] == ["sign", "not_judged"]


def test_a_robot_that_stands_still_says_so(plain):
    q = np.tile(plain.q[:1], (100, 1))
    found = cs.diagnose(plain.robot, q, 0 * q, np.tile(plain.tau[:1], (100, 1)))
    assert [f.code for f in found] == ["not_judged"]
    assert "does not move" in found[0].message


def test_a_floating_base_says_what_is_not_judged():
    robot = cs.Robot.named("atlas")
    rng = np.random.default_rng(2)
    q = np.array([robot.neutral()] * 60)
    q[:, 7:] += 0.1 * rng.standard_normal(q[:, 7:].shape)
    for width in (robot.nv, robot.nv - 6):
        found = cs.diagnose(robot, q, np.zeros((60, robot.nv)), np.zeros((60, width)))
        assert [f.code for f in found] == ["not_judged"]
        assert "floating base" in found[0].message


@pytest.mark.parametrize("convention", ["load", "support"])
def test_the_offset_of_a_sensor(plain, convention):
    sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_7", convention=convention)
    model, data = plain.robot.model, plain.robot.model.createData()
    read = []
    for row in zip(plain.q, plain.v, plain.a, strict=True):
        pin.rnea(model, data, *row)
        read.append(data.f[7].vector * (-1 if convention == "load" else 1))
    noise = np.array([0.2, 0.2, 0.2, 0.01, 0.01, 0.01])
    wrenches = np.array(read)[:, None] + noise * plain.rng.standard_normal((len(read), 1, 6))
    offset = np.array([3.0, -2.0, 5.0, 0.1, 0.2, 0.0])
    wrenches[5] = np.nan
    given = {"sensors": [sensor], "time": plain.time}
    assert cs.diagnose(plain.robot, plain.q, plain.v, plain.tau, wrenches=wrenches, **given) == ()
    wrenches[100:150, :, :3] += 40.0  # somebody pulls
    (finding,) = cs.diagnose(plain.robot, plain.q, plain.v, plain.tau, wrenches=wrenches + offset, **given)
    assert (finding.code, finding.sensor, finding.severity) == ("sensor_offset", "wrist", "major")
    np.testing.assert_allclose(finding.vector, offset[:3], atol=0.15)


def test_a_finding_is_plain_data(plain):
    (finding,) = cs.diagnose(plain.robot, plain.q, plain.v, -plain.tau)
    still = cs.diagnose(plain.robot, *np.zeros((3, 60, 7)))[-1]
    assert np.isnan(still.value)
    assert pickle.loads(pickle.dumps(still)) == still
    for other in (copy.deepcopy(finding), pickle.loads(pickle.dumps(finding))):
        assert other == finding
        assert other.to_dict()["message"] == finding.message
    assert finding.to_dict()["code"] == "sign"
    assert repr(finding).startswith("Finding('sign', major: ")
    assert not finding.vector.flags.writeable


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"q": np.zeros((100, 6))}, "q"),
        ({"v": np.zeros((99, 7))}, "v"),
        ({"tau": np.zeros((100, 8))}, "tau"),
        ({"tau": np.full((100, 7), np.nan)}, "tau"),
        ({"time": np.zeros(100)}, "time"),
        ({"time": np.arange(99.0)}, "time"),
        ({"q": "no"}, "q"),
        ({"q": np.zeros((9, 7)), "v": np.zeros((9, 7)), "tau": np.zeros((9, 7))}, "rows"),
        ({"sensors": [cs.ForceTorqueSensor("S", "iiwa_link_7")]}, "wrenches"),
        ({"wrenches": np.zeros((100, 1, 6))}, "wrenches"),
        ({"sensors": [1]}, "sensors"),
    ],
)
def test_wrong_arguments_are_named(plain, changed, named):
    given = {"q": np.zeros((100, 7)), "v": np.zeros((100, 7)), "tau": np.zeros((100, 7))} | changed
    with pytest.raises(cs.InputError, match=named):
        cs.diagnose(plain.robot, **given)


def test_the_example_runs():
    for test in doctest.DocTestFinder(recurse=False).find(cs.diagnose, "diagnose"):
        assert doctest.DocTestRunner().run(test).failed == 0
