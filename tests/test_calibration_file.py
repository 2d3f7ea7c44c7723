"""A calibration is kept in a file that people can read and edit, and that says what is wrong with it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from robots import parameters, robot_named

import contactsense as cs

IIWA = cs.Robot.named("iiwa14")
SCALE = "    torque_scale: -1.0"  # of joint 2


def full(**changes: object) -> cs.Calibration:
    """Another number at every place, some of them as awkward as they come."""
    content = json.loads(cs.Calibration.of_description(IIWA)._content())
    random = np.random.default_rng(3)
    nv = len(content["joints"])
    for key in ("torque_bias", "torque_bias_std", "torque_scale", "coulomb_std", "viscous_std", "armature"):
        content[key] = (10.0 ** random.uniform(-9, 3, nv)).tolist()
    content["torque_scale"][1] = -1.0
    for key in ("hysteresis", "hysteresis_std", "hysteresis_width", "viscous_std"):
        content[key] = random.uniform(0, 1, nv).tolist()
    content["armature_std"], content["residual"] = [1.23e-300] * nv, [1.23456789012345e15] * nv
    content["friction"]["coulomb"] = random.uniform(0, 1, nv).tolist()
    content["friction"]["viscous"] = [0.0] * nv
    content["friction"]["reversal"] = [{"displacement": 0.01}] + [{"velocity": 1e-5}] * (nv - 1)
    content["payload"] = {
        "link": "iiwa_link_7",
        "mass": 1.2,
        "mass_std": 0.1,
        "com": [0.0, -1e-7, 0.1],
        "com_std": [1.0, 0.1, 0.2],
        "moment": 1e-3,
    }
    content["sensor_offsets"] = [["wrist: left", [1.0, 2.0, -3.0, 0.1, 0.2, 1e-20]]]
    content["tails"] = [{"gain": 8.0, "level": 12.5, "scale": 2.25}]
    content["model_errors"] = [
        {
            "bodies": random.normal(size=(nv, 4)).tolist(),
            "bias": random.normal(size=nv).tolist(),
            "viscous": [0.0] * nv,
        }
        for _ in range(2)
    ]
    content["contacts"] = [[1.0, 2.5], [1700000000.125, 1700000001.0]]
    content["notes"] = ["joint 7: its mass\ncannot be told # apart", "Größe \U0001f600 'and' \"so\""]
    content["noise"]["torque"] = random.uniform(0, 1, nv).tolist()
    content |= {"inertial_change": 0.3, "velocity_delay": 0.004, "torque_delay": 0.001}
    return cs.Calibration(json.dumps(content | changes))


def close(one: object, other: object) -> bool:
    """Whether plain values are equal, numbers to 1e-9 of them."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(close(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(close, one, other))
    if isinstance(one, float) and isinstance(other, float):
        return abs(one - other) <= 1e-9 * abs(one)
    return one == other


@pytest.fixture
def edited(tmp_path):
    """Reads the file after lines of it were changed."""
    path = tmp_path / "arm.yaml"
    full().save(path)

    def edit(*changes: tuple[str, str]) -> cs.Calibration:
        text = path.read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text, text
            text = text.replace(old, new, 1)
        path.write_text(text, encoding="utf-8")
        return cs.Calibration.load(path)

    return edit


def test_what_is_saved_is_loaded(tmp_path: Path) -> None:
    before = full()
    before.save(tmp_path / "arm.yaml", source="log: a # b")
    after = cs.Calibration.load(tmp_path / "arm.yaml")
    assert close(before.to_dict(), after.to_dict())
    after.save(tmp_path / "again.yaml", source="log: a # b")
    assert cs.Calibration.load(str(tmp_path / "again.yaml")) == after
    assert (tmp_path / "again.yaml").read_bytes() == (tmp_path / "arm.yaml").read_bytes()
    after.check(IIWA)
    plain = yaml.safe_load((tmp_path / "arm.yaml").read_text(encoding="utf-8"))
    assert plain["source"] == "log: a # b"
    assert plain["joints"]["iiwa_joint_2"]["torque_scale"] == -1.0


