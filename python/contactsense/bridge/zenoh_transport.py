"""A bridge over Zenoh."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable
from contextlib import suppress
from typing import Any

from .._extras import require
from ..errors import InputError
from ..offline.ros_messages import DIAGNOSTICS, JOINT_STATE, MARKERS, WRENCH, Messages
from .cdr import CdrNode, PublishedBytes
from .configuration import Configuration
from .endpoints import Endpoints
from .node import PERIOD, ContactNode
from .rmw_zenoh import NO_HASH, Attachments, Graph, Losses, key_expression

# Joint states that wait while the bridge is busy; of more, the oldest are left out: a second at 1 kHz. A
# queue that is bounded otherwise would hold up the sender.
_WAITING = 1000


class ZenohBridge:
    """A node at a session of Zenoh; a context manager.

    Args:
        configuration: of the bridge.
        node: that finds the contacts.
        endpoints: of Zenoh.

    Raises:
        InputError: the session cannot be opened.
        MissingExtraError: a package is not installed.

    Attributes:
        addresses: where others reach it.
    """

    def __init__(self, configuration: Configuration, node: ContactNode, endpoints: Endpoints) -> None:
        require("bridge", "zenoh", "rosbags")
        import zenoh

        messages = Messages()
        self._cdr = CdrNode(node, messages)
        self._lock = threading.Lock()
        self._losses = Losses()
        self._ended = threading.Event()
        self._failure: BaseException | None = None
        self.addresses = endpoints.own
        settings = endpoints.configuration()
        try:
            self._session: Any = zenoh.open(settings)
        except zenoh.ZError as error:
            raise InputError(f"zenoh: the session cannot be opened: {error}") from error
        domain = configuration.domain
        graph = Graph(domain, str(self._session.zid()), configuration.node)
        alive = self._session.liveliness()
        self._tokens = [alive.declare_token(graph.node_token())]
        self._publishers: dict[str, tuple[Any, Attachments]] = {}
        written = {
            configuration.external_torque_topic: JOINT_STATE,
            configuration.contacts_topic: WRENCH,
            configuration.not_located_topic: WRENCH,
            configuration.markers_topic: MARKERS,
            configuration.diagnostics: DIAGNOSTICS,
        }
        for number, (topic, kind) in enumerate(written.items(), start=1):
            type_hash = messages.type_hash(kind) if configuration.type_hash else NO_HASH
            token = graph.publisher_token(number, topic, kind, type_hash)
            self._tokens.append(alive.declare_token(token))
            # Each message goes out at once: waiting for more to send with it costs latency.
            publisher = self._session.declare_publisher(
                key_expression(domain, topic, kind, type_hash), express=True
            )
            self._publishers[topic] = publisher, Attachments(token)
        read = {configuration.joint_states: JOINT_STATE}
        read |= {sensor.topic: WRENCH for sensor in configuration.sensors.values()}
        for number, (topic, kind) in enumerate(read.items(), start=1 + len(written)):
            type_hash = messages.type_hash(kind) if configuration.type_hash else NO_HASH
            self._tokens.append(alive.declare_token(graph.subscription_token(number, topic, kind, type_hash)))
        self._wrenches = [
            self._session.declare_subscriber(
                key_expression(domain, sensor.topic, WRENCH, "*"), self._wrench_of(sensor.topic)
            )
            for sensor in configuration.sensors.values()
        ]
        self._states: Any = self._session.declare_subscriber(
            key_expression(domain, configuration.joint_states, JOINT_STATE, "*"),
            zenoh.handlers.RingChannel(_WAITING),
        )
        node.start(time.monotonic())
        self._worker = threading.Thread(target=self._work, name="joint states", daemon=True)
        self._worker.start()

    def run(self) -> None:
        """Publishes diagnostics, until Ctrl-C or a failure of the session ends it."""
        while not self._ended.wait(PERIOD):
            with self._lock:
                topic, data = self._cdr.health(time.time_ns(), time.monotonic())
                self._publish([(topic, data)])
        if self._failure is not None:
            raise self._failure

    def close(self) -> None:
        """Ends the session."""
        with suppress(Exception):  # it may have ended by itself
            self._states.undeclare()
        self._worker.join(PERIOD)
        with suppress(Exception):  # somebody else hangs
            self._session.close()

    def __enter__(self) -> ZenohBridge:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _work(self) -> None:
        """Takes in joint states until there are no more."""
        try:
            for sample in self._states:
                data, attachment = sample.payload.to_bytes(), sample.attachment
                with self._lock:
                    if attachment is not None:
                        self._cdr.node.lose(self._losses.before(attachment.to_bytes()))
                    self._publish(self._cdr.joint_state(data, time.monotonic()))
        except BaseException as failure:
            self._failure = failure
        self._ended.set()

    def _publish(self, published: Iterable[PublishedBytes]) -> None:
        for topic, data in published:
            publisher, attachments = self._publishers[topic]
            publisher.put(data, attachment=attachments.next(time.time_ns()))

    def _wrench_of(self, topic: str) -> Any:
        def take(sample: Any) -> None:
            with self._lock:
                self._cdr.wrench(topic, sample.payload.to_bytes(), time.monotonic())

        return take
