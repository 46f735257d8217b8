"""Domains: PDDL that missions and planning requests use by name."""

from functools import partial

import anyio.to_thread
from fastapi import Request
from pydantic import ValidationError

import planner
from service.json_body import described
from service.messages.resource import DomainUpload, DomainVersion
from service.problem_details import from_validation, invalid
from service.resources.domain_check import checked_domain, domain_findings
from service.routes.resource_access import summarised
from service.routes.resources import Noun, router
from service.store.resource_store import Content, Stored


async def read(request: Request, body: bytes, formulation: str | None) -> Content:
    """The domain in a body; PDDL as `text/plain` does, too, with `?formulation=NAME`."""
    settings = request.app.state.settings
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    try:
        if kind == "text/plain":
            asked = request.query_params.get("formulation")
            more = {} if asked is None else {"formulation": asked}
            upload = DomainUpload(text=body.decode(), **more)
        else:
            upload = DomainUpload.model_validate_json(body)
    except ValidationError as error:
        raise from_validation(error) from None
    except UnicodeDecodeError as error:
        raise invalid([("/text", f"is not UTF-8: {error.reason}")]) from None
    wanted = upload.formulation if "formulation" in upload.model_fields_set else formulation
    check = partial(checked_domain, upload.text, wanted, settings.max_pddl_bytes)
    return (await anyio.to_thread.run_sync(check)).content


def show(stored: Stored) -> DomainVersion:
    """A version with its text and what the reader thinks of it."""
    raw = stored.body.encode()
    domain = planner.read_domain(raw)
    return DomainVersion(
        **summarised(stored),
        formulation=stored.formulation,
        actions=domain.actions,
        modules=[module.name for module in domain.modules],
        requirements=domain.requirements,
        diagnostics=domain_findings(raw),
        text=stored.body,
    )


ROUTER = router(Noun("domain", "domains", read, show, DomainVersion, described(DomainUpload)))
BODIES = (DomainUpload,)
