"""The gate before a page that others than this machine reach: who is let through, and who is not."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest
from ctrl_c import HEARS_CTRL_C
from log_files import DT, arm, named_columns, pushed, write_csv
from tools.browser import chromium
from viewer_pages import free_port

import contactsense as cs

pytest.importorskip("viser")
from contactsense.viewer import gate
from contactsense.viewer.gate import Gate
from contactsense.viewer.place import place_of

# viser and what it builds on keep sockets of pages that have ended open for a while.
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")

TOKEN = "0123456789abcdefghij"
UPGRADE = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
UPGRADE += "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n"


class Inner:
    """In place of a page: answers every connection with the same, and keeps what it was sent."""

    def __init__(self, answer: bytes) -> None:
        self._answer = answer
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._socket.getsockname()[1])
        self.received: list[bytearray] = []
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        with suppress(OSError):
            while True:
                connection, _ = self._socket.accept()
                received = bytearray()
                self.received.append(received)
                threading.Thread(target=self._answer_it, args=(connection, received), daemon=True).start()

    def _answer_it(self, connection: socket.socket, received: bytearray) -> None:
        with connection, suppress(OSError):
            received += connection.recv(65536)
            connection.sendall(self._answer)
            if self._answer.startswith(b"HTTP/1.1 101"):
                while piece := connection.recv(65536):
                    received += piece
                    connection.sendall(piece.upper())

    def close(self) -> None:
        self._socket.close()


@pytest.fixture
def inner() -> Iterator[Inner]:
    inner = Inner(b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nhi")
    yield inner
    inner.close()


@pytest.fixture
def port(inner: Inner) -> Iterator[int]:
    it = Gate("127.0.0.1", free_port(), inner.port, TOKEN)
    yield it.port
    it.close()


def talk(port: int, *sent: bytes | str, wait: float = 0.0) -> bytes:
    """All that is answered to what is sent."""
    answer = b""
    with socket.create_connection(("127.0.0.1", port), timeout=20.0) as it, suppress(ConnectionError):
        for piece in sent:
            it.sendall(piece.encode() if isinstance(piece, str) else piece)
            time.sleep(wait)
        while piece := it.recv(65536):
            answer += piece
    return answer


def get(target: str = "/", headers: str = "", method: str = "GET", version: str = "HTTP/1.1") -> str:
    return f"{method} {target} {version}\r\nHost: robot:8080\r\n{headers}\r\n"


def cookie(port: int, token: str = TOKEN) -> str:
    return f"Cookie: other=1; contactsense_{port}={token}\r\n"


def test_the_token_opens_and_is_kept_in_a_cookie(port: int, inner: Inner) -> None:
    answer = talk(port, get(f"/a.js?x=1&token={TOKEN}", "Accept-Encoding: gzip\r\nCookie: secret=3\r\n"))
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 200 OK\r\n")
    assert body == b"hi"
    kept = f"Set-Cookie: contactsense_{port}={TOKEN}; Path=/; HttpOnly; SameSite=Strict\r\n"
    assert kept.encode() in head
    # What goes on has the rest of the query, and neither token nor cookies.
    (received,) = inner.received
    assert received.startswith(b"GET /a.js?x=1 HTTP/1.1\r\n")
    assert b"accept-encoding: gzip\r\n" in received
    assert b"ookie" not in received
    assert TOKEN.encode() not in received
    assert talk(port, get("/", cookie(port))).endswith(b"hi")


@pytest.mark.parametrize(
    "request_text",
    [
        get(),
        get("/?token="),
        get(f"/?token={TOKEN[:-1]}"),
        get(f"/?token={TOKEN}x"),
        get(f"/?Token={TOKEN}"),
        get(f"/{TOKEN}"),
        get("/", f"Cookie: contactsense={TOKEN}\r\n"),
        get("/", f"Referer: http://robot:8080/?token={TOKEN}\r\n"),
        get("/", UPGRADE),
        get("/?token=wrong", UPGRADE),
        # With the token, but not what a browser sends for a page: two readings are possible.
        get(f"/?token={TOKEN}", method="POST"),
        get(f"/?token={TOKEN}", method="CONNECT"),
        get(f"/?token={TOKEN}", version="HTTP/1.0"),
        get(f"http://robot/?token={TOKEN}"),
        get(f"//[robot/?token={TOKEN}"),
        get(f"/?token={TOKEN}", "Content-Length: 40\r\n"),
        get(f"/?token={TOKEN}", "Content-Length: 0\r\nTransfer-Encoding: chunked\r\n"),
        get(f"/?token={TOKEN}", "Transfer-Encoding : chunked\r\n"),
        get(f"/?token={TOKEN}", "Accept: a\r\nAccept: b\r\n"),
        get(f"/?token={TOKEN}", "Accept: a\n\nGET / HTTP/1.1\r\n"),
        get(f"/?token={TOKEN}", "Accept: a\rX: b\r\n"),
        get(f"/?token={TOKEN}", "Accept: a\0\r\n"),
        get(f"/?token={TOKEN}", " folded: a\r\n"),
        get(f"/?token={TOKEN}", "no colon\r\n"),
        f"GET  /?token={TOKEN} HTTP/1.1\r\n\r\n",
        f"GET /?token={TOKEN}\r\n\r\n",
        "\r\n\r\n",
    ],
)
def test_others_are_refused_and_the_page_hears_nothing(port: int, inner: Inner, request_text: str) -> None:
    answer = talk(port, request_text)
    assert answer.startswith(b"HTTP/1.1 403 Forbidden\r\n")
    assert b"Connection: close" in answer
    assert inner.received == []


def test_a_wrong_cookie_is_refused(port: int, inner: Inner) -> None:
    for header in (cookie(port, TOKEN[::-1]), cookie(port + 1), cookie(port, "")):
        assert b"403" in talk(port, get("/", header)).split(b"\r\n")[0]
    assert inner.received == []


def test_a_page_of_another_server_is_refused(port: int, inner: Inner) -> None:
    for origin in ("http://evil", "http://robot:8081", "null"):
        header = f"{cookie(port)}Origin: {origin}\r\n{UPGRADE}"
        assert b"403" in talk(port, get("/", header)).split(b"\r\n")[0]
    assert inner.received == []
    own = f"{cookie(port)}Origin: http://robot:8080\r\n{UPGRADE}"
    assert talk(port, get("/", own)).endswith(b"hi")


def test_a_second_request_on_a_connection_goes_nowhere(port: int, inner: Inner) -> None:
    """Neither one that is sent at once with the first, nor one that follows it."""
    first = get(f"/?token={TOKEN}")
    assert talk(port, first + get("/secret")).endswith(b"\r\n\r\nhi")
    assert talk(port, first, get("/secret"), wait=0.2).endswith(b"\r\n\r\nhi")
    # A websocket that the page does not agree to is none either.
    assert talk(port, get(f"/?token={TOKEN}", UPGRADE) + get("/secret")).endswith(b"\r\n\r\nhi")
    assert len(inner.received) == 3
    assert all(received.count(b"HTTP/1.1") == 1 for received in inner.received)
    assert not any(b"secret" in received for received in inner.received)


def test_a_websocket_goes_both_ways() -> None:
    inner = Inner(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n\r\n")
    it = Gate("127.0.0.1", free_port(), inner.port, TOKEN)
    try:
        with socket.create_connection(("127.0.0.1", it.port), timeout=20.0) as connection:
            connection.sendall(get("/", UPGRADE + cookie(it.port)).encode() + b"early ")
            answer = b""
            while not answer.endswith(b"EARLY LATE"):
                if answer.endswith(b"EARLY "):
                    connection.sendall(b"late")
                answer += connection.recv(65536)
            assert answer.startswith(b"HTTP/1.1 101 Switching Protocols\r\n")
            # It ends with the gate.
            it.close()
            assert connection.recv(65536) == b""
        (received,) = inner.received
        assert b"sec-websocket-key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n" in received
    finally:
        inner.close()


def test_long_and_slow_heads_are_cut_off(port: int, inner: Inner, monkeypatch: pytest.MonkeyPatch) -> None:
    long = talk(port, get(f"/?token={TOKEN}", f"X: {17_000 * 'a'}\r\n"))
    assert long == b"" or long.startswith(b"HTTP/1.1 403")
    endless = talk(port, f"GET /?token={TOKEN} HTTP/1.1\r\n", *(300 * [100 * "X: a\r\n"]))
    assert endless == b"" or endless.startswith(b"HTTP/1.1 403")
    monkeypatch.setattr(gate, "_HEAD_TIME", 0.3)
    # It comes byte by byte, and each in time.
    text = get(f"/?token={TOKEN}")
    slow = talk(port, *text[:30], wait=0.05)
    assert slow == b"" or slow.startswith(b"HTTP/1.1 403")
    assert talk(port, "GET").startswith(b"HTTP/1.1 403")
    assert inner.received == []
    assert talk(port, text).endswith(b"hi")


def test_many_who_say_nothing_are_not_kept(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gate, "_MOST_UNKNOWN", 3)
    silent = [socket.create_connection(("127.0.0.1", port)) for _ in range(3)]

    def wait_for(start: bytes) -> None:
        until = time.monotonic() + 20.0
        while not talk(port, get(f"/?token={TOKEN}")).startswith(start):
            assert time.monotonic() < until
            time.sleep(0.05)

    monkeypatch.setattr(gate, "_HEAD_TIME", 60.0)
    silent += [socket.create_connection(("127.0.0.1", port)) for _ in range(3)]
    wait_for(b"HTTP/1.1 403")
    for each in silent:
        each.close()
    wait_for(b"HTTP/1.1 200")


def test_who_needs_a_token() -> None:
    for host in ("127.0.0.1", "127.0.0.7", "::1", "localhost"):
        assert place_of(host, 8080, None).token is None
    assert place_of("127.0.0.1", 8080, TOKEN).token == TOKEN
    drawn = {place_of(host, 8080, None).token for host in ("0.0.0.0", "::", "192.168.1.2", "robot", "0")}
    assert len(drawn) == 5
    assert all(token is not None and len(token) > 40 for token in drawn)
    assert place_of("::1", 8080, None).shown_host == "[::1]"
    assert place_of("0.0.0.0", 8080, None).shown_host == socket.gethostname()


def test_a_page_on_all_addresses_has_a_gate() -> None:
    result = cs.replay(pushed()[:100], cs.ContactMonitor(arm(), dt=DT))
    with cs.view(result, host="0.0.0.0", port=free_port()) as page:
        check_gate(page.address)
        # The page itself listens to this machine alone.
        inner = page._page.server.get_port()
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.2", inner), timeout=5.0)
        with cs.view(result, host="0.0.0.0", port=urlsplit(page.address).port or 0) as next_page:
            assert urlsplit(next_page.address).port != urlsplit(page.address).port
    with cs.view(result, host="localhost", port=free_port()) as page:
        assert "token" not in page.address
        urllib.request.urlopen(page.address, timeout=20.0).close()


def check_gate(address: str, token: str | None = None) -> str:
    """It lets through who has the token of the address; the address on this machine."""
    parts = urlsplit(address)
    (found,) = parse_qs(parts.query)["token"]
    assert token is None or found == token
    assert parts.port is not None
    assert talk(parts.port, get()).startswith(b"HTTP/1.1 403")
    assert talk(parts.port, get("/", UPGRADE)).startswith(b"HTTP/1.1 403")
    assert talk(parts.port, get("/?token=wrong", UPGRADE)).startswith(b"HTTP/1.1 403")
    here = f"http://127.0.0.1:{parts.port}/"
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(f"{here}?token=wrong", timeout=20.0)
    with urllib.request.urlopen(f"{here}?{parts.query}", timeout=20.0) as answer:
        assert b"<html" in answer.read(2000)
    switched = b"HTTP/1.1 101 Switching Protocols"
    with socket.create_connection(("127.0.0.1", parts.port), timeout=20.0) as it:
        it.sendall(get(f"/?{parts.query}", UPGRADE + "Sec-WebSocket-Protocol: viser-v0\r\n").encode())
        assert it.recv(len(switched)) == switched
    return f"{here}?{parts.query}"


def test_a_browser_with_the_token_shows_a_control_loop(request: pytest.FixtureRequest) -> None:
    monitor = cs.ContactMonitor(arm(), dt=DT)
    with cs.view(monitor, host="0.0.0.0", port=free_port(), token=TOKEN) as page:
        page.show(arm().neutral(), monitor.update(arm().neutral(), [0.0] * 7, [0.0] * 7))
        address = check_gate(page.address, TOKEN)
        if chromium() is None:
            pytest.skip("there is no Chromium")
        browser = request.getfixturevalue("browser")
        browser.open(address.partition("?")[0])
        assert browser.evaluate("document.body.innerText").startswith("The address must have")
        browser.open(address)
        # The websocket brings what is told of the instant.
        browser.wait_for("document.body.innerText.includes('no contact')")
        # The cookie lets it in from now on, and no script of the page reads it.
        assert browser.evaluate("document.cookie") == ""
        browser.open(address.partition("?")[0])
        browser.wait_for("document.body.innerText.includes('no contact')")
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(("127.0.0.1", urlsplit(address).port or 0), timeout=5.0)


def test_the_command_tells_the_address_with_the_token(tmp_path: Path) -> None:
    log = pushed()[:100]
    words = {"position": "pos", "velocity": "vel", "torque": "effort"}
    columns = {"time": log.time, **named_columns(log, [str(k) for k in range(1, 8)], words)}
    file = write_csv(tmp_path / "pushed.csv", columns)
    command = [sys.executable, "-c", HEARS_CTRL_C, "view", str(file), "--robot", "iiwa14"]
    command += ["--host", "0.0.0.0", "--port", str(free_port())]
    environment = {**os.environ, "CONTACTSENSE_TOKEN": TOKEN}
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stderr is not None
        try:
            told = next(line for line in process.stderr if "shows the log" in line)
            check_gate(told.split()[0], TOKEN)
            process.send_signal(signal.SIGINT)
            assert process.wait(timeout=60.0) == 0
        finally:
            process.kill()


def test_a_place_that_cannot_be_listened_at_is_named() -> None:
    monitor = cs.ContactMonitor(arm(), dt=DT)
    with pytest.raises(cs.InputError, match=r"^host: cannot listen at '192\.0\.2\.1', port "):
        cs.view(monitor, host="192.0.2.1", port=free_port())
    done = subprocess.run(
        [sys.executable, "-m", "contactsense", "view", "a.csv", "--robot", "iiwa14", "--token", "x"],
        capture_output=True, text=True, timeout=100, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert "token: must be at least 16" in done.stderr
