"""The memory of contacts and free space: judged by distances of coal, a wall, and random worlds."""

import copy
import pickle

import coal
import numpy as np
import pinocchio as pin
import pytest

import contactsense as cs

IIWA = cs.Robot.named("iiwa14")
Q = np.array([0.3, 0.8, -0.4, -0.9, 0.5, 0.7, 0.2])
RNG = np.random.default_rng(3)


def depths(robot, q, points):
    """(n,) distance of world points from the robot by coal, negative inside: a point is a tiny ball."""
    model, geometry = robot.model, robot.geometry_model
    data, placed = model.createData(), geometry.createData()
    pin.updateGeometryPlacements(model, data, geometry, placed, q)
    found = np.full(len(points), np.inf)
    request, ball = coal.DistanceRequest(), coal.Sphere(1e-6)
    request.enable_signed_distance = True
    for shape, pose in zip(geometry.geometryObjects, placed.oMg, strict=True):
        at = coal.Transform3s(pose.rotation, pose.translation)
        for k, point in enumerate(points):
            result = coal.DistanceResult()
            here = coal.Transform3s(np.eye(3), point)
            distance = coal.distance(shape.geometry, at, ball, here, request, result)
            found[k] = min(found[k], distance)
    return found


def test_the_body_is_free_and_nothing_else_is_known():
    memory = cs.ContactMemory(IIWA, resolution=0.03)
    memory.add_free(Q)
    centres, probabilities = memory.points()
    assert len(memory) == len(centres) > 300
    np.testing.assert_allclose(probabilities, 0.01)
    # Voxels in and about the body, by another library.
    grid = np.unique(np.floor(centres / 0.03), axis=0)
    about = np.unique((grid[:, None] + RNG.integers(-2, 3, (1, 6, 3))).reshape(-1, 3), axis=0)
    points = (about[RNG.permutation(len(about))[:1500]] + 0.5) * 0.03
    depth = depths(IIWA, Q, points)
    clear = np.abs(depth) > 1e-4
    np.testing.assert_array_equal(memory.is_free(points)[clear], depth[clear] < 0.0)
    np.testing.assert_array_equal(memory.known(points)[clear], depth[clear] < 0.0)
    assert 0.2 < (depth[clear] < 0.0).mean() < 0.9


