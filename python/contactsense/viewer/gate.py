"""Lets those to a page who know its token, and nobody else.

The page itself has no passwords, so it is served to this machine alone, and a gate before it listens where
others are. A connection carries one request, for a file or for a websocket. Its head is read in full, within
bounds, before anything goes on; it goes on only with the token, and written anew from what was understood, so
that the page reads no other request than the gate did. Nothing is encrypted.
"""

from __future__ import annotations

import asyncio
import errno
import hmac
import threading
from concurrent.futures import Future
from urllib.parse import parse_qsl, urlencode, urlsplit

from ..errors import InputError
from .request import END, Request, read_request

_HEAD = 16 * 1024  # of a request or an answer [bytes]; browsers send less than two thousand
_HEAD_TIME = 5.0  # in which the head of a request is there [s]
_PIECE = 64 * 1024  # that is passed on at once [bytes]
# Connections that may be reading their heads: more are closed at once, so that strangers take no memory.
_MOST_UNKNOWN = 64
_PORTS = 100  # tried one after the other where they are in use
_REASON = b"The address must have its ?token=\n"
_FORBIDDEN = b"HTTP/1.1 403 Forbidden\r\nContent-Type: text/plain\r\nConnection: close\r\n"
_FORBIDDEN += b"Content-Length: %d\r\n\r\n" % len(_REASON) + _REASON
# Of a request that goes on: `Cookie` stays here, and there is no body.
_PASSED = ("accept", "accept-encoding", "origin", "user-agent")
_WEBSOCKET = tuple(f"sec-websocket-{name}" for name in ("key", "version", "protocol", "extensions"))


class Gate:
    """A gate that is open until it is closed, on a thread of its own.

    Args:
        host: where it listens.
        port: the next free one is taken where it is in use.
        inner: port of the page, on this machine.
        token: what opens it.

    Raises:
        InputError: it cannot listen there.
    """

    def __init__(self, host: str, port: int, inner: int, token: str) -> None:
        self._inner, self._token = inner, token.encode()
        self._unknown = 0
        opened: Future[int] = Future()
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._serve(host, port, opened)), daemon=True
        )
        self._thread.start()
        self.port = opened.result()

    def close(self) -> None:
        """Closes it, and all connections through it."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._closed.set)
            self._thread.join()

    async def _serve(self, host: str, port: int, opened: Future[int]) -> None:
        self._loop, self._closed = asyncio.get_running_loop(), asyncio.Event()
        try:
            server, found = await self._listen(host, port)
        except BaseException as cause:
            opened.set_exception(cause)
            return
        # Cookies of a host are those of all its ports.
        self._cookie = f"contactsense_{found}"
        opened.set_result(found)
        await self._closed.wait()
        server.close()

    async def _listen(self, host: str, port: int) -> tuple[asyncio.Server, int]:
        cause: OSError | None = None
        for attempt in range(port, min(port + _PORTS, 65536)):
            try:
                return await asyncio.start_server(self._meet, host, attempt, limit=_HEAD), attempt
            except OSError as error:
                cause = error
                if error.errno != errno.EADDRINUSE:
                    break
        raise InputError(f"host: cannot listen at '{host}', port {port}: {cause}")

    async def _meet(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            request = await self._known(reader)
            if request is None:
                writer.write(_FORBIDDEN)
                await writer.drain()
            else:
                await self._let_through(request, reader, writer)
        except (OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
            pass  # one of the two has gone
        finally:
            writer.close()

    async def _known(self, reader: asyncio.StreamReader) -> Request | None:
        """The request of someone who knows the token."""
        if self._unknown >= _MOST_UNKNOWN:
            return None
        self._unknown += 1
        try:
            head = await asyncio.wait_for(reader.readuntil(END), _HEAD_TIME)
            request = read_request(head)
            return request if request.is_of_own_page and self._knows(request) else None
        except (asyncio.TimeoutError, asyncio.LimitOverrunError, ValueError):
            return None
        finally:
            self._unknown -= 1

    def _knows(self, request: Request) -> bool:
        pairs = (pair.partition("=") for pair in request.headers.get("cookie", "").split(";"))
        told = [value for name, _, value in pairs if name.strip() == self._cookie]
        told += [value for name, value in parse_qsl(urlsplit(request.target).query) if name == "token"]
        return any([hmac.compare_digest(value.strip().encode(), self._token) for value in told])

    async def _let_through(
        self, request: Request, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        inner_reader, inner = await asyncio.open_connection("127.0.0.1", self._inner, limit=_HEAD)
        try:
            inner.write(self._head(request))
            answer = await inner_reader.readuntil(END)
            status, _, rest = answer.partition(b"\r\n")
            cookie = f"{self._cookie}={self._token.decode()}; Path=/; HttpOnly; SameSite=Strict"
            more = f"Set-Cookie: {cookie}\r\nReferrer-Policy: no-referrer\r\nCache-Control: no-store\r\n"
            writer.write(status + b"\r\n" + more.encode() + rest)
            passing = [asyncio.ensure_future(_pass_on(inner_reader, writer))]
            # What else was sent is no request: it goes on only where both have agreed on a websocket.
            if request.upgrades and status.startswith(b"HTTP/1.1 101 "):
                passing.append(asyncio.ensure_future(_pass_on(reader, inner)))
            try:
                await asyncio.wait(passing, return_when=asyncio.FIRST_COMPLETED)
            finally:
                for task in passing:
                    task.cancel()
                await asyncio.gather(*passing, return_exceptions=True)
        finally:
            inner.close()

    def _head(self, request: Request) -> bytes:
        """What the page is asked for."""
        parts = urlsplit(request.target)
        query = urlencode([pair for pair in parse_qsl(parts.query) if pair[0] != "token"])
        names = (*_PASSED, *_WEBSOCKET) if request.upgrades else _PASSED
        lines = [f"GET {parts.path}{'?' if query else ''}{query} HTTP/1.1", f"Host: 127.0.0.1:{self._inner}"]
        lines += ["Upgrade: websocket", "Connection: Upgrade"] if request.upgrades else ["Connection: close"]
        lines += [f"{name}: {request.headers[name]}" for name in names if name in request.headers]
        return "\r\n".join([*lines, "", ""]).encode("latin-1")


async def _pass_on(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while piece := await reader.read(_PIECE):
        writer.write(piece)
        await writer.drain()
