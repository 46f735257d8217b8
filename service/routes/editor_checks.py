"""What editors ask besides plans: findings in PDDL texts, verdicts on plans.

Shapes are those that the VS Code extension reads.
"""

from http import HTTPStatus
from typing import Annotated

import anyio.to_thread
from fastapi import APIRouter, Depends, Request

import planner
from service.access import needs
from service.json_body import described
from service.messages.editor import Json, ParseBody, ValidateBody
from service.routes.editor_body import editor_body

ROUTER = APIRouter(tags=["editors"], dependencies=[Depends(needs("operate"))])
BODIES = (ParseBody, ValidateBody)


@ROUTER.post("/parse", openapi_extra=described(ParseBody))
async def parse(
    request: Request, body: Annotated[ParseBody | str, Depends(editor_body(ParseBody))]
) -> list[Json]:
    """Findings in a domain and its problems."""
    if isinstance(body, str):
        return [_fault("DOMAIN", body)]
    limit = request.app.state.settings.max_pddl_bytes
    if max(map(len, (body.domain, *body.problems))) > limit:
        return [_fault("DOMAIN", f"a text is longer than the {limit} bytes this server accepts")]
    return await anyio.to_thread.run_sync(findings, body.domain, body.problems)


def findings(domain_text: str, problems: list[str]) -> list[Json]:
    """Findings as the VS Code extension reads them; lines and columns count from 1."""
    try:
        domain = planner.read_domain(domain_text.encode())
    except planner.PddlError as error:
        return [_finding("DOMAIN", diagnostic) for diagnostic in error.diagnostics]
    found = []
    for index, text in enumerate(problems):
        try:
            planner.read_problem(domain, text.encode())
        except planner.PddlError as error:
            found += [_finding(f"PROBLEM:{index}", d) for d in error.diagnostics]
    return found


def _fault(location: str, message: str, line: int = 1) -> Json:
    position = {"line": line, "character": 1}
    return {"location": location, "message": message, "severity": "error", "position": position}


def _finding(location: str, diagnostic: planner.Diagnostic) -> Json:
    severity = "info" if diagnostic.severity == "information" else diagnostic.severity
    remedy = f"; {diagnostic.remedy}" if diagnostic.remedy else ""
    return {
        "location": location,
        "message": f"{diagnostic.message}{remedy}",
        "severity": severity,
        "position": {"line": diagnostic.line, "character": diagnostic.column},
    }


@ROUTER.post("/validate", openapi_extra=described(ValidateBody), status_code=HTTPStatus.OK)
async def validate(
    request: Request, body: Annotated[ValidateBody | str, Depends(editor_body(ValidateBody))]
) -> Json:
    """Whether a plan is valid; if not, why."""
    if isinstance(body, str):
        return {"validation": {"error": body, "problems": []}}
    limit = request.app.state.settings.max_pddl_bytes
    if max(len(body.domain), len(body.problem), len(body.plan)) > limit:
        error = f"a text is longer than the {limit} bytes this server accepts"
        return {"validation": {"error": error, "problems": []}}
    return {"validation": await anyio.to_thread.run_sync(validation, body)}


def validation(body: ValidateBody) -> Json:
    """The verdict as the VS Code extension reads it."""
    problems = findings(body.domain, [body.problem])
    if any(found["severity"] == "error" for found in problems):
        return {"error": "the domain or the problem has faults", "problems": problems}
    domain = planner.read_domain(body.domain.encode())
    problem = planner.read_problem(domain, body.problem.encode())
    try:
        plan = planner.read_plan(problem, body.plan.encode())
        verdict = planner.validate(domain, problem, plan)
    except planner.PddlError as error:
        faults = [_finding("PLAN", diagnostic) for diagnostic in error.diagnostics]
        return {"error": "the plan cannot be read", "problems": [*problems, *faults]}
    except planner.PlannerError as error:
        return {"error": str(error), "problems": problems}
    if verdict.valid:
        return {"problems": problems}
    line = (verdict.step or 0) + 1
    fault = _fault("PLAN", verdict.message or str(verdict.reason), line)
    return {"error": verdict.message or str(verdict.reason), "problems": [*problems, fault]}
