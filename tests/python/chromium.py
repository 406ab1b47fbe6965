# SPDX-License-Identifier: GPL-3.0-or-later
"""Headless Chromium, driven over a pair of pipes by its DevTools protocol."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import signal
import subprocess
import time
from pathlib import Path

# WebGL on the processor; as root there is no sandbox, in containers little /dev/shm.
FLAGS = (
    *("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run"),
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars"),
    *("--disable-background-networking", "--disable-component-update"),
)


def find() -> str | None:
    """The program, if it is installed."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    """One page. What it says and asks for is kept in `console` and `requests`."""

    def __init__(self, folder: Path) -> None:
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()
        command = [
            *("bash", "-c", f'exec "$@" 3<&{to_browser} 4>&{from_browser}', "bash"),
            *(find() or "chromium", *FLAGS, "--remote-debugging-pipe"),
            *(f"--user-data-dir={folder}", "about:blank"),
        ]
        self._log = (folder / "log").open("wb")
        self._process = subprocess.Popen(
            command,
            pass_fds=(to_browser, from_browser),
            stdout=self._log,
            stderr=self._log,
            start_new_session=True,
        )
        os.close(to_browser)
        os.close(from_browser)
        self._buffer = b""
        self._count = 0
        self._session = None
        self.console: list[str] = []
        self.requests: list[str] = []
        targets = self.send("Target.getTargets")["targetInfos"]
        page = next(t["targetId"] for t in targets if t["type"] == "page")
        attached = self.send("Target.attachToTarget", targetId=page, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")

    def send(self, method: str, **params):
        """Call a method of the protocol and wait for what it returns."""
        self._count += 1
        number = self._count
        message = {"id": number, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._out, data) :]
        while True:
            answer = self._read()
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]

    def _read(self, seconds: float = 60) -> dict:
        end = time.monotonic() + seconds
        while b"\0" not in self._buffer:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self._in], [], [], left)[0]:
                raise TimeoutError("Chromium does not answer")
            data = os.read(self._in, 1 << 20)
            if not data:
                raise RuntimeError("Chromium has ended")
            self._buffer += data
        line, _, self._buffer = self._buffer.partition(b"\0")
        message = json.loads(line)
        self._note(message.get("method"), message.get("params", {}))
        return message

    def _note(self, method: str | None, params: dict) -> None:
        if method == "Runtime.consoleAPICalled":
            said = [a.get("value", a.get("description")) for a in params["args"]]
            self.console.append(f"{params['type']}: {' '.join(map(str, said))}")
        elif method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.console.append(f"exception: {details}")
        elif method == "Log.entryAdded":
            self.console.append(
                f"{params['entry']['level']}: {params['entry']['text']}"
            )
        elif method == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"])

    def resize(self, width: int, height: int, *, mobile: bool = False) -> None:
        self.send(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=mobile,
        )

    def open(self, path: Path) -> None:
        """Load a page and wait until its picture is drawn."""
        self.send("Page.navigate", url=path.resolve().as_uri())
        self.wait_for("document.readyState === 'complete'")

    def wait_for(self, condition: str, seconds: float = 40) -> None:
        end = time.monotonic() + seconds
        while not self.evaluate(condition):
            if time.monotonic() > end:
                raise TimeoutError(f"{condition}; console: {self.console}")
            time.sleep(0.1)

    def evaluate(self, expression: str):
        """The value of an expression of JavaScript; promises are waited for."""
        answer = self.send(
            "Runtime.evaluate",
            expression=expression,
            returnByValue=True,
            awaitPromise=True,
        )
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Hold the left button from one point of the window to the other."""
        steps = [
            (
                start[0] + (end[0] - start[0]) * t / 8,
                start[1] + (end[1] - start[1]) * t / 8,
            )
            for t in range(9)
        ]
        self._mouse("mouseMoved", start, "none")
        self._mouse("mousePressed", start, "left")
        for step in steps[1:]:
            self._mouse("mouseMoved", step, "left")
            time.sleep(0.03)
        self._mouse("mouseReleased", end, "left")

    def _mouse(self, kind: str, where: tuple[float, float], button: str) -> None:
        self.send(
            "Input.dispatchMouseEvent",
            type=kind,
            x=where[0],
            y=where[1],
            button=button,
            buttons=1 if button == "left" and kind != "mouseReleased" else 0,
            clickCount=1 if kind in ("mousePressed", "mouseReleased") else 0,
        )

    def screenshot(self, *, whole: bool = False, clip: dict | None = None) -> bytes:
        """A PNG of the window, of a part of it, or of the whole page."""
        options = {"captureBeyondViewport": whole}
        if clip is not None:
            options["clip"] = {**clip, "scale": 1}
        answer = self.send("Page.captureScreenshot", format="png", **options)
        return base64.b64decode(answer["data"])

    def close(self) -> None:
        """End the browser and all its processes."""
        os.close(self._out)
        try:
            self._process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        os.close(self._in)
        self._log.close()
