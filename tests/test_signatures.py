"""Names, order and defaults of all arguments, as the API promises them: at run time and in the stub."""

import ast
import inspect
from pathlib import Path

import numpy as np
import pytest

import contactsense as cs

STUB = Path(cs.__file__).with_name("_core.pyi")

# Written by hand from the promised API. A `*` precedes what is given by name only.
SIGNATURES = {
    "Surface.closest_points": "points",
    "Surface.cast_rays": "origins, directions",
    "Surface.sample": "n, seed=0",
    "MomentumObserver": "robot, *, dt, gain=50.0, calibration=None",
    "MomentumObserver.update": "q, v, tau, *, dt=None, friction=None",
    "MomentumObserver.reset": "",
    "ForceTorqueSensor": "name, link, *, pose=None, convention='load', offset=None",
    "LoadCompensator": "robot, sensors, *, calibration=None",
    "LoadCompensator.tare": "q, wrenches",
    "identify_tool": "robot, sensor, q, wrenches",
    "ToolLoad.to_dict": "",
    "LoadCompensator.update": "q, v, a, wrenches",
    "NoiseModel": "*, torque=0.05, velocity=0.0, relative=0.03, model=0.1, model_time=1.0, "
    "friction=0.0, bias=0.0, position_step=0.0",
    "calibrate": "robot, log, *, false_alarms_per_hour=1.0, payload_link=None",
    "read_log": "path, robot, *, columns=None, topics=None, units=None, torque_constants=None, "
    "external=False, rate=None, sensors=()",
    "replay": "log, monitor, *, classifier=None, on_progress=None",
    "replay_fleet": "logs, robot, folder, *, name=None, reading=None, monitor=None, "
    "classifier=None, ticks=False, "
    "engine='local', workers=None, address=None, on_progress=None",
    "view": "source, *, host='127.0.0.1', port=8080, token=None",
    "View.show": "q, report, particles=None",
    "View.close": "",
    "Replay.to_parquet": "folder",
    "Replay.to_json_lines": "path",
    "Replay.to_mcap": "path",
    "Replay.to_png": "path, title='Log'",
    "ReplayedContact.to_dict": "",
    "Calibration.of_description": "robot",
    "Calibration.load": "path",
    "Calibration.save": "path, *, source=''",
    "Calibration.check": "robot",
    "Calibration.to_dict": "",
    "JointFriction.to_dict": "",
    "BodyInertia.to_dict": "",
    "Payload.to_dict": "",
    "NoiseModel.to_dict": "",
    "NoiseModel.covariance": "robot, q, *, gain=50.0, dt=0.001",
    "NoiseModel.correlation_time": "robot, q, *, gain=50.0, dt=0.001",
    "exciting_motion": "robot, seconds, *, max_velocity=None, seed=0, dt=0.001, joints=None",
    "next_motion": "robot, estimate, q, *, max_force, max_step, count=64, seed=0, particles=None, "
    "noise=None, calibration=None, duration=0.5, dt=0.001",
    "NextMotion.to_dict": "",
    "ContactMemory": "robot, *, resolution=0.02, prior=0.5, free_error=0.01, contact_error=0.05, "
    "max_voxels=2_000_000",
    "ContactMemory.add_free": "q",
    "ContactMemory.add_contact": "contact",
    "ContactMemory.probability": "points",
    "ContactMemory.is_free": "points, *, below=0.1",
    "ContactMemory.known": "points",
    "ContactMemory.points": "",
    "ContactMemory.boxes": "*, least=0.5, most=1.0",
    "ContactMemory.save": "path",
    "ContactMemory.load": "path, robot",
    "ContactMemory.clear": "",
    "Motion.at": "time",
    "Motion.to_dict": "",
    "diagnose": "robot, q, v, tau, *, sensors=(), wrenches=None, time=None",
    "Finding.to_dict": "",
    "ContactIsolator": "robot, *, sensors=(), torque_threshold=1e-3, wrench_threshold=1e-3, "
    "wanted_contacts=(), "
    "max_contacts=5, pushing=True, noise=None, locate_within=0.05, calibration=None, "
    "samples=1000, pull_probability=0.05",
    "ContactIsolator.isolate": "q, tau_ext, wrenches=None",
    "ContactMonitor": "robot, *, dt, sensors=(), wanted_contacts=(), observer_gain=50.0, "
    "torque_threshold=0.5, "
    "wrench_threshold=2.0, wrench_gain=None, bias_time_constant=None, bias_limit=30.0, "
    "bias_settle_time=None, hysteresis=0.2, hold_time=0.02, max_contacts=5, pushing=True, "
    "calibration=None, locate_within=0.05, samples=1000",
    "ContactMonitor.update": "q, v, tau, wrenches=None, *, dt=None, friction=None",
    "ContactMonitor.update_external": "q, tau_ext, wrenches=None, *, v=None, dt=None",
    "ContactMonitor.set_payload": "link, mass, com",
    "ContactMonitor.clear_payload": "",
    "ContactMonitor.propose_payload": "",
    "PayloadProposal.to_dict": "",
    "ContactMonitor.tare": "",
    "ContactMonitor.reset": "",
    "ContactParticleFilter": "robot, *, particles=10_000, motion='curvature', measurement='normal', "
    "friction=0.5, "
    "links=None, "
    "seed=0, force_range=(1, 100), stiffness_range=(3e2, 3e4), radius_range=(5e-3, 1.0), "
    "schedule='adaptive', threads=1, likelihood='gaussian', torque_noise=0.02, relative_noise=0.03, "
    "torque_threshold=0.2, noise=None, calibration=None, max_contacts=1",
    "ContactParticleFilter.update": "q, tau_ext, *, time=None",
    "ContactParticleFilter.reset": "",
    "StaticObstacleSampler": "robot, *, particles=10_000, models='obstacle', max_contacts=1, window=40, "
    "forgetting_time=None, moves=1, "
    "measurement='normal', friction=0.5, links=None, seed=0, force_range=(1, 100), "
    "stiffness_range=(3e2, 3e4), radius_range=(5e-3, 1.0), threads=1, torque_noise=0.02, "
    "relative_noise=0.03, torque_threshold=0.2, noise=None, calibration=None",
    "StaticObstacleSampler.update": "q, tau_ext, *, time=None",
    "StaticObstacleSampler.reset": "",
    "ContactClassifier": "robot, *, dt, prior=None, intended_prior=0.26",
    "ContactClassifier.update": "q, v, report",
    "ContactClassifier.reset": "",
    "ContactClass.to_dict": "",
    "Reaction": "robot, *, dt, velocity_limit=None, acceleration_limit=None, torque_limit=None, "
    "distance=0.1, duration=1.0",
    "Reaction.stop": "v",
    "Reaction.retract": "v, collision_torque, *, admittance=0.02",
    "Reaction.gravity_compensation": "q, v, *, damping=1.0",
    "Reaction.reset": "",
    "ContactMap": "robot, *, samples=5_000, friction=0.5, noise=None, links=None, pull_probability=0.05, "
    "calibration=None",
    "ContactMap.evaluate": "q, tau_ext",
    "ContactMap.identifiability": "q, *, force=10.0",
    "Identifiability.to_dict": "",
    "MapEstimate.to_dict": "",
    "Candidate.to_dict": "",
    "Contact.to_dict": "",
    "Isolation.to_dict": "",
    "ContactReport.to_dict": "",
    "ContactEstimate.to_dict": "",
    "Mode.to_dict": "",
    "Robot.from_urdf": "path, *, package_dirs=(), floating_base=False, locked_joints=None, "
    "geometry='collision', gravity=(0.0, 0.0, -9.81), armature=None, missing_meshes='error'",
    "Robot.from_pinocchio": "model, geometry_model",
    "Robot.named": "name",
    "Robot.with_payload": "link, mass, com, inertia=None",
    "Robot.configuration": "positions, *, base=None",
    "Robot.velocity": "velocities, *, base=None",
    "Robot.torque": "torques",
    "Robot.integrate": "q, v",
    "Robot.random_configuration": "seed",
    "Robot.neutral": "",
    "Robot.mass_matrix": "q",
    "Robot.inverse_dynamics": "q, v, a",
    "Robot.forward_dynamics": "q, v, tau, tau_ext=None",
    "Robot.link_pose": "q, link",
    "Robot.jacobian": "q, link, point=None",
    "Robot.surface": "link",
}


