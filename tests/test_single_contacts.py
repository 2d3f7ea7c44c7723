"""The study of single contacts: located where determined, and the link named where not."""

from __future__ import annotations

import pytest
from robots import parameters, robot_named

from contactsense_studies.single_contacts import ENTERS_TWICE, UNCERTAIN, LinkResult, run

ARMS = ("iiwa14", "panda", "ur5", "iiwa14_mesh", "xarm7")
HUMANOIDS = ("atlas", "atlas_v5", "atlas_hull", "talos", "g1")


def outcomes(results: list[LinkResult]) -> set[str]:
    return set().union(*(result.outcomes for result in results))


@pytest.mark.parametrize("name", parameters(HUMANOIDS))
def test_every_reachable_contact_of_a_floating_base_is_located(name: str) -> None:
    results = run(robot_named(name), points=30, seed=11)
    silent = {"link only, own joint silent"}
    assert outcomes(results) <= {"located", ENTERS_TWICE, UNCERTAIN, "out of reach"} | silent
    exact = sum(result.outcomes["located"] + result.outcomes[ENTERS_TWICE] for result in results)
    assert exact > 20 * len(results)
    assert sum(result.outcomes[kind] for result in results for kind in silent) <= 0.01 * exact


@pytest.mark.parametrize("name", parameters(ARMS))
def test_arms_locate_what_six_joints_determine_and_name_the_rest(name: str) -> None:
    robot = robot_named(name)
    results = run(robot, points=60, seed=12)
    # Where the own joint feels the force, the link is right.
    silent = {"link only, own joint silent", "other link, own joint silent"}
    assert (
        outcomes(results)
        <= {"located", ENTERS_TWICE, UNCERTAIN, "link only, rank < 6", "not felt", "out of reach"} | silent
    )
    exact = [result for result in results if result.outcomes["located"] + result.outcomes[ENTERS_TWICE]]
    located = [result.link for result in exact]
    before = {link: int(robot.jacobian(robot.neutral(), link).any(axis=0).sum()) for link in robot.link_names}
    assert set(located) == {
        result.link
        for result in results
        if before[result.link] >= 6 and result.outcomes.total() > result.outcomes["out of reach"]
    }
