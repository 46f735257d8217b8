"""The protocols of PDDL editors and of planning-as-a-service clients.

Shapes are those that the clients read: the online editor and `planutils remote` (`/package`,
`/check`), the VS Code extension (`/solve`, `/request`). Errors come with HTTP 200 where a client
reads nothing else.
"""

import json
from typing import Annotated

import anyio.to_thread
from fastapi import APIRouter, Depends, Query, Request, Response

from service.access import caller_of, needs
from service.coordination.ports import StoreError
from service.jobs.executor import QueueFullError
from service.jobs.planning_requests import Following, result
from service.json_body import described
from service.messages.editor import (
    CheckBody,
    Json,
    PackageSolveBody,
    RequestBody,
    SolveBody,
)
from service.messages.planning import PlanOut, PlanRequest
from service.problem_details import ProblemError
from service.routes.editor_body import editor_body
from service.routes.plans import Requests, checked, owned
from service.settings import Settings

ROUTER = APIRouter(tags=["editors"], dependencies=[Depends(needs("operate"))])
BODIES = (PackageSolveBody, SolveBody, RequestBody, CheckBody)
PLANNER = "marsupial"
CALL = "marsupial {domain} {problem} {time_limit} {seed}"


@ROUTER.get("/package")
async def package() -> Json:
    """The planners of this server and how to call them."""
    arguments = [
        {"name": "domain", "type": "file", "description": "domain file"},
        {"name": "problem", "type": "file", "description": "problem file"},
        {
            "name": "time_limit",
            "type": "int",
            "description": "time limit [s]",
            "default": 10,
            "choices": [],
        },
        {"name": "seed", "type": "int", "description": "random seed", "default": 0, "choices": []},
    ]
    solve = {
        "args": arguments,
        "call": CALL,
        "return": {"type": "generic", "files": "*plan*"},
    }
    return {
        PLANNER: {
            "name": "marsupial",
            "description": "Anytime temporal planner: PDDL 2.1 durative actions, numeric fluents, "
            "timed initial literals",
            "install-size": "0",
            "dependencies": [],
            "runnable": True,
            "package_name": PLANNER,
            "endpoint": {"services": {"solve": solve}},
        }
    }


async def accepted(request: Request, all_requests: Requests, body: PlanRequest) -> Following | str:
    """The request in the queue, or why it is not."""
    try:
        await anyio.to_thread.run_sync(checked, body, request.app.state.settings)
        return await all_requests.submit(body, caller_of(request).name)
    except ProblemError as error:
        rendered = [diagnostic.rendered for diagnostic in error.diagnostics]
        return "\n".join(rendered) or error.detail
    except QueueFullError as error:
        return f"the server is busy, try again in a few seconds: {error}"
    except StoreError as error:
        return f"nothing was stored, please try again: {error}"


@ROUTER.post("/package/{planner_name}/{service}", openapi_extra=described(PackageSolveBody))
async def package_solve(
    request: Request,
    planner_name: str,
    service: str,
    body: Annotated[PackageSolveBody | str, Depends(editor_body(PackageSolveBody))],
    all_requests: Requests,
) -> Json:
    """Starts planning; the answer says where to ask for the result."""
    if isinstance(body, str):
        return {"Error": body}
    if planner_name != PLANNER:
        return {"Error": f"there is no planner {planner_name[:64]!r}, only {PLANNER!r}"}
    if service != "solve":
        return {"Error": f"{PLANNER} has no service {service[:64]!r}, only 'solve'"}
    job = await accepted(
        request,
        all_requests,
        PlanRequest(
            domain_text=body.domain,
            problem=body.problem,
            time_limit_s=body.time_limit,
            seed=body.seed,
        ),
    )
    if isinstance(job, str):
        return {"Error": job}
    return {"result": f"/check/{job.id}?external=True"}


@ROUTER.get("/check/{plan_id}")
@ROUTER.get("//check/{plan_id}", include_in_schema=False)
async def check(request: Request, plan_id: str, all_requests: Requests) -> Json:
    """The result of `/package/.../solve`, or that it is not there yet."""
    job = await owned(request, plan_id, all_requests)
    if job is None:
        return {"Error": f"there is no request {plan_id[:64]!r}"}
    if not job.is_over:
        return {"status": "PENDING"}
    found = result(job)
    text = "" if found.plan is None else found.plan.text
    return {
        "status": "ok",
        "result": {
            "stdout": text or f"{found.outcome}\n",
            "stderr": found.message or "",
            "call": CALL,
            "output": {"plan": text} if text else {},
            "output_type": "generic",
        },
    }