# Written in Python, so the stub does not have them.
IN_PYTHON = {
    "Robot.from_urdf",
    "Robot.from_pinocchio",
    "Robot.named",
    "Robot.with_payload",
    "Calibration.of_description",
    "Calibration.load",
    "Calibration.save",
    "calibrate",
    "read_log",
    "replay",
    "replay_fleet",
    "view",
    "View.show",
    "View.close",
    "Replay.to_parquet",
    "Replay.to_json_lines",
    "Replay.to_mcap",
    "Replay.to_png",
    "ReplayedContact.to_dict",
    # A static method, which the stub is not searched for.
    "ContactMemory.load",
}


def arguments(text):
    """Kind, name and default of every argument of a signature's text."""
    return of_node(ast.parse(f"def f({text}): ...").body[0].args)


def of_node(args):
    value = lambda node: ... if node is None else ast.literal_eval(node)  # noqa: E731
    plain = [*args.posonlyargs, *args.args]
    defaults = [None] * (len(plain) - len(args.defaults)) + list(args.defaults)
    found = [("plain", arg.arg, value(default)) for arg, default in zip(plain, defaults, strict=True)]
    by_name = zip(args.kwonlyargs, args.kw_defaults, strict=True)
    found += [("by name", arg.arg, value(default)) for arg, default in by_name]
    return [argument for argument in found if argument[1] not in ("self", "cls")]


