"""The head of a request to a page: strict, so that no other program reads it in another way."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import urlsplit

END = b"\r\n\r\n"
_NAME = re.compile(r"[!#$%&'*+.^_`|~0-9A-Za-z-]+")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


@dataclass(frozen=True)
class Request:
    """The head of a request for a file or a websocket."""

    target: str
    headers: Mapping[str, str]

    @property
    def is_of_own_page(self) -> bool:
        """Whether no page of another server sends it, which would come with the cookies of this one."""
        origin = self.headers.get("origin")
        return origin is None or urlsplit(origin).netloc == self.headers.get("host")

    @property
    def upgrades(self) -> bool:
        """Whether it asks for a websocket."""
        return self.headers.get("upgrade", "").lower() == "websocket"


def read_request(head: bytes) -> Request:
    """The head of a request that can be read in one way only.

    Raises:
        ValueError: it is none.
    """
    text = head.decode("latin-1")[: -len(END)]
    first, *lines = text.split("\r\n")
    words = first.split(" ")
    if len(words) != 3 or words[0] != "GET" or words[2] != "HTTP/1.1" or not words[1].startswith("/"):
        raise ValueError("the first line of a request is not that of a browser")
    headers: dict[str, str] = {}
    for line in lines:
        name, colon, value = line.partition(":")
        key = name.lower()
        if not colon or not _NAME.fullmatch(name) or (key in headers and key != "cookie"):
            raise ValueError("a header is none, or is there twice")
        headers[key] = f"{headers[key]}; {value.strip()}" if key in headers else value.strip()
    # No line ends but the ones that were split at, no other control characters, and no body.
    if _CONTROL.search("".join((first, *lines))) or {"content-length", "transfer-encoding"} & headers.keys():
        raise ValueError("a request has a body or control characters")
    return Request(words[1], headers)
