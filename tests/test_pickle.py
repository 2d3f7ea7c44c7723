"""What is frozen can be pickled and copied, with every bit; results say themselves as plain dicts."""

import copy
import json
import math
import pickle

import numpy as np
import pytest

import contactsense as cs

Q = np.array([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0])
ROUND_TRIPS = {
    **{
        f"pickle {n}": lambda x, n=n: pickle.loads(pickle.dumps(x, n))
        for n in range(pickle.HIGHEST_PROTOCOL + 1)
    },
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


def attributes(obj, within=()):
    """All public attributes, as bytes where they are numbers; results and tuples by what they hold.

    An estimate is the first of its own `contacts`: what is met again within itself is given by its depth.
    """
    if any(obj is outer for outer in within):
        return len(within)
    if isinstance(obj, np.ndarray):
        return obj.dtype.str, obj.shape, obj.tobytes()
    if isinstance(obj, float):
        return np.float64(obj).tobytes()
    if isinstance(obj, tuple):
        return [attributes(item, within) for item in obj]
    if isinstance(obj, dict):
        return {key: attributes(value, within) for key, value in obj.items()}
    if not type(obj).__module__.startswith("contactsense"):
        return obj
    names = [name for name in dir(obj) if not name.startswith("_") and not callable(getattr(obj, name))]
    return {name: attributes(getattr(obj, name), (*within, obj)) for name in names}


def push(robot, link):
    """The torque of 20 N on the surface of a link."""
    place, pose = robot.surface(link).sample(1, seed=2), robot.link_pose(Q, link)
    point = pose[:3, :3] @ place.points[0] + pose[:3, 3]
    return robot.jacobian(Q, link, point)[:3].T @ pose[:3, :3] @ (-20.0 * place.normals[0])


@pytest.fixture(scope="module")
def objects():
    robot = cs.Robot.named("iiwa14")
    link = robot.link_names[-1]
    surface = robot.surface(link)
    torque = push(robot, link)
    pose = np.eye(4)
    pose[:3, :3] = [[math.cos(0.3), -math.sin(0.3), 0], [math.sin(0.3), math.cos(0.3), 0], [0, 0, 1]]
    sensor = cs.ForceTorqueSensor(
        "wrist", link, pose=pose, convention="support", offset=[1, 0, -2, 0, 0.5, 0]
    )
    isolation = cs.ContactIsolator(robot).isolate(Q, torque)
    sensors = [cs.ForceTorqueSensor("elbow", robot.link_names[3])]
    monitor = cs.ContactMonitor(robot, dt=1e-3, sensors=sensors)
    zeros = np.zeros(7)
    for _ in range(60):
        report = monitor.update(
            Q, zeros, robot.inverse_dynamics(Q, zeros, zeros) - torque, np.full((1, 6), 1e-3)
        )
    particle_filter = cs.ContactParticleFilter(robot, particles=500, seed=3)
    quiet = particle_filter.update(Q, zeros)
    estimate = particle_filter.update(Q, torque)
    tared = cs.LoadCompensator(robot, sensors)
    poses = np.array([robot.random_configuration(seed) for seed in range(5)])
    weights = np.concatenate([-tared.tare(q, np.ones((1, 6))) for q in poses])
    calibration = cs.Calibration.of_description(robot)
    assert isolation.contacts[0].candidates
    assert report.contacts
    return {
        "ForceTorqueSensor": sensor,
        "NoiseModel": cs.NoiseModel(torque=np.linspace(0.01, 0.07, 7), relative=0.1),
        "Calibration": calibration,
        "JointFriction": calibration.friction,
        "BodyInertia": calibration.bodies[3],
        "ClosestPoints": surface.closest_points(np.eye(3)),
        "RayHits": surface.cast_rays([[0.0, 0.0, 1.0]], [[0.0, 0.0, -1.0]]),
        "SurfaceSamples": surface.sample(10),
        "Isolation": isolation,
        "Contact": isolation.contacts[0],
        "Candidate": isolation.contacts[0].candidates[0],
        "ContactReport": report,
        "ContactEstimate": estimate,
        "ContactEstimate without contact": quiet,
        "MapEstimate": cs.ContactMap(robot, samples=500).evaluate(Q, torque),
        "Identifiability": cs.ContactMap(robot, samples=500).identifiability(Q),
        "Mode": estimate.modes[0],
        "Particles": particle_filter.particles,
        "ToolLoad": cs.identify_tool(robot, sensors[0], poses, weights),
        "PayloadProposal": proposal(robot),
        "Motion": cs.exciting_motion(robot, 1.0, dt=0.05),
        "NextMotion": cs.next_motion(robot, estimate, Q, max_force=60.0, max_step=0.02, count=4, dt=0.05),
    }


def proposal(robot):
    loaded = robot.with_payload("iiwa_link_7", 0.7, [0.0, 0.0, 0.1])
    monitor = cs.ContactMonitor(robot, dt=0.01)
    for angle in np.arange(0.0, 10.0, 0.01)[:, None] + np.arange(7):
        q, v, a = np.sin(angle), np.cos(angle), -np.sin(angle)
        monitor.update(q, v, loaded.inverse_dynamics(q, v, a))
    return monitor.propose_payload()


# Settings, whose arrays are copies at every access.
COPIES = (
    cs.ForceTorqueSensor,
    cs.NoiseModel,
    cs.Calibration,
    cs.JointFriction,
    cs.BodyInertia,
    cs.ToolLoad,
    cs.PayloadProposal,
)
NAMES = [
    "ForceTorqueSensor",
    "NoiseModel",
    "Calibration",
    "JointFriction",
    "BodyInertia",
    "ClosestPoints",
    "RayHits",
    "SurfaceSamples",
    "Isolation",
    "Contact",
    "Candidate",
    "ContactReport",
    "ContactEstimate",
    "MapEstimate",
    "Identifiability",
    "Mode",
    "Particles",
    "ToolLoad",
    "PayloadProposal",
    "Motion",
    "NextMotion",
]


@pytest.mark.parametrize("way", ROUND_TRIPS)
@pytest.mark.parametrize("name", [*NAMES, "ContactEstimate without contact"])
def test_a_round_trip_keeps_every_bit(objects, name, way):
    before = objects[name]
    after = ROUND_TRIPS[way](before)
    assert type(after) is type(before)
    assert attributes(after) == attributes(before)
    assert repr(after) == repr(before)


def test_settings_are_equal_after_a_round_trip(objects):
    for name in (
        "ForceTorqueSensor",
        "NoiseModel",
        "Calibration",
        "JointFriction",
        "BodyInertia",
        "ToolLoad",
        "PayloadProposal",
    ):
        assert pickle.loads(pickle.dumps(objects[name])) == objects[name]


def test_a_surface_is_taken_apart_into_its_robot_and_link():
    robot = cs.Robot.named("iiwa14")
    surface = robot.surface(robot.link_names[2])
    assert copy.copy(surface).area == surface.area
    make, (link,) = surface.__reduce__()
    assert (make.__self__, link) == (robot, robot.link_names[2])


def test_another_version_is_refused(objects):
    restore, (kind, _, content) = objects["Mode"].__reduce__()
    with pytest.raises(cs.InputError, match=r"0\.0\.0"):
        restore(kind, "0.0.0", content)
    with pytest.raises(cs.InputError, match="damaged"):
        restore(kind, cs.__version__, content[:-3])


@pytest.mark.parametrize(
    "name",
    [
        "Isolation",
        "Contact",
        "Candidate",
        "ContactReport",
        "ContactEstimate",
        "MapEstimate",
        "Identifiability",
        "Mode",
        "NoiseModel",
        "Calibration",
        "JointFriction",
        "BodyInertia",
        "Motion",
        "NextMotion",
    ],
)
def test_to_dict_holds_all_attributes_as_plain_values(objects, name):
    plain = objects[name].to_dict()
    assert set(plain) == set(attributes(objects[name]))
    assert json.loads(json.dumps(plain)).keys() == plain.keys()
    for key, value in plain.items():
        held = getattr(objects[name], key)
        if isinstance(held, np.ndarray):
            assert np.array_equal(np.array(value).reshape(held.shape), held, equal_nan=True)
            assert isinstance(value, list)


def test_what_is_nested_is_plain_too(objects):
    contact = objects["ContactReport"].to_dict()["contacts"][0]
    assert contact["link"] == objects["ContactReport"].contacts[0].link
    assert isinstance(objects["ContactEstimate"].to_dict()["modes"][0]["point"], list)


def test_results_are_built_once_and_read_only(objects):
    report, estimate, isolation = (
        objects[name] for name in ("ContactReport", "ContactEstimate", "Isolation")
    )
    assert report.contacts is report.contacts
    assert report.contacts[0].candidates is report.contacts[0].candidates
    assert isolation.contacts is isolation.contacts
    assert estimate.modes is estimate.modes
    for obj in [*objects.values(), *report.contacts]:
        for name in dir(obj):
            value = None if name.startswith("_") else getattr(obj, name)
            if isinstance(value, np.ndarray):
                assert not value.flags.writeable, (obj, name)
                assert value.flags.c_contiguous
                assert value.dtype in (np.float64, np.int64, np.bool_)
                if type(obj) not in COPIES:
                    assert getattr(obj, name) is value, (obj, name)


def test_arrays_of_an_unpickled_result_are_read_only(objects):
    assert not pickle.loads(pickle.dumps(objects["Particles"])).point.flags.writeable
