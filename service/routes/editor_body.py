"""Bodies of editors' requests: what is wrong with one is told in an answer with HTTP 200."""

from collections.abc import Awaitable, Callable
from typing import TypeVar

from fastapi import Request
from pydantic import ValidationError

from service.json_body import read_limited
from service.messages.editor import EditorMessage
from service.problem_details import ProblemError, from_validation

M = TypeVar("M", bound=EditorMessage)


def editor_body(model: type[M]) -> Callable[[Request], Awaitable[M | str]]:
    """A dependency that reads a body, or says what is wrong with it.

    Clients show nothing of an answer whose status is not 200: what is wrong goes into the answer.
    """

    async def read(request: Request) -> M | str:
        try:
            body = await read_limited(request, request.app.state.settings.max_body_bytes)
            return model.model_validate_json(body)
        except ProblemError as problem:
            return problem.detail
        except ValidationError as error:
            detail = from_validation(error).detail
            if any(fault["type"] == "json_invalid" for fault in error.errors()):
                detail += (
                    "; if the texts hold characters beyond ASCII, the client may have counted "
                    "characters instead of bytes in Content-Length, and cut them off"
                )
            return detail

    return read
