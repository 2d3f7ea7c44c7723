"""The next motion in contact: its bounds, and that it locates contacts sooner than random ones."""

import copy
import dataclasses
import io
import pickle

import numpy as np
import pytest
from rich.console import Console
from robots import SHARED

import contactsense as cs
from contactsense_studies.harness import save_pictures
from contactsense_studies.memory.methods import METHODS
from contactsense_studies.next_motion.data import as_data
from contactsense_studies.next_motion.options import Options
from contactsense_studies.next_motion.plots import PICTURES
from contactsense_studies.next_motion.report import print_study
from contactsense_studies.next_motion.score import errors_after, score
from contactsense_studies.next_motion.study import run
from contactsense_studies.next_motion.touched import Touched
from contactsense_studies.next_motion.trial import WAYS, Outcome

IIWA = cs.Robot.named("iiwa14")
MAX_FORCE, MAX_STEP = 60.0, np.deg2rad(1.0)


def felt(link="iiwa_link_4", seed=3, updates=5):
    """A contact, the filter that has felt it, and its estimate."""
    touched = Touched(IIWA, link, seed)
    tracker = cs.ContactParticleFilter(IIWA, particles=3000, seed=seed)
    for torque in touched.torques(touched.scene.q, updates):
        estimate = tracker.update(touched.scene.q, torque)
    return touched, tracker, estimate


def planned(tracker, estimate, q, **changes):
    arguments = {"max_force": MAX_FORCE, "max_step": MAX_STEP, "particles": tracker.particles, "count": 16}
    return cs.next_motion(IIWA, estimate, q, **(arguments | changes))


@pytest.mark.parametrize("particles", [True, False])
def test_it_is_a_small_motion_from_here_from_rest_to_rest(particles):
    touched, tracker, estimate = felt()
    q = touched.scene.q
    motion = planned(tracker, estimate, q, **({} if particles else {"particles": None}))
    assert motion
    assert isinstance(motion, cs.Motion)
    assert motion.reason == ""
    np.testing.assert_allclose(motion.q[0], q, atol=1e-12)
    assert np.abs(motion.q - q).max() <= MAX_STEP * (1 + 1e-9)
    assert np.abs(motion.q[-1] - q).max() > 0.0
    np.testing.assert_allclose(motion.v[[0, -1]], 0.0, atol=1e-9)
    assert (motion.duration, motion.time[-1], len(motion)) == (0.5, 0.5, 501)
    assert 0 < motion.admissible <= motion.candidates == 16
    assert motion.information > 0.0
    assert motion.spread_after < motion.spread_before
    assert motion.force_range.shape == (2,)
    assert motion.force_range[0] <= motion.force_range[1]


def test_no_force_exceeds_the_bound_and_none_is_lost():
    for seed in range(6):
        touched, tracker, estimate = felt(f"iiwa_link_{3 + seed % 4}", seed)
        q = touched.scene.q
        for number in range(3):
            motion = planned(tracker, estimate, q, seed=number)
            for pose in motion.q[50::50]:
                # The obstacle may reach another link: what is around the robot is not known.
                forces = {contact.link: np.linalg.norm(contact.force) for contact in touched.forces(pose)}
                assert touched.scene.link in forces
                assert max(forces.values()) <= MAX_FORCE
                estimate = tracker.update(pose, touched.torques(pose, 1)[0])
                q = pose


def test_joints_stay_within_their_limits():
    touched, tracker, estimate = felt()
    upper = IIWA.position_limits[:, 1]
    q = np.minimum(touched.scene.q, upper)
    q[6] = upper[6]
    for seed in range(5):
        motion = planned(tracker, estimate, q, seed=seed)
        if motion:
            assert (motion.q <= upper + 1e-12).all()


def test_without_contact_the_robot_stays():
    tracker = cs.ContactParticleFilter(IIWA, particles=500)
    q = np.full(7, 0.4)
    motion = planned(tracker, tracker.update(q, np.zeros(7)), q)
    assert not motion
    assert motion.reason == "no contact"
    assert motion.q.shape == (0, 7)
    assert motion.duration == 0.0
    assert (motion.candidates, motion.admissible, motion.information) == (0, 0, 0.0)
    np.testing.assert_array_equal(motion.at(1.0)[0], q)


def test_where_nothing_is_admissible_it_says_so():
    touched, tracker, estimate = felt()
    q = touched.scene.q
    # A bound below the force that is there already allows no motion that presses.
    motions = [planned(tracker, estimate, q, max_force=1e-3, count=1, seed=seed) for seed in range(8)]
    for motion in motions:
        assert bool(motion) == (motion.admissible > 0)
        assert (motion.reason == "no admissible motion") == (not motion)
        if motion:
            # It does not press harder than now.
            before = np.linalg.norm(touched.scene.force)
            forces = [np.linalg.norm(found.force) for found in touched.forces(motion.q[-1])]
            assert max(forces) <= 1.05 * before


