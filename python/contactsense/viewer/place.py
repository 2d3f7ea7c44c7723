"""Where a page is served, and to whom."""

from __future__ import annotations

import ipaddress
import re
import secrets
import socket
from dataclasses import dataclass

from ..errors import InputError

# Bytes of a token that is drawn at random: more than can be guessed.
_RANDOM = 32
# Characters that an address in the browser can have, and as many as cannot be tried one after the other.
_TOKEN = re.compile(r"[A-Za-z0-9_-]{16,}")


@dataclass(frozen=True)
class Place:
    """An address that is listened at.

    Args:
        host: name or number of an interface.
        port: of the page.
        token: what a browser has to know; None where any program of this machine may see the page.
    """

    host: str
    port: int
    token: str | None

    @property
    def shown_host(self) -> str:
        """The host for an address in a browser."""
        number = _number(self.host)
        if number is not None and number.is_unspecified:
            return socket.gethostname()
        return f"[{self.host}]" if ":" in self.host else self.host


def place_of(host: str, port: int, token: str | None) -> Place:
    """The place that a user asks for: with a token, a random one unless it is given, where others reach it.

    Raises:
        InputError: names the argument.
    """
    if not isinstance(host, str) or not host:
        raise InputError(f"host: must be a name or a number such as '127.0.0.1', not {host!r}")
    if isinstance(port, bool) or not isinstance(port, int) or not 1 <= port <= 65535:
        raise InputError(f"port: must be from 1 to 65535, not {port}")
    if token is not None and not (isinstance(token, str) and _TOKEN.fullmatch(token)):
        raise InputError("token: must be at least 16 letters, digits, '-' or '_'")
    if token is None and not _is_loopback(host):
        token = secrets.token_urlsafe(_RANDOM)
    return Place(host, port, token)


def _is_loopback(host: str) -> bool:
    number = _number(host)
    return host == "localhost" if number is None else number.is_loopback


def _number(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None
