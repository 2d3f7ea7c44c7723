"""The true external torque of MuJoCo's states: against the forces of its contacts and their Jacobians."""

from __future__ import annotations

import doctest

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

import mujoco

import contactsense as cs
from contactsense import sim

# An arm that lies on the ground and on a ball, with a joint beyond its limit and dry friction in another one.
WORLD = """
<mujoco>
  <option cone="{cone}" jacobian="{jacobian}"/>
  <worldbody>
    <geom type="plane" size="2 2 1" condim="{condim}"/>
    <body pos="0.55 0.05 0.08"><freejoint/><geom size="0.1" mass="0.5" condim="{condim}"/></body>
    <body pos="0 0 0.1">
      <joint name="lift" axis="0 1 0" frictionloss="0.5"/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.05" condim="{condim}"/>
      <body pos="0.4 0 0">
        <joint name="elbow" axis="0 1 0" range="-30 30" limited="true"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.04" condim="{condim}"/>
        <body pos="0.3 0 0">
          <joint name="slide" type="slide" axis="1 0 0"/>
          <geom type="box" pos="0.05 0 0" size="0.05 0.06 0.07" condim="{condim}"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def state(
    *, cone: str = "pyramidal", jacobian: str = "dense", condim: int = 3
) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(WORLD.format(cone=cone, jacobian=jacobian, condim=condim))
    data = mujoco.MjData(model)
    data.qpos[7:] = 0.15, 0.6, 0.02
    data.qvel[:] = np.random.default_rng(0).normal(0.0, 0.3, model.nv)
    mujoco.mj_forward(model, data)
    return model, data


def of_contact_forces(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    """By the wrench of each contact and the Jacobians of its point on both bodies."""
    total = np.zeros(model.nv)
    for number in range(data.ncon):
        contact, wrench = data.contact[number], np.zeros(6)
        mujoco.mj_contactForce(model, data, number, wrench)
        frame = np.array(contact.frame).reshape(3, 3)
        for geom, sign in ((contact.geom1, -1.0), (contact.geom2, 1.0)):
            linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
            mujoco.mj_jac(model, data, linear, angular, contact.pos, model.geom_bodyid[geom])
            total += sign * (linear.T @ frame.T @ wrench[:3] + angular.T @ frame.T @ wrench[3:])
    return total


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
@pytest.mark.parametrize("jacobian", ["dense", "sparse"])
@pytest.mark.parametrize("condim", [1, 3, 4, 6])
def test_contacts_are_those_of_their_forces_and_jacobians(cone: str, jacobian: str, condim: int) -> None:
    model, data = state(cone=cone, jacobian=jacobian, condim=condim)
    assert data.ncon >= 3
    expected = of_contact_forces(model, data)
    found = sim.external_torque(model, data)
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())
    # The limit of the elbow and the friction of the lift are left out.
    others = data.qfrc_constraint - found
    assert abs(others[model.joint("lift").dofadr[0]]) == pytest.approx(0.5)
    if condim > 1:
        assert abs(others[model.joint("elbow").dofadr[0]]) > 100.0


def test_applied_forces_count_at_the_centre_of_mass() -> None:
    model, data = state()
    before = sim.external_torque(model, data)
    expected = np.zeros(model.nv)
    rng = np.random.default_rng(1)
    for body in (1, 3):
        data.xfrc_applied[body] = wrench = rng.normal(0.0, 10.0, 6)
        linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_jacBodyCom(model, data, linear, angular, body)
        expected += linear.T @ wrench[:3] + angular.T @ wrench[3:]
    # The contacts of `data` are still those before the forces: they change with the next `mj_forward`.
    np.testing.assert_allclose(sim.external_torque(model, data) - before, expected, atol=1e-9)


def test_it_is_zero_without_contacts_and_forces() -> None:
    model, data = state()
    data.qpos[:3] = 0.0, 1.0, 1.0
    data.qpos[7] = -1.0
    mujoco.mj_forward(model, data)
    assert data.ncon == 0
    assert data.nefc == 2
    assert not sim.external_torque(model, data).any()


def test_data_of_another_model_are_refused() -> None:
    _, data = state()
    other = mujoco.MjModel.from_xml_string("<mujoco><worldbody/></mujoco>")
    with pytest.raises(cs.InputError, match=r"^data: must be of the model with 1 bodies"):
        sim.external_torque(other, data)


def test_its_example_runs() -> None:
    (test,) = doctest.DocTestFinder(recurse=False).find(sim.external_torque, "external_torque")
    assert doctest.DocTestRunner().run(test) == (0, 9)
