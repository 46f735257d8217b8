"""A server in a process of its own, for tests that kill it; the fleet's side of the wire."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]


class ServerProcess:
    """`marsupial serve` on a port that stays the same from one process to the next."""

    def __init__(self, folder: Path, *options: str) -> None:
        self.database = folder / "missions.sqlite"
        self._options = options
        self._log = folder / "server.log"
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port: int = free.getsockname()[1]
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Returns when it is ready."""
        with self._log.open("ab") as log:
            self.process = subprocess.Popen(
                [
                    *(sys.executable, "-m", "scenarios.cli", "serve", "--port", str(self.port)),
                    *("--db", f"sqlite:///{self.database}", *self._options),
                ],
                cwd=ROOT,
                stdout=log,
                stderr=log,
            )
        for _ in range(1200):
            assert self.process.poll() is None, self._log.read_text(encoding="utf-8")
            try:
                if self.request("GET", "/readyz")[0] == 200:
                    return
            except (OSError, HTTPException):
                time.sleep(0.05)
        raise TimeoutError(self._log.read_text(encoding="utf-8"))

    def kill(self, number: signal.Signals = signal.SIGKILL) -> float:
        """Sends a signal and waits for the end; the time that it took [s]."""
        assert self.process is not None
        begun_s = time.monotonic()
        self.process.send_signal(number)
        self.process.wait(60)
        return time.monotonic() - begun_s

    def children(self) -> list[int]:
        """Processes that the server has started, and those that they have."""
        assert self.process is not None
        found = [self.process.pid]
        for parent in found:
            children = Path(f"/proc/{parent}/task/{parent}/children")
            if children.exists():
                found += [int(child) for child in children.read_text(encoding="ascii").split()]
        return found[1:]

    def request(self, method: str, path: str, body: Any = None, **headers: str) -> tuple[int, Any]:
        """Status and JSON of the answer."""
        connection = HTTPConnection("127.0.0.1", self.port, timeout=60.0)
        try:
            content = None if body is None else json.dumps(body)
            connection.request(method, path, content, headers)
            answer = connection.getresponse()
            text = answer.read()
            return answer.status, json.loads(text) if text else None
        finally:
            connection.close()

    def listen(self, path: str, **headers: str) -> socket.socket:
        """A connection on which server-sent events come."""
        connection = socket.create_connection(("127.0.0.1", self.port), timeout=30.0)
        more = "".join(f"{name}: {value}\r\n" for name, value in headers.items())
        connection.sendall(f"GET {path} HTTP/1.1\r\nHost: x\r\n{more}\r\n".encode())
        return connection

    @property
    def resident_mb(self) -> float:
        """Memory of the server [MiB]."""
        assert self.process is not None
        statm = Path(f"/proc/{self.process.pid}/statm").read_text(encoding="ascii")
        return int(statm.split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20