@ROUTER.post("/check/{plan_id}", openapi_extra=described(CheckBody))
@ROUTER.post("//check/{plan_id}", include_in_schema=False)
async def check_adapted(
    request: Request,
    plan_id: str,
    body: Annotated[CheckBody | str, Depends(editor_body(CheckBody))],
    all_requests: Requests,
) -> Json:
    """The result in the shape that an editor's adaptor asks for."""
    if isinstance(body, str):
        return {"Error": body}
    if body.adaptor != "planning_editor_adaptor":
        return await check(request, plan_id, all_requests)
    job = await owned(request, plan_id, all_requests)
    if job is None:
        return {"Error": f"there is no request {plan_id[:64]!r}"}
    if not job.is_over:
        return {"status": "PENDING"}
    found = result(job)
    if found.plan is None:
        error = found.message or f"no plan was found ({found.outcome})"
        return {
            "status": "ok",
            "plans": [{"status": "error", "result": {"error": error, "parse_status": "err"}}],
        }
    steps = [
        {"name": f"({' '.join([step.action, *step.args])})", "action": line}
        for step, line in zip(found.plan.steps, _step_lines(found.plan.text), strict=True)
    ]
    return {
        "status": "ok",
        "plans": [
            {
                "status": "ok",
                "result": {
                    "output": found.plan.text,
                    "parse_status": "ok",
                    "type": "full",
                    "length": len(steps),
                    "plan": steps,
                    "planPath": "plan",
                    "logPath": "log",
                },
            }
        ],
    }


def _step_lines(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.strip() and not line.startswith(";")]


async def solved(
    request: Request, all_requests: Requests, body: PlanRequest, settings: Settings
) -> Following | str:
    """The request when it has ended; it is stopped at the operator's longest wait."""
    job = await accepted(request, all_requests, body)
    if not isinstance(job, str):
        await all_requests.wait(job, min(body.time_limit_s + 5.0, settings.max_wait_s))
        await all_requests.cancel(job)
    return job


@ROUTER.post("/solve", openapi_extra=described(SolveBody))
async def solve(
    request: Request,
    body: Annotated[SolveBody | str, Depends(editor_body(SolveBody))],
    all_requests: Requests,
) -> Json:
    """Plans for up to ten seconds and answers with the best plan."""
    if isinstance(body, str):
        return {"status": "error", "result": {"output": "", "error": body}}
    work = PlanRequest(domain_text=body.domain, problem=body.problem)
    job = await solved(request, all_requests, work, request.app.state.settings)
    if isinstance(job, str):
        return {"status": "error", "result": {"output": "", "error": job}}
    found = result(job)
    if found.plan is None:
        error = found.message or f"no plan was found ({found.outcome})"
        return {"status": "error", "result": {"output": "", "error": error}}
    return {
        "status": "ok",
        "result": {"output": found.plan.text, "error": "", "plan": json_steps(found.plan)},
    }


def json_steps(plan: PlanOut) -> list[Json]:
    """Steps as the VS Code extension reads them."""
    return [
        {
            "name": f"({' '.join([step.action, *step.args])})",
            "time": step.start,
            "duration": step.duration or 0.0,
        }
        for step in plan.steps
    ]


@ROUTER.post("/request", openapi_extra=described(RequestBody))
async def request_plan(
    request: Request,
    body: Annotated[RequestBody | str, Depends(editor_body(RequestBody))],
    all_requests: Requests,
    response: Response,
    asynchronous: Annotated[bool, Query(alias="async")] = False,
) -> Json:
    """Plans for the time asked; with `async=true`, `GET /request/{id}` tells how far it has got."""
    if isinstance(body, str):
        return failed(body)
    settings: Settings = request.app.state.settings
    limit_s = min(body.configuration.timeout or 10.0, settings.max_wait_s)
    work = PlanRequest(
        domain_text=body.domain.content, problem=body.problem.content, time_limit_s=limit_s
    )
    if asynchronous:
        job = await accepted(request, all_requests, work)
    else:
        job = await solved(request, all_requests, work, settings)
    if isinstance(job, str):
        return failed(job)
    response.headers["Location"] = f"/request/{job.id}"
    return progress(job)


@ROUTER.get("/request/{plan_id}")
async def request_progress(request: Request, plan_id: str, all_requests: Requests) -> Json:
    """How far a request sent with `async=true` has got."""
    job = await owned(request, plan_id, all_requests)
    return failed(f"there is no request {plan_id[:64]!r}") if job is None else progress(job)


def failed(message: str) -> Json:
    """A request that gives no plan."""
    return {
        "status": {"status": "FAILED", "error": {"message": message}},
        "output": "",
        "plans": [],
    }


def progress(job: Following) -> Json:
    """A request and its best plan so far."""
    found = result(job)
    if found.plan is None and job.is_over:
        return failed(found.message or f"no plan was found ({found.outcome})") | {
            "requestId": job.id
        }
    status: Json = {"status": "STOPPED" if job.is_over else "SEARCHING_BETTER_PLAN"}
    if found.outcome is not None and "timed_out" in found.outcome:
        status["reason"] = "TIMEOUT"
    plans = []
    if found.plan is not None:
        statistics = found.statistics or {}
        plans.append(
            {
                "makespan": found.plan.makespan,
                "metricValue": found.plan.metric
                if found.plan.metric is not None
                else found.plan.makespan,
                "timeUnit": "SECOND",
                "format": "json",
                "content": json.dumps(json_steps(found.plan)),
                "searchPerformanceInfo": {
                    "statesEvaluated": statistics.get("evaluations", 0),
                    "timeElapsed": round(1000 * (found.plan.wall_s or 0.0)),
                },
            }
        )
    return {"status": status, "output": "", "plans": plans, "requestId": job.id}