@pytest.mark.parametrize("name", parameters(["iiwa14", "panda", "kinova", "xarm7", "ur5"]))
def test_descriptions_are_saved_and_loaded(tmp_path: Path, name: str) -> None:
    robot = robot_named(name)
    before = cs.Calibration.of_description(robot)
    before.save(tmp_path / "arm.yaml")
    after = cs.Calibration.load(tmp_path / "arm.yaml")
    assert close(before.to_dict(), after.to_dict())
    after.check(robot)


def test_every_number_has_a_unit(tmp_path: Path) -> None:
    full().save(tmp_path / "arm.yaml")
    lines = (tmp_path / "arm.yaml").read_text(encoding="utf-8").splitlines()
    inside = ""
    for line in lines:
        if "#" in line and line.split("#")[0].rstrip().endswith(":"):
            inside = line
        number = line.split(":")[-1].split("#")[0].strip(" []-")[:1].isdigit()
        if number and not line.startswith(("format", "date", "contactsense")):
            assert "# " in line or "# " in inside, line


def test_a_file_edited_by_hand(edited) -> None:
    """Numbers without a point, one number a joint in place of one for all, joints in another order."""
    joint = "iiwa_joint_2:\n    torque_bias: "
    shares = ", ".join(f"iiwa_joint_{k}: 0.0{k}" for k in range(7, 0, -1))
    calibration = edited(
        (joint, joint + "1e-2  # "),
        ("velocity_delay: 0.004", "velocity_delay: 0"),
        ("relative: 0.03", f"relative: {{{shares}}}"),
    )
    assert calibration.torque_bias[1] == 0.01
    assert calibration.velocity_delay == 0.0
    np.testing.assert_allclose(calibration.noise.relative, 0.01 * np.arange(1, 8))
    calibration.check(IIWA)


