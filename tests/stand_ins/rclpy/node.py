"""A node that keeps what it publishes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Logger:
    def info(self, text: str) -> None:
        print("info:", text)

    def warning(self, text: str) -> None:
        print("warning:", text)


class Publisher:
    def __init__(self, published: list[Any]) -> None:
        self.publish = published.append


class Node:
    def __init__(self, name: str) -> None:
        self.name = name
        self.callbacks: list[Callable[[Any], None]] = []
        self.published: list[Any] = []

    def create_subscription(
        self, kind: type, topic: str, callback: Callable[[Any], None], qos: object
    ) -> None:
        self.callbacks.append(callback)

    def create_publisher(self, kind: type, topic: str, depth: int) -> Publisher:
        return Publisher(self.published)

    def get_logger(self) -> Logger:
        return Logger()

    def destroy_node(self) -> None:
        self.callbacks.clear()
