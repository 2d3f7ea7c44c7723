"""Scenes, explorations and recorded runs: what is kept, what is true, what is written and read back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

from mujoco_contact import MujocoContact, hull_parts
from robots import meshes, packaged, panda

from contactsense.errors import InputError
from contactsense.sim import (
    ContactPath,
    ContactQuery,
    ContactRun,
    HandImpedanceController,
    Pace,
    TorqueError,
    TorqueNoise,
    joint_exploration,
    null_space_exploration,
    perturbed_model,
    record_quasi_static,
    record_run,
    sliding_exploration,
    touch_scene,
)

FEW = Pace(motions=4, duration=0.4)


@pytest.mark.parametrize("kind", ["sphere", "cube", "cylinder"])
@pytest.mark.parametrize("which", [packaged, pytest.param(meshes, marks=pytest.mark.shared), panda])
def test_scenes_touch_one_link_and_are_felt(which, kind: str) -> None:
    robot = which()
    model = robot.model
    # Of Franka's arm, link 7 hides between its neighbours.
    links = [link for link in robot.link_names[1:] if link[-1] in "123456"]
    for link in links:
        for seed in range(3):
            scene = touch_scene(robot, link, kind=kind, seed=seed)
            query = ContactQuery(robot, scene.obstacle, links=robot.link_names)
            (found,) = query.touching(scene.q)
            assert found.link == link
            gaps = [-query.at(scene.q, other).penetration for other in robot.link_names if other != link]
            assert min(gaps) > 0.004
            assert 4.99 < np.linalg.norm(scene.force) < 40.01
            assert scene.force @ scene.normal < 0
            frame = model.getFrameId(link, pin.FrameType.BODY)
            placed = robot.link_pose(scene.q, link)
            data = model.createData()
            jacobian = pin.computeFrameJacobian(model, data, scene.q, frame, pin.LOCAL_WORLD_ALIGNED)
            moment = np.cross(scene.point - placed[:3, 3], scene.force)
            expected = jacobian.T @ np.concatenate([scene.force, moment])
            np.testing.assert_allclose(scene.external_torque, expected, atol=1e-9)
            assert np.linalg.norm(expected) >= 0.5
            low = np.maximum(model.lowerPositionLimit, -np.pi)
            high = np.minimum(model.upperPositionLimit, np.pi)
            assert ((scene.q > low) & (scene.q < high)).all()


def test_scenes_follow_seed_and_arguments() -> None:
    robot = packaged()
    one, same, other = (touch_scene(robot, "iiwa_link_3", seed=seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(one.q, same.q)
    assert one.obstacle.to_dict() == same.obstacle.to_dict() != other.obstacle.to_dict()
    ranges = {"radius_range": (0.05, 0.05), "force_range": (20.0, 20.0), "stiffness_range": (1e4, 2e4)}
    scene = touch_scene(robot, "iiwa_link_3", q=one.q, seed=1, **ranges)
    np.testing.assert_array_equal(scene.q, one.q)
    assert scene.obstacle.radius == pytest.approx(0.05)
    assert 1e4 <= scene.stiffness <= 2e4
    assert np.linalg.norm(scene.force) == pytest.approx(20.0)
    for options, name in [
        ({"link": "iiwa_link_0"}, "link"),
        ({"kind": "cone"}, "kind"),
        ({"q": [0.0] * 6}, "q"),
        ({"force_range": (2.0, 1.0)}, "force_range"),
        ({"radius_range": (0.0, 1.0)}, "radius_range"),
        ({"least_torque": 1e3}, "least_torque"),
    ]:
        arguments = {"link": "iiwa_link_3"} | options
        with pytest.raises(InputError, match=name):
            touch_scene(robot, **arguments)


def _depths(robot, scene, path: ContactPath) -> np.ndarray:
    query = ContactQuery(robot, scene.obstacle)
    found = [query.touching(q) for q in path.q]
    assert all(len(contacts) == 1 and contacts[0].link == scene.link for contacts in found)
    return np.array([contacts[0].penetration for contacts in found])


@pytest.mark.parametrize("kind", ["sphere", "cube", "cylinder"])
def test_explorations_keep_the_contact_within_the_band(kind: str) -> None:
    robot = packaged()
    for link in ("iiwa_link_2", "iiwa_link_4", "iiwa_link_6"):
        scene = touch_scene(robot, link, kind=kind, seed=1)
        depth = np.linalg.norm(scene.force) / scene.stiffness
        for explore in (joint_exploration, sliding_exploration):
            path = explore(robot, scene, pace=Pace(motions=6, duration=0.2))
            assert len(path) == 61
            np.testing.assert_array_equal(path.q[0], scene.q)
            np.testing.assert_allclose(np.diff(path.time), 0.02)
            depths = _depths(robot, scene, path)
            assert depths.min() > 0.49 * depth
            assert depths.max() < 1.51 * depth
            assert np.ptp(depths) > 0.2 * depth
            assert np.abs(path.q - scene.q).max() < 0.4


def test_sliding_moves_the_contact_along_the_surface() -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_4", seed=1)
    ways = []
    for explore in (joint_exploration, sliding_exploration):
        path = explore(robot, scene, pace=Pace(motions=10, duration=0.2))
        query = ContactQuery(robot, scene.obstacle)
        poses = [robot.link_pose(q, scene.link) for q in path.q]
        points = [query.at(q, scene.link).point for q in path.q]
        local = [(p - pose[:3, 3]) @ pose[:3, :3] for p, pose in zip(points, poses, strict=True)]
        ways.append(float(np.ptp(local, axis=0).max()))
    assert ways[1] > 0.02
    assert ways[1] > 1.5 * ways[0]


def test_null_space_motions_hold_the_hand() -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_4", seed=1)
    for hold, rows in (("position", 3), ("pose", 4)):
        path = null_space_exploration(robot, scene, "iiwa_link_7", hold=hold, pace=FEW)
        _depths(robot, scene, path)
        hands = np.array([robot.link_pose(q, "iiwa_link_7") for q in path.q])
        assert np.abs(hands - hands[0])[:, :3, 3].max() < 1e-5
        assert rows == 3 or np.abs(hands - hands[0]).max() < 1e-5
        assert np.abs(path.q - path.q[0]).max() > 1e-3
    for options, name in [({"hand": "iiwa_link_0"}, "hand"), ({"hold": "line"}, "hold")]:
        with pytest.raises(InputError, match=name):
            null_space_exploration(robot, scene, **({"hand": "iiwa_link_7"} | options))


def test_explorations_name_what_is_wrong() -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_4", seed=1)
    for make, name in [
        (lambda: joint_exploration(robot, scene, amplitude=0.0), "amplitude"),
        (lambda: joint_exploration(robot, scene, force_band=(0.0, 1.0)), "force_band"),
        (lambda: sliding_exploration(robot, scene, travel=-1.0), "travel"),
        (lambda: Pace(motions=0), "motions"),
        (lambda: Pace(rate=1.0, duration=0.1), "rate"),
    ]:
        with pytest.raises(InputError, match=name):
            make()


def test_paths_pass_their_knots_smoothly() -> None:
    robot = packaged()
    path = joint_exploration(robot, touch_scene(robot, "iiwa_link_4", seed=1), pace=FEW)
    for k in (0, 7, len(path) - 1):
        np.testing.assert_allclose(path.at(path.time[k]).q, path.q[k], atol=1e-12)
    for when in (0.111, 0.5, 1.2345):
        numeric = (path.at(when + 1e-6).q - path.at(when - 1e-6).q) / 2e-6
        np.testing.assert_allclose(path.at(when).v, numeric, atol=1e-6)
    np.testing.assert_array_equal(path.at(99.0).q, path.q[-1])
    assert not path.at(99.0).v.any()
    assert not path.at(-1.0).v.any()


@pytest.mark.parametrize("which", [packaged, pytest.param(meshes, marks=pytest.mark.shared)])
def test_quasi_static_runs_are_consistent(which) -> None:
    robot = which()
    model = robot.model
    scene = touch_scene(robot, "iiwa_link_4", seed=1)
    path = joint_exploration(robot, scene, pace=FEW)
    run = record_quasi_static(robot, scene.contact(robot), path.time, path.q)
    assert len(run) == len(path) == len(run.link)
    assert set(run.link) == {"iiwa_link_4"}
    gravity = np.array([pin.computeGeneralizedGravity(model, model.createData(), q) for q in run.q])
    torques = [
        robot.jacobian(q, "iiwa_link_4", p)[:3].T @ f
        for q, p, f in zip(run.q, run.point, run.force, strict=True)
    ]
    np.testing.assert_allclose(run.true_external_torque, torques, atol=1e-12)
    np.testing.assert_allclose(run.external_torque, torques, atol=1e-9)
    np.testing.assert_allclose(run.tau, gravity - torques, atol=1e-9)
    # Frictionless: the force is along the inward normal.
    np.testing.assert_allclose(np.cross(run.force, run.normal), 0.0, atol=1e-9)
    assert ((run.force * run.normal).sum(axis=1) < 0).all()
    rough = record_quasi_static(robot, scene.contact(robot, friction=0.2), path.time, path.q)
    along = -(rough.force * rough.normal).sum(axis=1)
    across = np.linalg.norm(rough.force + along[:, None] * rough.normal, axis=1)
    assert across[0] < 1e-12
    assert (across <= 0.2 * along + 1e-9).all()
    assert across.max() > 0.19 * along.max()
    # Away from the obstacle nothing touches.
    far = record_quasi_static(robot, scene.contact(robot), [0.0, 1.0], [scene.q, scene.q + 1.0])
    assert far.link == ("iiwa_link_4", "")
    assert not far.force[1].any()
    assert not far.true_external_torque[1].any()
    assert np.isnan(far.point[1]).all()
    for arguments in (([1.0, 0.0], path.q[:2]), ([0.0], path.q[:2]), ([0.0, 1.0], path.q[:2] * np.nan)):
        with pytest.raises(InputError, match=r"time|q must"):
            record_quasi_static(robot, scene.contact(robot), *arguments)


def test_errors_of_measurement_are_as_large_as_asked() -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_4", seed=1)
    times, poses = np.arange(2000.0), np.tile(scene.q, (2000, 1))
    contact = scene.contact(robot)
    noisy = record_quasi_static(robot, contact, times, poses, error=TorqueError(10.0, 0.05, seed=3))
    off = noisy.external_torque - noisy.true_external_torque
    expected = np.hypot(0.1 * scene.external_torque, 0.05)
    np.testing.assert_allclose(off.std(axis=0), expected, rtol=0.08)
    np.testing.assert_allclose(off.mean(axis=0), 0.0, atol=0.1 * expected.max())
    same = record_quasi_static(robot, contact, times, poses, error=TorqueError(10.0, 0.05, seed=3))
    np.testing.assert_array_equal(same.external_torque, noisy.external_torque)
    # Motor torque carries the same error, with the other sign.
    still = record_quasi_static(robot, contact, times[:1], poses[:1])
    np.testing.assert_allclose(noisy.tau + off, np.tile(still.tau, (2000, 1)), atol=1e-9)
    biased = record_quasi_static(robot, contact, times, poses, error=TorqueError(bias=0.3, seed=4))
    off = biased.external_torque - biased.true_external_torque
    np.testing.assert_allclose(off, np.tile(off[0], (2000, 1)), atol=1e-9)
    assert 0.1 < np.abs(off[0]).mean() < 0.6


def test_another_model_shows_as_false_torque() -> None:
    robot = packaged()
    model = robot.model
    true = perturbed_model(model, mass=0.05, centre=0.005, inertia=0.05, seed=1)
    shares = [b.mass / a.mass for a, b in zip(model.inertias[1:], true.inertias[1:], strict=True)]
    assert 0.01 < np.std(shares) < 0.1
    assert model.inertias[1].mass != true.inertias[1].mass
    scene = touch_scene(robot, "iiwa_link_4", seed=1)
    run = record_quasi_static(robot, scene.contact(robot), [0.0], [scene.q], true_model=true)
    difference = pin.computeGeneralizedGravity(model, model.createData(), scene.q) - (
        pin.computeGeneralizedGravity(true, true.createData(), scene.q)
    )
    assert np.abs(difference).max() > 0.2
    np.testing.assert_allclose(run.external_torque - run.true_external_torque, [difference], atol=1e-9)
    again = perturbed_model(model, mass=0.05, centre=0.005, inertia=0.05, seed=1)
    assert again.inertias[3].mass == true.inertias[3].mass
    np.testing.assert_array_equal(perturbed_model(model).inertias[3].inertia, model.inertias[3].inertia)


@pytest.mark.parametrize("kind", ["sphere", "cube", "cylinder"])
def test_physics_follows_the_plan(kind: str) -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_4", kind=kind, seed=1)
    path = joint_exploration(robot, scene, pace=FEW)
    contact = scene.contact(robot, dissipation=1.0)
    run = record_run(robot, contact, path)
    np.testing.assert_allclose(run.time, path.time, atol=1e-12)
    assert set(run.link) == {"iiwa_link_4"}
    assert np.abs(run.q - path.q).max() < 0.01
    slow = record_quasi_static(robot, contact, run.time, run.q)
    np.testing.assert_allclose(run.point, slow.point, atol=1e-9)
    torques = [
        robot.jacobian(q, "iiwa_link_4", p)[:3].T @ f
        for q, p, f in zip(run.q, run.point, run.force, strict=True)
    ]
    np.testing.assert_allclose(run.true_external_torque, torques, atol=1e-9)
    # The observer follows within its time constant of 20 ms.
    late = np.abs(run.external_torque - run.true_external_torque).max()
    size = np.abs(run.true_external_torque).max()
    assert 0.0 < late < 0.25 * size
    quick = record_run(robot, contact, path, observer_gain=500.0)
    assert np.abs(quick.external_torque - quick.true_external_torque).max() < 0.3 * late
    if kind == "sphere":
        again = record_run(robot, contact, path, rate=50.0)
        np.testing.assert_array_equal(run.external_torque, again.external_torque)


def test_physics_with_everything_wrong() -> None:
    robot = packaged()
    model = robot.model
    scene = touch_scene(robot, "iiwa_link_5", seed=2)
    path = null_space_exploration(robot, scene, "iiwa_link_7", pace=Pace(motions=2, duration=1.0))
    true = perturbed_model(model, mass=0.05, seed=1)
    options = {
        "controller": HandImpedanceController(model, "iiwa_link_7"),
        "true_model": true,
        "error": TorqueError(5.0, 0.02, seed=1),
        "sensor_noise": TorqueNoise(newton_metres=0.1, seed=2),
    }
    contact = scene.contact(robot, friction=0.2, dissipation=1.0)
    for way in ("observer", "static"):
        run = record_run(robot, contact, path, external_torque=way, settings={"trial": 3}, **options)
        assert set(run.link) <= {"iiwa_link_5", ""}
        off = np.abs(run.external_torque - run.true_external_torque)
        assert 0.1 < off.max() < 0.5 * np.abs(run.true_external_torque).max()
        assert run.settings["external_torque"] == way
        assert run.settings["trial"] == 3
        assert run.settings["friction"] == 0.2
        assert run.settings["error"]["percent"] == 5.0
    for wrong, name in [({"rate": 3e3}, "rate"), ({"external_torque": "guess"}, "external_torque")]:
        with pytest.raises(InputError, match=name):
            record_run(robot, contact, path, **wrong)


def test_mujoco_contact_gives_the_same_run_on_convex_links() -> None:
    robot = panda()
    scene = touch_scene(robot, "panda_link4", kind="cube", seed=1)
    path = joint_exploration(robot, scene, pace=FEW)
    ours = record_run(robot, scene.contact(robot), path)
    contact = MujocoContact(scene.obstacle, hull_parts(robot, ["panda_link4"]), stiffness=scene.stiffness)
    theirs = record_run(robot, contact, path)
    assert ours.link == theirs.link
    np.testing.assert_allclose(ours.q, theirs.q, atol=2e-4)
    force = np.linalg.norm(ours.force, axis=1).max()
    assert np.linalg.norm(ours.force - theirs.force, axis=1).max() < 0.05 * force
    assert np.linalg.norm(ours.point - theirs.point, axis=1).max() < 2e-3


def test_an_unstable_arm_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warnings into a file
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_4", seed=1)

    class Wild:
        def torque(self, q, v, desired, desired_v=None, feedforward=None):
            return 1e9 * v + 1e6

    with pytest.raises(InputError, match="unstable"):
        record_run(robot, scene.contact(robot), joint_exploration(robot, scene, pace=FEW), controller=Wild())


def test_runs_are_written_and_read_back(tmp_path: Path) -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_4", seed=1)
    poses = [scene.q, scene.q + 1.0]
    run = record_quasi_static(robot, scene.contact(robot), [0.0, 1.0], poses, settings={"seed": 1})
    run.save(tmp_path / "run.npz")
    again = ContactRun.load(tmp_path / "run.npz")
    for name in (
        "time",
        "q",
        "v",
        "tau",
        "external_torque",
        "true_external_torque",
        "point",
        "normal",
        "force",
    ):
        np.testing.assert_array_equal(getattr(again, name), getattr(run, name))
    assert again.link == run.link == ("iiwa_link_4", "")
    assert again.settings == run.settings
    assert again.settings["obstacle"] == scene.obstacle.to_dict()
    assert again.settings["seed"] == 1


def test_malformed_files_are_refused(tmp_path: Path) -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_4", seed=1)
    good = tmp_path / "good.npz"
    run = record_quasi_static(robot, scene.contact(robot), [0.0], [scene.q])
    run.save(good)
    arrays = dict(np.load(good))
    changes = {
        "no time": {"time": None},
        "short": {"force": arrays["force"][:0]},
        "flat": {"point": arrays["point"][0]},
        "text": {"q": np.array([["a"] * 7])},
        "infinite": {"tau": arrays["tau"] + np.inf},
        "wide": {"tau": np.zeros((1, 8))},
        "settings": {"settings": np.array("{")},
        "list": {"settings": np.array("[]")},
        "links": {"link": np.array(["a", "b"])},
        "format": {"format": np.array("other 2")},
        "pickle": {"link": np.array([{}], dtype=object)},
    }
    for name, change in changes.items():
        path = tmp_path / f"{name}.npz"
        np.savez(path, **{key: value for key, value in (arrays | change).items() if value is not None})
        with pytest.raises(InputError, match=f"path: .*{name}"):
            ContactRun.load(path)
    (tmp_path / "bytes.npz").write_bytes(b"no archive")
    (tmp_path / "cut.npz").write_bytes(good.read_bytes()[:200])
    np.save(tmp_path / "array.npy", np.zeros(3))
    for name in ("bytes.npz", "cut.npz", "array.npy", "absent.npz"):
        with pytest.raises(InputError, match=f"path: .*{name}"):
            ContactRun.load(tmp_path / name)
    with pytest.raises(InputError, match="settings"):
        ContactRun(**(vars(run) | {"settings": {"bad": object()}})).save(tmp_path / "bad.npz")
    with pytest.raises(InputError, match="link"):
        ContactRun(**(vars(run) | {"link": ()}))
