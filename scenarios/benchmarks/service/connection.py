"""A keep-alive HTTP/1.1 connection that costs the machine next to nothing.

The load must leave the processor to the server: this is a twentieth of a general client's work.
"""

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any

LIMIT_BYTES = 2**22


class ConnectionLostError(Exception):
    """The server closed the connection."""


class Connection:
    """One request after the other to one server."""

    def __init__(self, host: str, port: int) -> None:
        self._host, self._port = host, port
        self._reader: asyncio.StreamReader | None = None
        self._writer: asyncio.StreamWriter | None = None

    async def request(
        self, method: str, path: str, body: dict[str, Any] | None = None
    ) -> tuple[int, Any]:
        """Status and JSON of the answer.

        Raises:
            ConnectionLostError: the server went away before it had answered.
        """
        try:
            reader = await self._send(method, path, body)
            status, headers = await _head(reader)
            content = await reader.readexactly(int(headers.get("content-length", "0")))
        except (OSError, asyncio.IncompleteReadError) as error:
            self.close()
            raise ConnectionLostError(str(error)) from None
        return status, json.loads(content) if content else None

    async def lines(self, path: str) -> AsyncIterator[str]:
        """The lines of a stream of server-sent events, as they come."""
        try:
            reader = await self._send("GET", path, None)
            await _head(reader)
            rest = ""
            while size := int(await reader.readline() or b"0", 16):
                rest += (await reader.readexactly(size)).decode()
                await reader.readexactly(2)
                *whole, rest = rest.split("\n")
                for line in whole:
                    yield line.rstrip("\r")
        except (OSError, asyncio.IncompleteReadError):
            return
        finally:
            self.close()

    async def _send(
        self, method: str, path: str, body: dict[str, Any] | None
    ) -> asyncio.StreamReader:
        if self._reader is None or self._writer is None:
            self._reader, self._writer = await asyncio.open_connection(
                self._host, self._port, limit=LIMIT_BYTES
            )
        content = b"" if body is None else json.dumps(body).encode()
        self._writer.write(
            f"{method} {path} HTTP/1.1\r\nHost: {self._host}\r\n"
            f"Content-Type: application/json\r\nContent-Length: {len(content)}\r\n\r\n".encode()
            + content
        )
        return self._reader

    def close(self) -> None:
        """Lets go of the connection; the next request opens another."""
        if self._writer is not None:
            self._writer.close()
        self._reader = self._writer = None


async def _head(reader: asyncio.StreamReader) -> tuple[int, dict[str, str]]:
    """Status and headers."""
    head = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1").split("\r\n")
    headers = dict(line.lower().split(": ", 1) for line in head[1:] if line)
    return int(head[0].split(" ", 2)[1]), headers