def at_run_time(name):
    obj = cs
    for part in name.split("."):
        obj = getattr(obj, part)
    kinds = {inspect.Parameter.KEYWORD_ONLY: "by name"}
    return [
        (kinds.get(p.kind, "plain"), p.name, ... if p.default is p.empty else p.default)
        for p in inspect.signature(obj).parameters.values()
        if p.name != "self"
    ]


def in_stub():
    found = {}
    for node in ast.parse(STUB.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            found[node.name] = of_node(node.args)
        if not isinstance(node, ast.ClassDef):
            continue
        for member in node.body:
            is_plain = isinstance(member, ast.FunctionDef) and not member.decorator_list
            if is_plain and member.name == "__new__":
                found[node.name] = of_node(member.args)
            elif is_plain and not member.name.startswith("_"):
                found[f"{node.name}.{member.name}"] = of_node(member.args)
    return found


@pytest.mark.parametrize("name", SIGNATURES)
def test_signatures_are_the_promised_ones(name):
    promised = arguments(SIGNATURES[name])
    assert at_run_time(name) == promised
    if name not in IN_PYTHON:
        assert in_stub()[name] == promised


def test_every_public_method_is_in_the_table():
    bases = {"Robot", "Calibration"}
    public = {name for name in in_stub() if name not in bases and name.split(".")[0] in cs.__all__}
    # Constructors of columns are for pickles.
    public -= {"ClosestPoints", "RayHits", "SurfaceSamples", "Particles"}
    assert public | IN_PYTHON == set(SIGNATURES)


def test_the_defaults_are_those_in_use():
    """What a signature says is given explicitly; the objects then say the same of themselves."""
    robot = cs.Robot.named("iiwa14")

    def made(name, **required):
        given = {k: v for _, k, v in arguments(SIGNATURES[name]) if v is not ... and v is not None}
        return [getattr(cs, name)(robot, **required, **more) for more in ({}, given)]

    plain, given = made("ContactParticleFilter")
    assert plain.options == given.options
    assert plain.options["particles"] == 10_000
    plain, given = made("StaticObstacleSampler")
    assert plain.options == given.options
    for name, required, readable in (
        ("MomentumObserver", {"dt": 1e-3}, ["gain"]),
        (
            "ContactMonitor",
            {"dt": 1e-3},
            ["observer_gain", "torque_threshold", "wrench_threshold", "sensors"],
        ),
        ("ContactIsolator", {}, ["torque_threshold", "wrench_threshold", "sensors"]),
    ):
        plain, given = made(name, **required)
        for attribute in readable:
            assert np.array_equal(getattr(plain, attribute), getattr(given, attribute)), (name, attribute)
    assert plain.torque_threshold[0] == 1e-3
    assert cs.NoiseModel() == cs.NoiseModel(
        torque=0.05, velocity=0.0, relative=0.03, model=0.1, model_time=1.0, friction=0.0, bias=0.0
    )
