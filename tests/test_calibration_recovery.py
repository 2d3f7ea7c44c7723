"""The known errors of simulated arms are found by calibration, and the stated uncertainty covers them."""

from __future__ import annotations

import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

import contactsense as cs
from contactsense import sim
from contactsense_studies.recovery import Recovery, linear, loaded, recover, table

IIWA = cs.Robot.named("iiwa14")
ARMS = 6


@pytest.fixture(scope="module")
def recovered() -> list[Recovery]:
    planned = cs.exciting_motion(IIWA, 30.0, dt=5e-3)
    motion = sim.JointMotion(planned.time, planned.q, planned.v, planned.a)
    arms = [
        loaded(IIWA, linear(sim.ImperfectArm.typical(IIWA, seed)), seed) for seed in range(100, 100 + ARMS)
    ]
    return [recover(IIWA, arm, motion, seed) for seed, arm in enumerate(arms)]


def test_errors_are_found(recovered: list[Recovery]) -> None:
    found = table(recovered)
    assert found["bias_90"] < 0.02
    assert found["coulomb"] < 0.05
    assert found["noise_90"] < 0.10
    assert found["com"] < 5e-3
    # The masses of the links, 2 % off, are part of what a payload seems to weigh.
    assert found["mass"] < 0.03


def test_their_uncertainty_is_stated(recovered: list[Recovery]) -> None:
    found = table(recovered)
    for name in ("bias", "coulomb", "mass", "com"):
        assert found[f"{name}_covered"] >= 0.8


def test_an_arm_without_payload_is_refused() -> None:
    motion = sim.random_moves(IIWA, 2.0)
    with pytest.raises(cs.InputError, match="arm: must have a payload"):
        recover(IIWA, sim.ImperfectArm.ideal(), motion, 0)
