"""Errors as `application/problem+json` (RFC 9457): what, where, why, how to mend."""

from collections.abc import Sequence
from http import HTTPStatus

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ValidationError
from starlette.exceptions import HTTPException

MEDIA_TYPE = "application/problem+json"
ERRORS_SHOWN = 20


class ErrorLocation(BaseModel):
    """One fault of a body."""

    location: str
    """JSON pointer (RFC 6901) into the body; empty for the whole of it."""
    message: str


class Diagnostic(BaseModel):
    """A finding in a PDDL text; lines and columns count from 1."""

    location: str
    """JSON pointer to the text in the body."""
    line: int
    column: int
    end_line: int
    end_column: int
    severity: str
    code: str
    message: str
    remedy: str | None = None
    rendered: str
    """The finding with the line concerned and a caret under the fault."""


class Problem(BaseModel):
    """The body of every error."""

    type: str
    title: str
    status: int
    detail: str
    errors: list[ErrorLocation] | None = None
    diagnostics: list[Diagnostic] | None = None


class ProblemError(Exception):
    """A request that cannot be served, with all that its sender needs to mend it."""

    def __init__(
        self,
        status: HTTPStatus,
        kind: str,
        detail: str,
        errors: Sequence[tuple[str, str]] = (),
        headers: dict[str, str] | None = None,
    ) -> None:
        super().__init__(detail)
        self.status = status
        self.kind = kind
        self.detail = detail
        self.errors = list(errors)
        self.headers = headers or {}
        self.diagnostics: list[Diagnostic] = []

    def problem(self) -> Problem:
        """The body that tells it."""
        return Problem(
            type=f"urn:marsupial:problem:{self.kind}",
            title=self.kind.replace("-", " "),
            status=int(self.status),
            detail=self.detail,
            errors=[ErrorLocation(location=w, message=m) for w, m in self.errors] or None,
            diagnostics=self.diagnostics[:ERRORS_SHOWN] or None,
        )


def not_found(noun: str, identifier: str) -> ProblemError:
    """There is no such thing."""
    return ProblemError(
        HTTPStatus.NOT_FOUND, "not-found", f"there is no {noun} {identifier[:100]!r}"
    )


def invalid(errors: Sequence[tuple[str, str]]) -> ProblemError:
    """A body that is well-formed JSON but not what is asked for."""
    where, what = errors[0]
    more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    return ProblemError(
        HTTPStatus.UNPROCESSABLE_ENTITY,
        "invalid-body",
        f"{where or 'the body'}: {what}{more}",
        errors[:ERRORS_SHOWN],
    )


def pointer(path: Sequence[int | str]) -> str:
    """A JSON pointer (RFC 6901); tags of unions, which are in brackets, are no part of a body."""
    parts = [str(part) for part in path]
    return "".join(
        "/" + part.replace("~", "~0").replace("/", "~1")
        for part in parts
        if not (part.startswith("(") and part.endswith(")"))
    )


def from_validation(error: ValidationError) -> ProblemError:
    """What pydantic found, as a problem."""
    found = error.errors(include_url=False, include_context=False, include_input=False)
    if any(fault["type"] == "json_invalid" for fault in found):
        return ProblemError(
            HTTPStatus.BAD_REQUEST, "invalid-json", found[0]["msg"], [("", found[0]["msg"])]
        )
    return invalid([(pointer(fault["loc"]), fault["msg"]) for fault in found])


def response(problem: ProblemError) -> Response:
    """The answer that carries a problem."""
    return Response(
        problem.problem().model_dump_json(exclude_none=True),
        status_code=int(problem.status),
        media_type=MEDIA_TYPE,
        headers=problem.headers,
    )


def install(app: FastAPI) -> None:
    """Makes every error of `app` a problem."""

    @app.exception_handler(ProblemError)
    async def _(_: Request, error: ProblemError) -> Response:
        return response(error)

    @app.exception_handler(HTTPException)
    async def _(_: Request, error: HTTPException) -> Response:
        status = HTTPStatus(error.status_code)
        kind = status.phrase.lower().replace(" ", "-")
        headers = dict(error.headers or {})
        return response(ProblemError(status, kind, str(error.detail), headers=headers))

    @app.exception_handler(RequestValidationError)
    async def _(_: Request, error: RequestValidationError) -> Response:
        return response(
            invalid([(pointer(fault["loc"]), fault["msg"]) for fault in error.errors()])
        )
