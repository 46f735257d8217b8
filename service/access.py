"""Who may do what: API keys, hashed, with scopes and fleets.

Keys are 256 random bits, so that one SHA-256 protects them as well as a slow hash would protect a
password. Without keys everything is open, which `marsupial serve` allows on loopback only.
"""

import hashlib
import hmac
import secrets
import tomllib
from collections.abc import Awaitable, Callable, Sequence
from http import HTTPStatus
from pathlib import Path
from typing import Literal

from fastapi import Request
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.requests import HTTPConnection

from service.problem_details import ProblemError

Scope = Literal["read", "operate", "edit"]
ANY_FLEET = "*"
PREFIX = "mk_"


class ApiKey(BaseModel):
    """A key as it is kept: whoever reads the file cannot use it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str = Field(min_length=1, max_length=64)
    """Appears in the audit log."""
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")
    scopes: list[Scope] = Field(min_length=1)
    """`read`: look at everything; `operate`: missions, reports, plans; `edit`: people's changes."""
    fleets: list[str] = Field(default_factory=lambda: [ANY_FLEET], min_length=1)
    """Fleets whose missions it reaches; `*` is all."""


class KeyFileError(ValueError):
    """A key file that cannot be used."""


def read_keys(path: Path) -> list[ApiKey]:
    """The keys of a TOML file with `[[key]]` tables.

    Raises:
        KeyFileError: what is wrong, and where.
    """
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
        keys = [ApiKey.model_validate(entry) for entry in document.get("key", [])]
    except OSError as error:
        raise KeyFileError(f"{path}: {error.strerror}") from None
    except tomllib.TOMLDecodeError as error:
        raise KeyFileError(f"{path}: {error}") from None
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise KeyFileError(f"{path}: {where}: {first['msg']}") from None
    if not keys:
        raise KeyFileError(f"{path} holds no [[key]]; make one with `marsupial new-key`")
    return keys


def new_key(name: str, scopes: Sequence[Scope], fleets: Sequence[str]) -> tuple[str, str]:
    """A new key, and the TOML table to keep of it."""
    key = PREFIX + secrets.token_urlsafe(32)
    listed = ", ".join(f'"{scope}"' for scope in scopes)
    reached = ", ".join(f'"{fleet}"' for fleet in fleets)
    table = (
        f'[[key]]\nname = "{name}"\nsha256 = "{digest(key)}"\n'
        f"scopes = [{listed}]\nfleets = [{reached}]\n"
    )
    return key, table


def digest(key: str) -> str:
    """What is kept of a key."""
    return hashlib.sha256(key.encode()).hexdigest()


class Caller(BaseModel):
    """Whoever sent a request."""

    model_config = ConfigDict(frozen=True)

    name: str
    scopes: frozenset[Scope]
    fleets: frozenset[str]

    def reaches(self, fleet: str) -> bool:
        """Whether the missions of a fleet are its business."""
        return ANY_FLEET in self.fleets or fleet in self.fleets


EVERYBODY = Caller(
    name="anonymous", scopes=frozenset({"read", "operate", "edit"}), fleets=frozenset({ANY_FLEET})
)


class Gate:
    """Tells callers by their keys."""

    def __init__(self, keys: Sequence[ApiKey]) -> None:
        self._keys = list(keys)

    def caller(self, request: HTTPConnection) -> Caller:
        """Whoever sent a request, or opened a socket.

        Raises:
            ProblemError: 401 without a known key.
        """
        if not self._keys:
            return EVERYBODY
        scheme, _, token = request.headers.get("authorization", "").partition(" ")
        if scheme.lower() != "bearer" or not token:
            raise _unauthorized("send a key: Authorization: Bearer mk_...")
        given = digest(token.strip())
        for key in self._keys:
            if hmac.compare_digest(given, key.sha256):
                return Caller(
                    name=key.name, scopes=frozenset(key.scopes), fleets=frozenset(key.fleets)
                )
        raise _unauthorized("this key is unknown")


def _unauthorized(detail: str) -> ProblemError:
    return ProblemError(
        HTTPStatus.UNAUTHORIZED, "unauthorized", detail, headers={"WWW-Authenticate": "Bearer"}
    )


def needs(changing: Scope) -> Callable[[Request], Awaitable[Caller]]:
    """A dependency: `read` for GET, the given scope for what changes something."""

    async def check(request: Request) -> Caller:
        gate: Gate = request.app.state.gate
        caller = gate.caller(request)
        request.state.caller = caller
        scope: Scope = "read" if request.method in ("GET", "HEAD") else changing
        if scope not in caller.scopes:
            raise ProblemError(
                HTTPStatus.FORBIDDEN, "forbidden", f"the key {caller.name!r} lacks scope {scope!r}"
            )
        return caller

    return check


def caller_of(request: Request) -> Caller:
    """Whoever passed the gate with this request."""
    caller: Caller = getattr(request.state, "caller", EVERYBODY)
    return caller