def test_several_configurations_are_the_union_and_again_changes_nothing():
    motion = np.linspace(Q, Q + 0.3, 5)
    one, each = cs.ContactMemory(IIWA, resolution=0.05), cs.ContactMemory(IIWA, resolution=0.05)
    one.add_free(motion)
    for q in [*motion, *motion]:
        each.add_free(q)
    for a, b in zip(one.points(), each.points(), strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_wall_touched_often_is_found():
    # The plane x = 0.613; contacts on it with 4 mm of noise, from the robot's side.
    memory = cs.ContactMemory(IIWA, resolution=0.02, prior=0.1)
    rng = np.random.default_rng(0)
    for _ in range(300):
        point = np.array([0.613, *rng.uniform(0.4, 0.5, 2)]) + 0.004 * rng.normal(size=3)
        memory.add_contact((point, [1.0, 0.0, 0.0], 0.004**2 * np.eye(3)))
    y, z = (axis.ravel() for axis in np.meshgrid([0.43, 0.45, 0.47], [0.43, 0.45, 0.47]))
    behind = np.stack([np.full(9, 0.621), y, z], axis=1)
    before = behind - [0.05, 0.0, 0.0]
    assert (memory.probability(behind) > 0.8).all()
    np.testing.assert_allclose(memory.probability(before), 0.1)
    lower, upper = memory.boxes(least=0.5)
    assert (lower[:, 0] >= 0.58 - 1e-9).all()
    assert (upper[:, 0] <= 0.66 + 1e-9).all()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_an_arm_that_comes_up_to_a_ball_and_leans_on_it_knows_where_it_is(seed):
    # From noisy torques alone: the sampler locates the contact, the memory fuses it with the way to it.
    sim = pytest.importorskip("contactsense.sim", reason="the simulation needs contactsense[sim]")
    link, radii = "iiwa_link_6", (0.06, 0.1)
    scene = sim.touch_scene(IIWA, link, least_torque=1.0, radius_range=radii, force_range=(10, 30), seed=seed)
    path = sim.joint_exploration(IIWA, scene, pace=sim.Pace(motions=20, duration=0.2), seed=seed)
    run = sim.record_quasi_static(IIWA, scene.contact(IIWA), path.time, path.q)
    noise = sim.TorqueNoise(percent=3.0, newton_metres=0.02, seed=seed)
    sampler = cs.StaticObstacleSampler(IIWA, particles=2000, seed=seed)
    for q, torque in zip(run.q[::5], run.external_torque[::5], strict=True):
        estimate = sampler.update(q, noise.measure(torque))
    memory = cs.ContactMemory(IIWA, resolution=0.03, prior=0.05)
    jacobian = IIWA.jacobian(scene.q, link, scene.point)[:3]
    back = np.linalg.pinv(jacobian) @ (-0.1 * scene.normal)
    way = np.linspace(scene.q + back, scene.q + 0.1 * back, 8)
    memory.add_free(way)
    memory.add_contact(estimate)
    centre, radius = scene.obstacle.center, scene.obstacle.radius
    point = run.point[::5][-1]
    inside = point + 0.015 * (centre - point) / np.linalg.norm(centre - point)
    assert memory.probability([inside])[0] > 0.4
    centres, probabilities = memory.points()
    occupied = centres[probabilities > 0.3]
    assert len(occupied) > 0
    assert (np.linalg.norm(occupied - centre, axis=1) < radius + 0.03).all()
    # Where the link was before is free, as far as it is not the ball's.
    free = centres[memory.is_free(centres)]
    assert (np.linalg.norm(free - centre, axis=1) > radius - 0.03).mean() > 0.99


def test_the_obstacle_is_on_the_outer_side():
    memory = cs.ContactMemory(IIWA, resolution=0.02)
    memory.add_contact(([0.51, 0.01, 0.5], [0.0, 0.0, -1.0], np.zeros((3, 3))))
    assert memory.probability([[0.51, 0.01, 0.495]])[0] > 0.7
    assert memory.probability([[0.51, 0.01, 0.53]])[0] == 0.5


def test_probabilities_are_calibrated():
    # Random worlds of voxels, occupied with the prior; a contact on a random occupied one, with noise.
    # Judged are those whose measured point is far from the edge of the world.
    edge, prior, deviation = 0.1, 0.3, 0.02
    rng = np.random.default_rng(1)
    said, true = [], []
    centres = (np.stack(np.meshgrid(*[np.arange(-4, 5)] * 3), axis=-1).reshape(-1, 3) + 0.5) * edge
    for _ in range(3000):
        occupied = rng.random(len(centres)) < prior
        touched = centres[rng.choice(np.flatnonzero(occupied))]
        measured = touched + edge * rng.uniform(-0.5, 0.5, 3) + deviation * rng.normal(size=3)
        if (np.abs(measured - 0.5 * edge) > 2.5 * edge).any():
            continue
        memory = cs.ContactMemory(IIWA, resolution=edge, prior=prior, contact_error=1e-3)
        # The point of the robot's surface is half a voxel before the obstacle's.
        memory.add_contact((measured - [0.5 * edge, 0.0, 0.0], [1.0, 0.0, 0.0], deviation**2 * np.eye(3)))
        known = memory.known(centres)
        said += list(memory.probability(centres[known]))
        true += list(occupied[known])
    said, true = np.array(said), np.array(true, dtype=float)
    for low, high in [(0.3, 0.4), (0.4, 0.55), (0.55, 0.75), (0.75, 1.0)]:
        chosen = (said >= low) & (said < high)
        assert chosen.sum() > 100
        assert abs(said[chosen].mean() - true[chosen].mean()) < 0.06, (
            low,
            said[chosen].mean(),
            true[chosen].mean(),
        )


def test_an_estimate_and_a_contact_can_be_added():
    tracker = cs.ContactParticleFilter(IIWA, particles=1000)
    estimate = tracker.update(Q, IIWA.jacobian(Q, "iiwa_link_7")[:3].T @ [0.0, 0.0, -20.0])
    memory = cs.ContactMemory(IIWA, prior=0.1)
    memory.add_contact(estimate)
    assert len(memory) > 0
    assert (memory.points()[1] >= 0.1).all()
    found = cs.ContactIsolator(IIWA).isolate(Q, IIWA.jacobian(Q, "iiwa_link_7")[:3].T @ [0.0, 0.0, -20.0])
    other = cs.ContactMemory(IIWA, prior=0.1)
    (contact,) = found.contacts
    other.add_contact(contact)
    assert other.probability([contact.point + 0.01 * contact.normal])[0] > 0.5
    empty = cs.ContactMemory(IIWA)
    empty.add_contact(tracker.update(Q, np.zeros(7)))
    assert len(empty) == 0


def test_boxes_hold_the_voxels_exactly():
    memory = cs.ContactMemory(IIWA, resolution=0.05)
    memory.add_free(Q)
    centres, _ = memory.points()
    lower, upper = memory.boxes(least=0.0, most=0.1)
    np.testing.assert_allclose((upper - lower).prod(axis=1).sum(), len(centres) * 0.05**3)
    inside = ((centres[:, None] > lower) & (centres[:, None] < upper)).all(axis=2).sum(axis=1)
    np.testing.assert_array_equal(inside, 1)
    assert len(lower) < 0.5 * len(centres)
    assert memory.boxes(least=0.5)[0].shape == (0, 3)


def test_files_pickles_and_copies_keep_all(tmp_path):
    memory = cs.ContactMemory(IIWA, resolution=0.05, prior=0.3, max_voxels=10_000)
    memory.add_free(Q)
    memory.add_contact(([0.9, 0.1, 0.2], [1.0, 0.0, 0.0], 1e-4 * np.eye(3)))
    path = tmp_path / "memory.npz"
    memory.save(path)
    for again in (
        cs.ContactMemory.load(path, IIWA),
        pickle.loads(pickle.dumps(memory)),
        copy.deepcopy(memory),
    ):
        assert type(again) is cs.ContactMemory
        assert repr(again) == repr(memory)
        assert (again.prior, again.max_voxels) == (0.3, 10_000)
        for a, b in zip(memory.points(), again.points(), strict=True):
            np.testing.assert_array_equal(a, b)
    (tmp_path / "other.npz").write_bytes(b"no archive")
    for name in ("other.npz", "missing.npz"):
        with pytest.raises(cs.InputError, match="path"):
            cs.ContactMemory.load(tmp_path / name, IIWA)


@pytest.mark.parametrize("path", [-1, True, 3, None, b"memory.npz"])
def test_what_is_no_path_is_refused(path):
    memory = cs.ContactMemory(IIWA, resolution=0.05)
    with pytest.raises(cs.InputError, match="path: expected a path"):
        memory.save(path)
    with pytest.raises(cs.InputError, match="path: expected a path"):
        cs.ContactMemory.load(path, IIWA)


def test_files_that_cannot_be_written_are_named(tmp_path):
    memory = cs.ContactMemory(IIWA, resolution=0.05)
    for path in (tmp_path, tmp_path / "nowhere" / "memory.npz", "memory\0.npz"):
        with pytest.raises(cs.InputError, match=r"path: .* cannot be written"):
            memory.save(path)


def test_places_that_voxels_do_not_reach_are_refused(tmp_path):
    memory = cs.ContactMemory(IIWA, resolution=0.05)
    spread = 1e-4 * np.eye(3)
    for far in (1.1e8, -1.1e8, 1e9, 1e30):
        with pytest.raises(cs.InputError, match=r"^contact: .*within 1\.074e8 m"):
            memory.add_contact(([far, 0.0, 1.0], [1.0, 0.0, 0.0], spread))
    with pytest.raises(cs.InputError, match=r"^contact: .*standard deviations"):
        memory.add_contact(([0.5, 0.0, 1.0], [1.0, 0.0, 0.0], 1e16 * np.eye(3)))
    assert len(memory) == 0
    memory.add_contact(([1.07e8, 0.0, 1.0], [1.0, 0.0, 0.0], spread))
    np.testing.assert_allclose(memory.points()[0][0], [1.07e8, 0.0, 1.0], atol=0.1)
    memory.save(tmp_path / "far.npz")
    for again in (
        cs.ContactMemory.load(tmp_path / "far.npz", IIWA),
        pickle.loads(pickle.dumps(memory)),
    ):
        np.testing.assert_array_equal(again.points()[0], memory.points()[0])


def test_a_body_that_voxels_do_not_reach_is_refused():
    atlas = cs.Robot.named("atlas")
    memory = cs.ContactMemory(atlas, resolution=0.05)
    q = atlas.neutral()
    q[1] = 1e9
    with pytest.raises(cs.InputError, match=r"^q: links must be within"):
        memory.add_free(q)
    assert len(memory) == 0


@pytest.mark.parametrize(
    ("covariance", "problem"),
    [
        (-1e-4 * np.eye(3), "negative eigenvalue"),
        (np.diag([1e-4, -1.0, 1e-4]), "negative eigenvalue"),
        (np.diag([1e-4] * 3) + np.eye(3, k=1), "symmetric"),
    ],
)
def test_what_is_no_covariance_is_refused(covariance, problem):
    memory = cs.ContactMemory(IIWA, resolution=0.05)
    with pytest.raises(cs.InputError, match=f"^contact: .*covariance must .*{problem}"):
        memory.add_contact(([0.5, 0.0, 1.0], [1.0, 0.0, 0.0], covariance))
    assert len(memory) == 0


def test_too_much_is_refused_and_changes_nothing():
    memory = cs.ContactMemory(IIWA, resolution=0.05, max_voxels=20)
    with pytest.raises(cs.InputError, match="max_voxels"):
        memory.add_free(Q)
    assert len(memory) == 0
    memory.clear()


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"resolution": 0.0}, "resolution"),
        ({"prior": 1.0}, "prior"),
        ({"free_error": 0.0}, "free_error"),
        ({"contact_error": np.nan}, "contact_error"),
        ({"max_voxels": 0}, "max_voxels"),
    ],
)
def test_wrong_options_are_named(options, named):
    with pytest.raises(cs.InputError, match=named):
        cs.ContactMemory(IIWA, **options)


def test_wrong_arguments_are_named():
    memory = cs.ContactMemory(IIWA)
    for call, named in [
        (lambda: memory.add_free(Q[:3]), "q"),
        (lambda: memory.add_free(np.full(7, np.nan)), "q"),
        (lambda: memory.add_contact("here"), "contact"),
        (lambda: memory.add_contact(([0.0, 0.0], [1.0, 0.0, 0.0], np.eye(3))), "point"),
        (lambda: memory.add_contact(([0.0, 0.0, np.nan], [1.0, 0.0, 0.0], np.eye(3))), "contact"),
        (lambda: memory.probability([[0.0, 0.0]]), "points"),
        (lambda: memory.is_free([[0.0, 0.0, 0.0]], below=2.0), "below"),
        (lambda: memory.boxes(least=-1.0), "least"),
    ]:
        with pytest.raises(cs.InputError, match=named):
            call()
    assert len(memory) == 0
