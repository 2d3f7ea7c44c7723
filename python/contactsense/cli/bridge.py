"""`contactsense bridge`."""

from __future__ import annotations

import gc
import sys
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from ..bridge.assemble import robot_of
from ..bridge.configuration import Configuration
from ..bridge.endpoints import Endpoints
from ..bridge.node import ContactNode
from ..bridge.read_configuration import read_configuration
from ..bridge.ros2_transport import Ros2Bridge
from ..bridge.zenoh_transport import ZenohBridge
from ..errors import InputError
from .robot_files import package_folders, quietly, summary


class Transport(str, Enum):
    """What carries the messages."""

    zenoh = "zenoh"
    ros2 = "ros2"


def register(parent: typer.Typer) -> None:
    """Adds `bridge` to the command line."""
    parent.command("bridge")(command)


def command(
    config: Annotated[
        Path, typer.Argument(metavar="CONFIG", help="YAML file of the parameters, or one of ROS 2.")
    ],
    transport: Annotated[
        Transport, typer.Option(help="Zenoh, as rmw_zenoh does, or ROS 2's own library rclpy.")
    ] = Transport.zenoh,
    connect: Annotated[
        list[str] | None,
        typer.Option(help="Address of a router or peer, such as tcp/127.0.0.1:7447; may be repeated."),
    ] = None,
    listen: Annotated[
        list[str] | None,
        typer.Option(
            help="Own address (default: tcp/127.0.0.1:7448, or with --connect a free port of 127.0.0.1); "
            "may be repeated. Nothing is encrypted unless --zenoh-config says so."
        ),
    ] = None,
    zenoh_config: Annotated[
        Path | None, typer.Option(help="Configuration file of Zenoh, for certificates and access control.")
    ] = None,
) -> None:
    """Find contacts in joint states of a running robot and publish them, until Ctrl-C."""
    of_zenoh = connect or listen or zenoh_config
    if transport is not Transport.zenoh and of_zenoh:
        raise InputError("transport: --connect, --listen and --zenoh-config are of zenoh")
    configuration = read_configuration(config)
    robot = quietly(robot_of, configuration, package_folders(configuration.robot))
    for line in summary(robot.warnings):
        print(f"{robot.name}: {line}", file=sys.stderr)
    node = ContactNode(configuration, robot)
    bridge: ZenohBridge | Ros2Bridge
    if transport is Transport.zenoh:
        bridge = ZenohBridge(configuration, node, Endpoints(connect or (), listen or (), zenoh_config))
    else:
        bridge = Ros2Bridge(configuration, node)
    # What is there now stays: looking through it again and again would delay messages by milliseconds.
    gc.collect()
    gc.freeze()
    with bridge:
        print(_told(configuration, bridge), file=sys.stderr, flush=True)
        try:
            bridge.run()
        finally:
            gc.unfreeze()
            print(node.summary(), flush=True)


def _told(configuration: Configuration, bridge: ZenohBridge | Ros2Bridge) -> str:
    place = f" at {', '.join(bridge.addresses)}" if isinstance(bridge, ZenohBridge) else ""
    return f"{configuration.joint_states} -> {configuration.prefix}/...{place}; Ctrl-C ends it"
