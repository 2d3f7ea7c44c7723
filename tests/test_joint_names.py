"""Which joint a log means, and what a column holds."""

import pytest

from contactsense.log.joint_names import match
from contactsense.log.quantities import meaning

PANDA = [f"panda_joint{number}" for number in range(1, 8)]
UR = [f"{name}_joint" for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")]


@pytest.mark.parametrize(
    ("joints", "names"),
    [
        (PANDA, PANDA),
        (PANDA, [f"left/{name}" for name in PANDA]),
        (PANDA, [f"fer_joint{number}" for number in range(1, 8)]),
        (PANDA, [f"J{number}" for number in range(1, 8)]),
        (PANDA, [f"Joint {number}" for number in range(1, 8)]),
        (UR, ["Shoulder pan", "Shoulder Lift", "Elbow", "Wrist 1", "Wrist 2", "Wrist 3"]),
        ([f"left_{name}" for name in UR], UR),
        (["lbr_A1", "lbr_A2"], ["a1", "a2"]),
    ],
)
def test_names_are_matched_in_any_order(joints: list[str], names: list[str]) -> None:
    expected = dict(zip(joints, names, strict=True))
    assert match(joints, names[::-1]) == expected
    assert match(joints, ["base_joint", *names[2:], "gripper_knuckle", *names[:2]]) == expected


def test_what_fits_twice_is_not_taken() -> None:
    assert match(["joint_1", "joint_2"], ["arm_1", "gripper_1", "arm_2"]) == {"joint_2": "arm_2"}
    assert match(PANDA, ["lift", "head"]) == {}


@pytest.mark.parametrize(
    ("column", "quantity", "joint"),
    [
        ("q0", "position", "0"),
        ("dq[3]", "velocity", "3"),
        ("tau_J0", "torque", "0"),
        ("tau_ext6", "external_torque", "6"),
        ("- arm_1_joint_position", "position", "arm 1"),
        ("actual_qd_1", "velocity", "1"),
        ("actual_current_0", "current", "0"),
        ("position[panda_joint1]", "position", "panda_joint1"),
        ("measured_joint_state.velocity[j1]", "velocity", "j1"),
        ("tau_ext_hat_filtered.effort[j1]", "external_torque", "j1"),
        ("tau_ext_hat_filtered[2]", "external_torque", "2"),
        ("panda_joint1_pos", "position", "panda joint 1"),
        ("Joint 3 position (deg)", "position", "joint 3"),
    ],
)
def test_columns_tell_what_they_hold(column: str, quantity: str, joint: str) -> None:
    told = meaning(column)
    assert told is not None
    assert (told.quantity, told.joint) == (quantity, joint)


@pytest.mark.parametrize(
    "column",
    [
        *("time", "label", "target_q_0", "q_d[0]", "tau_J_d0", "dtau_J[1]", "theta[0]", "actual_TCP_pose_0"),
        *("O_F_ext[1]", "desired_joint_state.position[j1]", "joint_temperatures_0", "base_position_x"),
    ],
)
def test_others_tell_nothing(column: str) -> None:
    assert meaning(column) is None