def test_the_order_of_joints_and_links_in_the_file_does_not_matter(tmp_path: Path) -> None:
    full().save(tmp_path / "arm.yaml")
    before = cs.Calibration.load(tmp_path / "arm.yaml")
    plain = yaml.safe_load((tmp_path / "arm.yaml").read_text(encoding="utf-8"))
    for key in ("joints", "links"):
        plain[key] = dict(reversed(plain[key].items()))
    (tmp_path / "arm.yaml").write_text(yaml.safe_dump(plain), encoding="utf-8")
    assert cs.Calibration.load(tmp_path / "arm.yaml") == before


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("format: 4", "format: 3", "format: .*reads format 4, not 3; calibrate anew"),
        ("format: 4\n", "", "format .* is missing"),
        ("format: 4\n", "format: true\n", "not true"),
        ("torque_is_external: false", "torque_is_external: maybe", "torque_is_external: .*true or false"),
        ("velocity_delay: 0.004", "velocity_delay: -0.1", "velocity_delay: must be .*not negative.*-0.1"),
        ("velocity_delay: 0.004", "velocity_delay: .nan", "velocity_delay: must be a finite"),
        ("velocity_delay: 0.004", "speed_delay: 0.004", r"velocity_delay .* is missing"),
        ("notes:", "remarks: 1\nnotes:", "no entry 'remarks'; there are format, "),
        (SCALE, "    torque_scale: 0", "joints: iiwa_joint_2: torque_scale: .*other than zero"),
        (SCALE, "    torque_scale: yes", "iiwa_joint_2: torque_scale: .*not yes"),
        (SCALE, "    torque_scale: '1 Nm'", "iiwa_joint_2: torque_scale: .*not '1 Nm'"),
        (SCALE, "    torque_scale:", "iiwa_joint_2: torque_scale: .*not nothing"),
        (SCALE, f"    torque_scale: 1{'0' * 400}", "iiwa_joint_2: torque_scale: .*not 1000"),
        (SCALE, "    stiction: 1.0", "iiwa_joint_2: torque_scale .* is missing"),
        (SCALE, SCALE + "\n    stiction: 1.0", "iiwa_joint_2: .*no entry 'stiction'"),
        (SCALE, "    torque_scale: 1\n    torque_scale: 2", "'torque_scale' stands twice"),
        ("  iiwa_joint_3:\n", "  iiwa_joint_9:\n", r"joints: iiwa_joint_3 .* is missing"),
        ("  iiwa_joint_3:\n", "  3:\n", "joints: the name 3 must be a text"),
        ("    - iiwa_joint_3\n", "", "joints: there is no entry 'iiwa_joint_3'"),
        ("    - iiwa_joint_3\n", "    - iiwa_joint_2\n", "stands there twice"),
        ("    - iiwa_joint_3\n", "    - 3\n", r"joints\[2\]: must be a text"),
        ("{displacement: ", "{way: ", "iiwa_joint_1: reversal: .*velocity.*displacement"),
        ("{displacement: ", "{velocity: 0.1, displacement: ", "iiwa_joint_1: reversal"),
        ("{displacement: 0.01}", "0.01", "iiwa_joint_1: reversal: must be a mapping"),
        ("{displacement: 0.01}", "{displacement: 0}", "iiwa_joint_1: reversal: displacement: .*positive"),
        ("relative: 0.03", "relative: {iiwa_joint_1: 0.1}", "noise: relative: iiwa_joint_2 .* is missing"),
        ("relative: 0.03", "relative: [0.1]", "noise: relative: must be a finite number"),
        ("joint: iiwa_joint_4", "joint: iiwa_joint_5", "links: iiwa_link_5: joint must be another one"),
        ("joint: iiwa_joint_4", "joint: elbow", "links: iiwa_link_4: joint must be .*not 'elbow'"),
        ("    mass: ", "    mass: -", "links: iiwa_link_1: mass: "),
        ("    com: [", "    com: [1, ", "links: iiwa_link_1: com: must be a list of 3 numbers"),
        ("    inertia: [", "    inertia: [-", "links: iiwa_link_1: inertia: its principal moments"),
        ("  link: iiwa_link_7", "  link: 7", "payload: link: must be a text"),
        ("  mass_std: 0.1", "  mass_std: none", "payload: mass_std: "),
        ("payload:", "payload: 3\nload:", "payload: must be a mapping"),
        ("  - [1.0, 2.5]", "  - [1.0]", r"contacts\[0\]: must be a list of 2"),
        ('"wrist: left": [', '"wrist: left": [0, ', "sensor_offsets: wrist: left: .*6 numbers"),
        ("joints:", "joints: [", "is no YAML"),
        ("format:", "- format:", "is no YAML|must be a mapping"),
        ("format:", "x: !!python/object/apply:os.getcwd []\nformat:", "tags .* are not read"),
        ("format:", f"x: {'[' * 5000}{']' * 5000}\nformat:", "cannot be read|is no YAML"),
        ("format:", f"x: {'[' * 30}{']' * 30}\nformat:", "more than 20 lists in lists"),
        ("format:", "'': &a [*a]\nformat:", "alias stands inside what it is for"),
        ("format:", "? [1]\n: 1\nformat:", "line 3: a name must be a text"),
        ("notes:", "---\nnotes:", "second document"),
        ("format:", "x: 2020-19-39\nformat:", "no entry 'x'"),
    ],
)  # fmt: skip
def test_errors_name_the_file_and_the_entry(edited, old: str, new: str, said: str) -> None:
    with pytest.raises(cs.InputError, match=rf"(?s)arm\.yaml: .*{said}"):
        edited((old, new))


def test_a_link_that_is_missing_is_named_by_its_joint(tmp_path: Path) -> None:
    path = tmp_path / "arm.yaml"
    full().save(path)
    plain = yaml.safe_load(path.read_text(encoding="utf-8"))
    del plain["links"]["iiwa_link_4"]
    path.write_text(yaml.safe_dump(plain), encoding="utf-8")
    with pytest.raises(
        cs.InputError, match=r"arm\.yaml: links: the link that joint 'iiwa_joint_4' moves is missing"
    ):
        cs.Calibration.load(path)


