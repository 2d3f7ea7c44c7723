"""A headless Chromium that is told what to do by its DevTools protocol."""

from __future__ import annotations

import base64
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome")
# A page is there after so long [s], or it is not to be had: rendering without a graphics card is slow.
PATIENCE = 60.0
_ENDING = 15.0  # until it is made to end [s]
_LONGEST = 100 * 1024 * 1024  # message of the browser [bytes]: a picture of the page


class NoBrowserError(RuntimeError):
    """There is no Chromium on this machine."""


def chromium() -> str | None:
    """The program, if there is one."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Browser:
    """One tab of a browser, of a size in pixels; a context manager.

    Args:
        width: of the page.
        height: of the page.
        script: run in each page before its own.

    Raises:
        NoBrowserError: there is none.
    """

    def __init__(self, width: int = 1400, height: int = 900, script: str = "") -> None:
        from websockets.sync.client import connect

        program = chromium()
        if program is None:
            raise NoBrowserError(f"needs one of {', '.join(NAMES)} on the PATH; there is none")
        self._folder = tempfile.TemporaryDirectory(prefix="browser-", ignore_cleanup_errors=True)
        command = [program, "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"]
        command += ["--enable-unsafe-swiftshader", "--hide-scrollbars", "--no-first-run"]
        command += [f"--window-size={width},{height}", f"--user-data-dir={self._folder.name}"]
        self.process = subprocess.Popen(
            [*command, "--remote-debugging-port=0", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self._number = 0
        try:
            port, path = self._port()
            self._socket = connect(f"ws://127.0.0.1:{port}{path}", max_size=_LONGEST)
        except BaseException:
            self._end()
            raise
        self._session: str | None = None
        target = self.call("Target.getTargets")["targetInfos"][0]["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.call("Emulation.setDeviceMetricsOverride", **size)
        self.call("Page.enable")
        self.call("Page.addScriptToEvaluateOnNewDocument", source=script)

    def _port(self) -> tuple[str, str]:
        file = Path(self._folder.name) / "DevToolsActivePort"
        until = time.monotonic() + PATIENCE
        while True:
            lines = file.read_text().splitlines() if file.exists() else []
            if len(lines) == 2:
                return lines[0], lines[1]
            if time.monotonic() > until or self.process.poll() is not None:
                raise RuntimeError("the browser did not start")
            time.sleep(0.05)

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Calls a method of the protocol; what the browser tells meanwhile is left out."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        self._socket.send(json.dumps(message))
        while True:
            answer = json.loads(self._socket.recv(timeout=PATIENCE))
            if answer.get("id") == self._number:
                break
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        result: dict[str, Any] = answer["result"]
        return result

    def open(self, address: str) -> None:
        """Goes to a page, and waits until it is loaded; what its programs draw may come later."""
        self.call("Page.navigate", url=address)
        self.wait_for("location.href != 'about:blank' && document.readyState == 'complete'")

    def evaluate(self, expression: str) -> Any:
        """The value of an expression of JavaScript, or of the promise that it gives."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait_for(self, condition: str | Callable[[], bool]) -> None:
        """Waits until an expression of JavaScript is true, or a function says so."""
        until = time.monotonic() + PATIENCE
        while not (condition() if callable(condition) else self.evaluate(f"Boolean({condition})")):
            if time.monotonic() > until:
                raise TimeoutError(f"the page never came to {condition}")
            time.sleep(0.1)

    def click(self, x: float, y: float) -> None:
        """Presses and releases the mouse at a point [pixels]."""
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def picture(self) -> bytes:
        """The page as PNG."""
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def close(self) -> None:
        """Ends the browser."""
        self._socket.close()
        self._end()

    def _end(self) -> None:
        self.process.terminate()
        try:
            self.process.wait(timeout=_ENDING)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
        self._folder.cleanup()

    def __enter__(self) -> Browser:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
