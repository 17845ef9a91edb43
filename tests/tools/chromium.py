"""Headless Chromium through the pipes of `--remote-debugging-pipe`: no port, no library.

Protocol: https://chromedevtools.github.io/devtools-protocol, messages are JSON with a zero byte at
the end; Chromium reads file 3 and writes file 4.
"""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

MISSING = "no Chromium here: apt-get install chromium"
_NAMES = ("chromium", "chromium-browser", "google-chrome")
_FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-default-apps", "--disable-extensions", "--hide-scrollbars",
    "--disable-dev-shm-usage", "--remote-debugging-pipe", "--no-proxy-server",
)  # fmt: skip
_LONGEST_S = 60.0


def chromium() -> str | None:
    """Where Chromium is, None when it is not installed."""
    return next((path for name in _NAMES if (path := shutil.which(name))), None)


class Browser:
    """A Chromium with one page. A context manager: its end ends the process.

    errors: what the page has written to its console as errors or thrown. requested: addresses that
    it has asked for, those of the page itself among them.
    """

    def __init__(self, size: tuple[int, int] = (1400, 1000), *, is_dark: bool = False) -> None:
        self.errors: list[str] = []
        self.requested: list[str] = []
        self._size, self._is_dark = size, is_dark
        self._number, self._buffer = 0, b""
        self._session: str | None = None
        self._events: list[dict[str, Any]] = []

    def __enter__(self) -> Self:
        self._folder = tempfile.mkdtemp(prefix="chromium-")
        read_3, self._write = os.pipe()
        self._read, write_4 = os.pipe()
        path = chromium()
        assert path is not None, MISSING
        command = [path, *_FLAGS, f"--user-data-dir={self._folder}", "about:blank"]
        # The shell gives the pipes their numbers
        line = f'exec "$@" 3<&{read_3} 4>&{write_4}'
        self._process = subprocess.Popen(
            ["bash", "-c", line, "bash", *command],
            pass_fds=(read_3, write_4),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(read_3)
        os.close(write_4)
        targets = self.call("Target.getTargets")["targetInfos"]
        page = next(target for target in targets if target["type"] == "page")
        attach = {"targetId": page["targetId"], "flatten": True}
        self._session = self.call("Target.attachToTarget", **attach)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        width, height = self._size
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.call("Emulation.setDeviceMetricsOverride", **metrics)
        self.dark(self._is_dark)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self._session = None
        with suppress(Exception):
            self.call("Browser.close")
        with suppress(OSError):
            os.close(self._write)
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._read)
        shutil.rmtree(self._folder, ignore_errors=True)

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        """Send a command and wait for its answer. Raises RuntimeError for an error."""
        number = self._send(method, **params)
        while True:
            answer = self._next()
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return dict(answer["result"])
            self._take(answer)

    def _send(self, method: str, **params: Any) -> int:
        """Send a command; return its number."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._write, data) :]
        return self._number

    def open(self, path: Path, hash_: str = "") -> float:
        """Open a file by its `file://` address; return the time until it was loaded, s."""
        return self.go(path.resolve().as_uri() + hash_)

    def go(self, address: str) -> float:
        """Open an address; return the time until it was loaded, s."""
        begin = time.perf_counter()
        self.call("Page.navigate", url=address)
        self.wait("Page.loadEventFired")
        self.run("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)))")
        return time.perf_counter() - begin

    def wait(self, method: str) -> None:
        """Wait for an event of the page."""
        while not any(event["method"] == method for event in self._events):
            self._take(self._next())
        self._events.clear()

    def run(self, expression: str) -> Any:
        """Return the value of an expression of the page; waits for a promise.

        Raises RuntimeError with what it has thrown.
        """
        answer = self.call(
            "Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            said = details.get("exception", {}).get("description") or details["text"]
            raise RuntimeError(f"{expression[:200]}: {said}")
        return answer["result"].get("value")

    def dark(self, is_dark: bool) -> None:
        """Choose the colours that the page is asked for."""
        scheme = {"name": "prefers-color-scheme", "value": "dark" if is_dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])

    def picture(self, path: Path) -> None:
        """Write what is seen as PNG."""
        path.write_bytes(base64.b64decode(self.call("Page.captureScreenshot")["data"]))

    def printed(self, path: Path) -> None:
        """Print into a PDF file."""
        answer = self.call("Page.printToPDF", preferCSSPageSize=True, printBackground=True)
        path.write_bytes(base64.b64decode(answer["data"]))

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            if not select.select([self._read], [], [], _LONGEST_S)[0]:
                raise RuntimeError(f"no answer of Chromium for {_LONGEST_S:g} s")
            data = os.read(self._read, 1 << 20)
            if not data:
                raise RuntimeError("Chromium has ended")
            self._buffer += data
        message, _, self._buffer = self._buffer.partition(b"\0")
        return dict(json.loads(message))

    def _take(self, message: dict[str, Any]) -> None:
        """Keep what an event says."""
        method, params = message.get("method", ""), message.get("params", {})
        self._events.append(message) if method.startswith("Page.") else None
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.errors.append(
                details.get("exception", {}).get("description") or details.get("text", "")
            )
        elif method == "Runtime.consoleAPICalled" and params["type"] in {"error", "assert"}:
            self.errors.append(str([arg.get("value") for arg in params["args"]]))
        elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.errors.append(params["entry"]["text"])
        elif method == "Page.javascriptDialogOpening":  # would wait for a reader for ever
            self.errors.append(f"dialog: {params['message']}")
            self._send("Page.handleJavaScriptDialog", accept=True)
        elif method == "Network.requestWillBeSent":
            self.requested.append(params["request"]["url"])