@given(number=st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_have_ten_digits(number: float) -> None:
    text = full(torque_bias=[number] * 7)._to_yaml("", "")
    (shown,) = {line.split()[1] for line in text.splitlines() if line.startswith("    torque_bias: ")}
    # As Python writes them, but always with a point.
    mantissa, e, exponent = f"{number:.10g}".partition("e")
    assert shown == mantissa + ("" if "." in mantissa else ".0") + e + exponent
    assert yaml.safe_load(shown) == float(f"{number:.10g}")


@given(text=st.text(st.characters(exclude_categories=("Cs",))))
def test_any_text_is_read_as_it_was_written(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.mktemp("texts") / "arm.yaml"
    full(robot=text, notes=[text]).save(path, source=text)
    assert json.loads(cs.Calibration.load(path)._content())["notes"] == [text]
    assert cs.Calibration.load(path).robot_name == text
    assert yaml.safe_load(path.read_text(encoding="utf-8"))["source"] == text


@given(cuts=st.lists(st.tuples(st.integers(0, 6000), st.integers(0, 40), st.binary(max_size=20)), min_size=1))
def test_damaged_files_are_refused_or_read(
    tmp_path_factory: pytest.TempPathFactory, cuts: list[tuple[int, int, bytes]]
) -> None:
    path = tmp_path_factory.mktemp("damaged") / "arm.yaml"
    content = full()._to_yaml("", "").encode()
    for start, length, put in cuts:
        content = content[:start] + put + content[start + length :]
    path.write_bytes(content)
    try:
        cs.Calibration.load(path).check(IIWA)
    except cs.InputError as error:
        assert "arm.yaml" in str(error) or "calibration" in str(error)  # noqa: PT017


ATLAS = cs.Robot.named("atlas")


def walking(**changes: object) -> cs.Calibration:
    """Of a robot whose base is free to move, with numbers of its own at every velocity variable."""
    content = json.loads(cs.Calibration.of_description(ATLAS)._content())
    random = np.random.default_rng(4)
    for key in ("torque_bias", "torque_bias_std", "torque_scale", "residual", "hysteresis_width"):
        content[key] = random.uniform(0.1, 2.0, ATLAS.nv).tolist()
    content["friction"]["coulomb"] = random.uniform(0.0, 1.0, ATLAS.nv).tolist()
    content["friction"]["reversal"] = [{"displacement": 0.02}] * 6 + [{"velocity": 0.01}] * (ATLAS.nv - 6)
    content["armature"] = random.uniform(0.0, 1.0, len(ATLAS.joint_names)).tolist()
    content["noise"]["torque"] = random.uniform(0.0, 1.0, ATLAS.nv).tolist()
    return cs.Calibration(json.dumps(content | changes))


@pytest.mark.parametrize("calibration", [cs.Calibration.of_description(ATLAS), walking()])
def test_a_base_that_floats_has_six_numbers(tmp_path: Path, calibration: cs.Calibration) -> None:
    calibration.save(tmp_path / "atlas.yaml", source="by hand")
    again = cs.Calibration.load(tmp_path / "atlas.yaml")
    assert close(calibration.to_dict(), again.to_dict())
    again.check(ATLAS)
    again.save(tmp_path / "again.yaml", source="by hand")
    assert (tmp_path / "again.yaml").read_bytes() == (tmp_path / "atlas.yaml").read_bytes()
    joints = yaml.safe_load((tmp_path / "atlas.yaml").read_text(encoding="utf-8"))["joints"]
    base, *others = joints.values()
    assert len(base["torque_bias"]) == 6
    assert isinstance(base["armature"], float)
    assert all(isinstance(joint["torque_bias"], float) for joint in others)
    monitor = cs.ContactMonitor(ATLAS, dt=0.01, calibration=again)
    monitor.update(ATLAS.neutral(), np.zeros(ATLAS.nv), np.zeros(ATLAS.nv - 6))


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        (r"torque_bias: \[.*?, ", "torque_bias: [", "root_joint: torque_bias: must be a list of 6 numbers"),
        (r"coulomb: \[.*?\]", "coulomb: 0.0", "root_joint: coulomb: must be a list of 6 numbers"),
        (r"armature: \S+", "armature: [1, 1, 1, 1, 1, 1]", "root_joint: armature: must be a finite number"),
        (r"root_joint: \[.*?\]", "root_joint: 0.1", "noise: torque: root_joint: must be a list of 6"),
    ],
)
def test_a_wrong_entry_of_a_base_is_named(tmp_path: Path, before: str, after: str, message: str) -> None:
    path = tmp_path / "atlas.yaml"
    walking().save(path)
    text, count = re.subn(before, after, path.read_text(encoding="utf-8"), count=1)
    assert count == 1
    path.write_text(text, encoding="utf-8")
    with pytest.raises(cs.InputError, match=message):
        cs.Calibration.load(path)


