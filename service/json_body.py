"""Request bodies, read straight into strict messages.

FastAPI parses JSON first and validates Python objects then, where strict mode would refuse a list
for a tuple. Reading the text with pydantic keeps strictness and gives one kind of error.
"""

from collections.abc import Awaitable, Callable, Sequence
from http import HTTPStatus
from typing import Any, TypeVar

from fastapi import FastAPI, Request
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel, ValidationError

from service.examples import EXAMPLES
from service.openapi_links import add_links
from service.problem_details import ProblemError, from_validation

M = TypeVar("M", bound=BaseModel)
SCHEMAS = "#/components/schemas/{model}"


async def read_limited(request: Request, limit_bytes: int) -> bytes:
    """The body, or 413 as soon as it is known to be larger than `limit_bytes`."""
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > limit_bytes:
            raise ProblemError(
                HTTPStatus(413),
                "body-too-large",
                f"the body is larger than the {limit_bytes} bytes this server accepts",
            )
    return bytes(body)


def json_body(model: type[M]) -> Callable[[Request], Awaitable[M]]:
    """A dependency that reads a body of this kind."""

    async def read(request: Request) -> M:
        body = await read_limited(request, request.app.state.settings.max_body_bytes)
        try:
            return model.model_validate_json(body)
        except ValidationError as error:
            raise from_validation(error) from None

    return read


def described(model: type[BaseModel]) -> dict[str, Any]:
    """`openapi_extra` of a route whose body `json_body(model)` reads."""
    media: dict[str, Any] = {"schema": {"$ref": SCHEMAS.format(model=model.__name__)}}
    if (example := EXAMPLES.get(model.__name__)) is not None:
        media["example"] = example
    return {"requestBody": {"required": True, "content": {"application/json": media}}}


def install_openapi(app: FastAPI, bodies: Sequence[type[BaseModel]]) -> None:
    """Adds the schemas of bodies read by `json_body` to the OpenAPI document."""

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            document = get_openapi(
                title=app.title, version=app.version, summary=app.summary, routes=app.routes
            )
            schemas = document.setdefault("components", {}).setdefault("schemas", {})
            for model in bodies:
                schema = model.model_json_schema(ref_template=SCHEMAS)
                schemas.update(schema.pop("$defs", {}))
                schemas[model.__name__] = schema
            add_links(document)
            app.openapi_schema = document
        return app.openapi_schema

    app.openapi = openapi  # type: ignore[method-assign]
