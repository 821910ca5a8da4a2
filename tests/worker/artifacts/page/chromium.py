"""A headless Chromium, spoken to over two pipes in its DevTools protocol: no port, no driver."""

import json
import os
import select
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

_FLAGS = (
    "--headless",
    "--no-sandbox",  # CI is root in a container
    "--remote-debugging-pipe",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    # WebGL without a graphics card.
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    # Nothing beyond this machine can be reached, so that no test depends on it.
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
)

_ANSWER_S = 120.0
"""Software draws 3D slowly where two cores do everything."""


def chromium_or_skip() -> str:
    """Path of the browser. Skips the test where there is none; in CI that is a failure."""
    path = os.environ.get("NEURALMRI_CHROMIUM") or shutil.which("chromium")
    if path is None:
        remedy = "no chromium on PATH; install it, or name one in NEURALMRI_CHROMIUM"
        if os.environ.get("NEURALMRI_REQUIRE_BROWSER") == "1":
            pytest.fail(remedy)
        pytest.skip(remedy)
    return path


class Browser:
    """The pipes: commands go in, answers and events come out."""

    def __init__(self, to_browser: int, from_browser: int) -> None:
        self._to, self._from = to_browser, from_browser
        self._unread = b""
        self._last_id = 0
        self._tabs: dict[str, Tab] = {}

    def tab(self) -> "Tab":
        """A new one, empty."""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        tab = self._tabs[session] = Tab(self, session)
        for domain in ("Page", "Runtime", "Network", "Log"):
            tab.call(f"{domain}.enable")
        return tab

    def call(self, method: str, session: str | None = None, **parameters: Any) -> dict[str, Any]:
        """What the browser answers to a command. Raises AssertionError when it refuses."""
        self._last_id += 1
        message: dict[str, Any] = {"id": self._last_id, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        _write(self._to, json.dumps(message).encode() + b"\0")
        ends = time.monotonic() + _ANSWER_S
        while (answer := self._read(ends)).get("id") != self._last_id:
            if answer.get("sessionId") in self._tabs:
                self._tabs[answer["sessionId"]].events.append(answer)
        assert "error" not in answer, f"{method}: {answer['error']}"
        return dict(answer["result"])

    def _read(self, ends: float) -> dict[str, Any]:
        while b"\0" not in self._unread:
            ready, _, _ = select.select([self._from], [], [], max(0.0, ends - time.monotonic()))
            assert ready, "Chromium does not answer"
            chunk = os.read(self._from, 1 << 20)
            assert chunk, "Chromium has ended"
            self._unread += chunk
        message, _, self._unread = self._unread.partition(b"\0")
        return dict(json.loads(message))


class Tab:
    """One page, and what happened on it."""

    def __init__(self, browser: Browser, session: str) -> None:
        self._browser, self._session = browser, session
        self.events: list[dict[str, Any]] = []

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """As of the browser, for this tab."""
        return self._browser.call(method, self._session, **parameters)

    def evaluate(self, expression: str) -> Any:
        """The value of a JavaScript expression, of a promise what it resolves to."""
        found = self.call(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def open(self, url: str, *, until: str) -> None:
        """Go to a page and wait until an expression is true there."""
        self.call("Page.navigate", url=url)
        ends = time.monotonic() + _ANSWER_S
        while not self.evaluate(until):
            assert time.monotonic() < ends, f"not {until} after {_ANSWER_S} s: {self.faults()}"
            time.sleep(0.1)

    def resize(self, width: int, height: int = 900) -> None:
        """Make the screen so large, in CSS pixels; a narrow one is a phone's."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )

    def requests(self) -> list[str]:
        """Addresses of all that was asked for, but what is in the page itself."""
        sent = [e["params"]["request"]["url"] for e in self._named("Network.requestWillBeSent")]
        return [url for url in sent if not url.startswith(("data:", "blob:"))]

    def faults(self) -> list[str]:
        """Exceptions, errors on the console, and what a policy forbade."""
        return [
            *(json.dumps(e["params"]) for e in self._named("Runtime.exceptionThrown")),
            *(
                json.dumps(e["params"])
                for e in self._named("Runtime.consoleAPICalled")
                if e["params"]["type"] in ("error", "assert")
            ),
            *(
                json.dumps(e["params"])
                for e in self._named("Log.entryAdded")
                if e["params"]["entry"]["level"] == "error"
            ),
        ]

    def _named(self, method: str) -> Iterator[dict[str, Any]]:
        return (event for event in self.events if event["method"] == method)


@contextmanager
def browser(profile: Path) -> Iterator[Browser]:
    """A browser with a profile of its own, ended at the end."""
    path = chromium_or_skip()
    read_commands, write_commands = os.pipe()
    read_answers, write_answers = os.pipe()
    # The browser reads file 3 and writes file 4.
    shell = f'exec 3<&{read_commands} 4>&{write_answers}; exec "$@"'
    process = subprocess.Popen(
        ["bash", "-c", shell, "bash", path, *_FLAGS, f"--user-data-dir={profile}"],
        pass_fds=(read_commands, write_answers),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(read_commands)
    os.close(write_answers)
    try:
        yield Browser(write_commands, read_answers)
    finally:
        os.close(write_commands)
        os.close(read_answers)
        process.terminate()
        process.wait(timeout=30)


def _write(file: int, message: bytes) -> None:
    while message:
        message = message[os.write(file, message) :]