def test_numbers_that_a_file_cannot_hold(tmp_path: Path) -> None:
    reversals = [{"velocity": 0.01 * (k + 1)} for k in range(ATLAS.nv)]
    friction = {"coulomb": [0.0] * ATLAS.nv, "viscous": [0.0] * ATLAS.nv, "reversal": reversals}
    for calibration, message in [
        (full(torque_bias=[0.0] * 5), "torque_bias: a file keeps one a joint, which are 7, not 5"),
        (walking(residual=[0.0] * 31), "residual: must be 36, one a velocity variable, not 31"),
        (walking(friction=friction), r"friction\.reversal: a file keeps one for all"),
    ]:
        with pytest.raises(cs.InputError, match=message):
            calibration.save(tmp_path / "arm.yaml")
        assert not (tmp_path / "arm.yaml").exists()


@pytest.mark.parametrize("text", [b"", b"null", b"3", b"\xff\xfe\x00", b"[]", b"\x00", b"a: &a [*a]"])
def test_what_is_no_calibration(tmp_path: Path, text: bytes) -> None:
    (tmp_path / "arm.yaml").write_bytes(text)
    with pytest.raises(cs.InputError, match=r"arm\.yaml"):
        cs.Calibration.load(tmp_path / "arm.yaml")


def test_aliases_that_multiply_cost_no_time(tmp_path: Path) -> None:
    lines = ["a0: &a0 [x]", *(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, 30))]
    (tmp_path / "arm.yaml").write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(cs.InputError, match="format"):
        cs.Calibration.load(tmp_path / "arm.yaml")


def test_files_that_cannot_be_opened(tmp_path: Path) -> None:
    with pytest.raises(cs.InputError, match=r"path: cannot read .*nowhere\.yaml"):
        cs.Calibration.load(tmp_path / "nowhere.yaml")
    with pytest.raises(cs.InputError, match="path: cannot write"):
        full().save(tmp_path)
    for path in (3, None, b"arm.yaml"):
        with pytest.raises(cs.InputError, match="path: expected a path"):
            cs.Calibration.load(path)  # type: ignore[arg-type]
        with pytest.raises(cs.InputError, match="path: expected a path"):
            full().save(path)  # type: ignore[arg-type]
    with pytest.raises(cs.InputError, match="path: cannot read"):
        cs.Calibration.load("arm\0.yaml")
    with pytest.raises(cs.InputError, match="source"):
        full().save(tmp_path / "arm.yaml", source=3)  # type: ignore[arg-type]


def test_another_robot_is_refused(tmp_path: Path) -> None:
    full().save(tmp_path / "arm.yaml")
    calibration = cs.Calibration.load(tmp_path / "arm.yaml")
    with pytest.raises(cs.InputError, match="calibration: is of 'iiwa14'"):
        calibration.check(robot_named("panda"))
    with pytest.raises(cs.InputError, match="calibration: is of another description"):
        calibration.check(IIWA.with_payload("iiwa_link_7", 1.0, [0.0, 0.0, 0.1]))
    with pytest.raises(cs.InputError, match="robot"):
        calibration.check("iiwa14")  # type: ignore[arg-type]
