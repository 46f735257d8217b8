"""A planning request as a worker process sees it, and what the worker tells.

Everything here is plain and picklable. Texts are handed to the reader as bytes, so that nothing
in a request is ever taken for the path of a file.
"""

from dataclasses import dataclass
from typing import Any

from semantic_attachments.contract import Memory
from service.jobs.executor import Tell

GRACE_S = 2.0
"""Time above a request's own limit after which its worker is killed."""


@dataclass(frozen=True)
class PlanningWork:
    """A problem to solve."""

    domain: bytes
    problem: bytes
    time_limit_s: float
    seed: int = 0
    node_limit: int | None = None
    memory_limit_mb: int = 1024
    first_plan_only: bool = False
    map: dict[str, Any] | None = None
    """The map in the protocol's encoding, for domains with modules."""
    robot_types: dict[str, dict[str, Any]] | None = None
    affinity: str | None = None
    traceparent: str | None = None
    """The span that asks for it."""

    @property
    def hard_limit_s(self) -> float:
        """Wall-clock time after which its worker is killed."""
        return self.time_limit_s + GRACE_S

    def answer(self, tell: Tell, _: Memory) -> None:
        """Solves, with every fault told as the request's end."""
        import planner
        from semantic_attachments import BindingError, EvaluationError

        try:
            solve(self, tell)
        except planner.PlannerError as error:
            tell({"kind": "failed", "outcome": str(error.outcome), "message": str(error)})
        except (BindingError, EvaluationError, ValueError) as error:
            tell({"kind": "failed", "outcome": "input_error", "message": str(error)})
        except MemoryError:
            tell({"kind": "failed", "outcome": "out_of_memory", "message": "out of memory"})


def solve(work: PlanningWork, tell: Tell) -> None:
    """Solves and tells every improving plan, then how it ended."""
    import planner
    from semantic_attachments import bind
    from semantic_attachments.problem_world import world_of_problem
    from semantic_attachments.world import GridMap, RobotModel

    domain = planner.read_domain(work.domain)
    problem = planner.read_problem(domain, work.problem)
    attachments: dict[str, Any] = {}
    if work.map is not None and domain.modules:
        models = {
            name: RobotModel.from_json(name, kind)
            for name, kind in (work.robot_types or {}).items()
        }
        world = world_of_problem(problem, GridMap.from_json(work.map), models)
        attachments = dict(bind(domain, world))

    def tell_plan(plan: planner.Plan) -> None:
        # `solve` hands out plans that the validator, which shares no code with it, has accepted.
        tell({"kind": "plan", **plan.to_json(), "text": plan.to_text()})

    result = planner.solve(
        domain,
        problem,
        attachments=attachments,
        timeout_s=work.time_limit_s,
        seed=work.seed,
        node_limit=work.node_limit,
        memory_limit_mb=work.memory_limit_mb,
        first_plan_only=work.first_plan_only,
        on_plan=tell_plan,
    )
    statistics = result.statistics
    tell(
        {
            "kind": "finished",
            "outcome": str(result.outcome),
            "lower_bound": result.lower_bound,
            "gap": result.gap,
            "statistics": {
                "expansions": statistics.expansions,
                "evaluations": statistics.evaluations,
                "schedules": statistics.schedules,
                "operators": statistics.operators,
                "facts": statistics.facts,
                "grounding_s": statistics.grounding_s,
                "wall_s": statistics.wall_s,
            },
        }
    )