def test_the_same_seed_gives_the_same_motion():
    touched, tracker, estimate = felt()
    one, same, other = (planned(tracker, estimate, touched.scene.q, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.q, same.q)
    assert np.abs(one.q - other.q).max() > 0.0


def test_larger_noise_tells_less():
    touched, tracker, estimate = felt()
    told = [
        planned(tracker, estimate, touched.scene.q, noise=cs.NoiseModel(torque=noise)).information
        for noise in (0.01, 3.0)
    ]
    assert told[1] < 0.7 * told[0]


def test_it_can_be_pickled_and_copied():
    touched, tracker, estimate = felt()
    motion = planned(tracker, estimate, touched.scene.q)
    for again in (pickle.loads(pickle.dumps(motion)), copy.deepcopy(motion)):
        assert again.to_dict() == motion.to_dict()
        assert repr(again) == repr(motion)
        np.testing.assert_array_equal(again.at(0.2)[0], motion.at(0.2)[0])


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"max_force": 0.0}, "max_force"),
        ({"max_force": np.nan}, "max_force"),
        ({"max_step": -0.1}, "max_step"),
        ({"max_step": [0.1, 0.1]}, "max_step"),
        ({"count": 0}, "count"),
        ({"count": 20_000}, "count"),
        ({"seed": -1}, "seed"),
        ({"duration": 0.0}, "duration"),
        ({"duration": 1e-4}, "^duration: must be at least dt, which is 0.001 s"),
        ({"dt": 1e-9}, "dt"),
        ({"particles": "some"}, "particles"),
        ({"noise": 0.1}, "noise"),
    ],
)
def test_wrong_arguments_are_named(arguments, named):
    touched, tracker, estimate = felt(updates=1)
    with pytest.raises(cs.InputError, match=named):
        planned(tracker, estimate, touched.scene.q, **arguments)


def test_particles_that_pull_are_left_out():
    # A spring that holds a link may pull at it.
    sampler = cs.StaticObstacleSampler(IIWA, particles=500, models="both", seed=1)
    force = np.array([5.0, -15.0, -10.0])
    for number in range(8):
        pose = 0.4 + 0.01 * number * np.array([1, -1, 1, -1, 1, -1, 1])
        point = IIWA.link_pose(pose, "iiwa_link_6")[:3, 3] + [0.0, 0.05, 0.05]
        torque = IIWA.jacobian(pose, "iiwa_link_6", point)[:3].T @ (force - [0.0, number, 0.0])
        estimate = sampler.update(pose, torque)
    particles = sampler.particles
    assert (particles.force < 0.0).any()
    motion = cs.next_motion(IIWA, estimate, pose, max_force=100.0, max_step=0.02, particles=particles)
    assert motion or motion.reason


def test_wrong_objects_are_named():
    touched, tracker, estimate = felt(updates=1)
    with pytest.raises(cs.InputError, match="q"):
        planned(tracker, estimate, touched.scene.q[:3])
    with pytest.raises(cs.InputError, match="estimate"):
        planned(tracker, "here", touched.scene.q)
    atlas = cs.Robot.named("atlas")
    with pytest.raises(cs.InputError, match="base"):
        cs.next_motion(atlas, estimate, atlas.neutral(), max_force=10.0, max_step=0.01)


@pytest.mark.shared
def test_chosen_motions_locate_a_contact_sooner_than_random_ones():
    # Few joints feel link 3. The random motions are drawn with knowledge of the true contact, and keep it.
    folder = SHARED / "robots" / "iiwa14"
    options = Options(
        robot=str(folder / "iiwa14.urdf"),
        package_dirs=(str(folder),),
        links=("iiwa_link_3",),
        methods=("filter",),
        trials=50,
    )
    study = run(options)
    chosen, random = (score(study.outcomes("iiwa_link_3", "filter", way)) for way in WAYS)
    assert chosen.trials == random.trials == 50
    assert chosen.motions <= 0.5 * random.motions
    assert chosen.greatest_force <= MAX_FORCE


@pytest.fixture(scope="module")
def study():
    return run(Options(links=("iiwa_link_4", "iiwa_link_5"), trials=2, particles=2000, motions=6, seed=4))


def test_a_trial_is_the_same_for_the_same_seed(study):
    link, number = "iiwa_link_5", 1
    (trial,) = (each for each in study.trials if (each.link, each.number) == (link, number))
    same = run(dataclasses.replace(study.options, links=(link,)), processes=1)
    (again,) = (each for each in same.trials if each.number == number)
    assert trial == again


def test_fourth_links_are_located_within_a_few_motions(study):
    for link in study.links:
        for method in ("filter", "sampler"):
            for outcome in study.outcomes(link, method, "chosen"):
                assert outcome.motions is not None
                assert outcome.greatest_force <= MAX_FORCE
                assert not outcome.lost


def test_the_study_shows_what_it_found(study, tmp_path):
    shown = io.StringIO()
    print_study(study, Console(file=shown, width=100))
    assert all(method.name in shown.getvalue() for method in METHODS)
    data = as_data(study)
    assert data["complete"]
    assert len(data["scores"]) == 2 * len(METHODS) * len(WAYS) == len(data["trials"]) / 2
    (picture,) = save_pictures(PICTURES, study, tmp_path)
    assert picture.stat().st_size > 10_000


def test_trials_in_which_the_point_is_never_close_are_the_longest():
    errors = ((0.3, 0.005), (0.3, 0.2, 0.1), (np.inf, 0.2, 0.004))
    outcomes = [Outcome(each, 20.0, False) for each in errors]
    of = score(outcomes)
    assert [each.motions for each in outcomes] == [1, None, 2]
    assert (of.motions, of.never) == (2.0, pytest.approx(1 / 3))
    assert score(outcomes[:2]).motions == np.inf
    assert errors_after(outcomes, 3) == [0.3, 0.2, 0.005, 0.005]


@pytest.mark.parametrize(
    "wrong", [{"motions": 0}, {"max_force": 0.0}, {"max_step": -1.0}, {"trials": 0}, {"methods": ("guess",)}]
)
def test_wrong_options_are_named(wrong):
    with pytest.raises(cs.InputError, match=next(iter(wrong))):
        Options(**wrong)
