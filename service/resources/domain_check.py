"""What an uploaded domain must hold: it reads, and missions can be formulated with it.

The text is handed to the reader as bytes: nothing in it is ever taken for a path, and the modules
it names are looked up among the installed attachments, never imported.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import planner
from domains import catalogue
from domains.formulation import Formulation
from domains.mission_state import BlockadeState, MeetingPoint, MissionState, RobotState, Target
from planner import _core
from planner.language_server.providers import providers_for
from semantic_attachments import BindingError, bind
from semantic_attachments.world import GridMap, RobotModel
from service.problem_details import Diagnostic, ProblemError, invalid
from service.store.resource_store import Content

TRIAL_S = 2.0
"""Time for the trial mission; its plan takes milliseconds."""


@dataclass(frozen=True)
class CheckedDomain:
    """A domain that the service can use."""

    content: Content
    domain: planner.Domain
    diagnostics: Sequence[Diagnostic]
    """Warnings."""


def version_of(text: str, formulation: str | None) -> str:
    """Hash of a domain's content."""
    return hashlib.blake2b(f"{formulation or ''}\0{text}".encode(), digest_size=16).hexdigest()


def checked_domain(text: str, formulation: str | None, max_bytes: int) -> CheckedDomain:
    """Reads a domain and tries it out.

    Raises:
        ProblemError: 422 with every finding.
    """
    raw = text.encode()
    if len(raw) > max_bytes:
        raise invalid([("/text", f"is longer than the {max_bytes} bytes this server accepts")])
    findings = domain_findings(raw)
    errors = [found for found in findings if found.severity == "error"]
    if errors:
        problem = invalid([("/text", f"{d.line}:{d.column}: {d.message}") for d in errors])
        problem.diagnostics = findings
        raise problem
    domain = planner.read_domain(raw)
    if formulation is not None:
        _try_out(domain, formulation)
    content = Content(version_of(text, formulation), text, formulation)
    return CheckedDomain(content, domain, findings)


def domain_findings(text: bytes) -> list[Diagnostic]:
    """Errors and warnings in a domain."""
    (found, *_) = _core.check_files(("domain.pddl", text), [], providers_for(text).names)
    return [
        Diagnostic(
            location="/text",
            line=one.range[0] + 1,
            column=one.range[1] + 1,
            end_line=one.range[2] + 1,
            end_column=one.range[3] + 1,
            severity=one.severity,
            code=one.code,
            message=one.message,
            remedy=one.remedy,
            rendered=one.rendered,
        )
        for one in found
    ]


def _try_out(domain: planner.Domain, name: str) -> None:
    """Poses a small mission, plans it, and reads the plan's steps as orders."""
    try:
        formulation = catalogue.load(name)
    except catalogue.UnknownDomainError as error:
        raise invalid([("/formulation", str(error))]) from None
    built_in = planner.read_domain(formulation.domain_path)
    strange = sorted(set(domain.actions) - set(built_in.actions))
    if strange:
        raise _unfit(name, f"it does not know what the action {strange[0]!r} means for a robot")
    state = trial_mission(built_in)
    grid = GridMap(cells=np.zeros((12, 12), dtype=np.int8), resolution_m=1.0)
    models = {
        robot.type: RobotModel(robot.type, 0.3, 1.0, capacity=state.capacities.get(robot.id, 0))
        for robot in state.robots
    }
    world = formulation.world(state, grid, models)
    try:
        problem = planner.read_problem(domain, formulation.problem(world, state).encode())
        attachments = dict(bind([module.name for module in domain.modules], world))
        result = planner.solve(
            domain, problem, attachments=attachments, timeout_s=TRIAL_S, first_plan_only=True
        )
    except planner.PddlError as error:
        first = error.diagnostics[0]
        raise _unfit(name, f"a problem it writes cannot be read: {first.message}") from None
    except (planner.PlannerError, BindingError) as error:
        raise _unfit(name, f"a trial mission cannot be planned: {error}") from None
    if result.plan is None:
        raise _unfit(name, f"a trial mission has no plan ({result.outcome})")
    _read_back(formulation, result.plan, state)


def _read_back(formulation: Formulation, plan: planner.Plan, state: MissionState) -> None:
    names = formulation.names(state)
    try:
        for step in plan:
            formulation.orders(step, names)
        formulation.assignments(plan, state)
    except (ValueError, KeyError, IndexError) as error:
        raise _unfit(
            formulation.name, f"a plan of a trial mission cannot be read: {error}"
        ) from None


def _unfit(name: str, why: str) -> ProblemError:
    return invalid(
        [
            (
                "/formulation",
                f"the domain does not go with the formulation {name!r}: {why}; mend the text, or "
                "leave the formulation out and use the domain for planning requests only",
            )
        ]
    )


def robot_types(domain: planner.Domain) -> list[str]:
    """The types of robots in a domain: the leaves below `robot`."""
    below = {"robot"}
    while True:
        more = {name for name, parents in domain.types.items() if below & set(parents)} - below
        if not more:
            break
        below |= more
    inner = {parent for name in below for parent in domain.types.get(name, [])}
    return sorted(below - inner)


def trial_mission(domain: planner.Domain) -> MissionState:
    """A robot of each type and one of everything else, in a hall without walls."""
    types = robot_types(domain)
    robots = tuple(
        RobotState(f"{name}-1", name, (1.5 + index, 1.5)) for index, name in enumerate(types)
    )
    return MissionState(
        time_s=0.0,
        robots=robots,
        targets=(Target("target-1", (9.5, 9.5)),),
        blockades=(BlockadeState("blockade-1", ((5.0, 5.0), (5.0, 6.0)), 5.0),)
        if "blockade" in domain.types
        else (),
        meeting_points=(MeetingPoint("meeting-1", (5.5, 8.5)),)
        if "meeting" in domain.types
        else (),
        capacities={robot.id: 1 for robot in robots if robot.type == "carrier"},
    )
