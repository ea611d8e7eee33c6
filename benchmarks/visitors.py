"""A server of the page, and visitors without a browser: they say what a browser would say."""

from __future__ import annotations

import asyncio
import json
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import psutil
from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

from cutcell_lab.benchmarks.rigs import ROOT

PATIENCE = 120.0
MAX_MESSAGE = 2**28
BOUND = r"interior, .* surface"
"""Text of the page when the weights are ready."""


class Server:
    """A server of the page, as a subprocess."""

    def __init__(self, address: str, process: psutil.Process) -> None:
        self.address = address
        self.process = process

    def megabytes(self) -> float:
        """Return the memory that the process has to itself, in MB."""
        return self.process.memory_full_info().uss / 2**20


@contextmanager
def served(*arguments: str, **environment: str) -> Iterator[Server]:
    """Run `cutcell app` until the block ends."""
    command = [sys.executable, "-m", "cutcell", "app", *arguments, "--no-show", "--port", "0"]
    process = subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, text=True, env={**os.environ, **environment}
    )
    assert process.stdout is not None
    try:
        line = process.stdout.readline()
        match = re.search(r"http://\S+", line)
        if not match:
            raise RuntimeError(f"the server did not start: {line}")
        yield Server(match.group(), psutil.Process(process.pid))
    finally:
        process.terminate()
        process.wait(20)
        process.stdout.close()


class Visitor:
    """One session, without a browser.

    Parameters
    ----------
    address : str
        Of the server.
    query : str
        What the address holds behind it, from the question mark on.
    """

    def __init__(self, address: str, query: str = "") -> None:
        self.heard: list[str] = []
        self._count = 0
        self._arrived = threading.Event()
        self._socket = _wait(self._connect(address, query))
        self._listening = asyncio.run_coroutine_threadsafe(self._listen(), _loop())
        self.wait_for('"ACK"')
        self._send("PULL-DOC-REQ", {})
        whole = self.wait_for('"doc":')
        match = re.search(r'"id":"(p\d+)","attributes":\{"name":"SceneView"', whole)
        if not match:
            raise RuntimeError("there is no view on the page")
        self.view = match.group(1)
        self._event("document_ready", [])
        self.tell(type="ready", width=1200)

    def tell(self, **message: Any) -> None:
        """Send a message of the view's own."""
        data = {"type": "map", "entries": [list(item) for item in message.items()]}
        self._event("data_event", [["model", {"id": self.view}], ["data", data]])

    def wait_for(self, pattern: str, seconds: float = PATIENCE) -> str:
        """Wait until the server sends something that matches; return that message."""
        end, checked = time.monotonic() + seconds, 0
        while time.monotonic() < end:
            self._arrived.clear()
            for text in self.heard[checked:]:
                if re.search(pattern, text):
                    return text
            checked = len(self.heard)
            self._arrived.wait(0.5)
        raise TimeoutError(f"the server did not say {pattern}")

    def has_heard(self, pattern: str) -> bool:
        """Return whether the server has sent something that matches."""
        return any(re.search(pattern, text) for text in self.heard)

    def close(self) -> None:
        """Leave."""
        _loop().call_soon_threadsafe(self._socket.close)
        self._listening.result(10)

    async def _connect(self, address: str, query: str) -> WebSocketClientConnection:
        end = time.monotonic() + PATIENCE
        while True:
            try:
                page = await AsyncHTTPClient().fetch(
                    f"{address}/{query}", request_timeout=PATIENCE, connect_timeout=PATIENCE
                )
                token = token_of(page.body.decode())
                return await websocket_connect(
                    HTTPRequest(
                        address.replace("http", "ws") + "/ws",
                        request_timeout=PATIENCE,
                        headers={"Origin": address},
                    ),
                    subprotocols=["bokeh", token],
                    max_message_size=MAX_MESSAGE,
                )
            except OSError:
                # The server tells its address a moment before it listens.
                if time.monotonic() > end:
                    raise
                await asyncio.sleep(0.2)

    async def _listen(self) -> None:
        while (part := await self._socket.read_message()) is not None:
            if isinstance(part, str):
                self.heard.append(part)
                self._arrived.set()

    def _send(self, kind: str, content: dict[str, Any]) -> None:
        self._count += 1
        header = {"msgid": f"m{self._count}", "msgtype": kind}
        parts = [json.dumps(part) for part in (header, {}, content)]

        def write() -> None:
            for part in parts:
                self._socket.write_message(part)

        _loop().call_soon_threadsafe(write)

    def _event(self, name: str, entries: list[Any]) -> None:
        event = {"type": "event", "name": name, "values": {"type": "map", "entries": entries}}
        message = {"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": event}
        self._send("PATCH-DOC", {"events": [message]})


def token_of(page: str) -> str:
    """Return the token in the text of the page."""
    match = re.search(r'"token":"([^"]+)"', page.replace("&quot;", '"'))
    if not match:
        raise RuntimeError("there is no token on the page")
    return match.group(1)


_LOOPS: list[asyncio.AbstractEventLoop] = []


def _loop() -> asyncio.AbstractEventLoop:
    if not _LOOPS:
        loop = asyncio.new_event_loop()
        threading.Thread(target=loop.run_forever, daemon=True, name="visitors").start()
        _LOOPS.append(loop)
    return _LOOPS[0]


def _wait(work: Any) -> Any:
    return asyncio.run_coroutine_threadsafe(work, _loop()).result(PATIENCE)
