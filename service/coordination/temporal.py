"""Coordination by temporal planning (thesis 3.3): plan all, execute each robot's first action."""

import logging
from collections.abc import Sequence

import planner
from domains import catalogue
from domains.formulation import Assignment, Formulation
from semantic_attachments import bind
from semantic_attachments.contract import Memory
from service.coordination.hungarian import being_cleared, clear_nearest, free
from service.coordination.strategy import NoPlanError, Proposal, Situation, Strategy
from service.coordination.travel import Travel
from service.messages.plan import PlanStep

LOG = logging.getLogger(__name__)


class TemporalPlanning:
    """Plans the whole mission at every event and executes the first action of each robot."""

    def __init__(self, fallback: Strategy) -> None:
        self._fallback = fallback

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        """A validated plan within the budget, or the fallback's one-step assignment."""
        try:
            return self._plan(situation, memory)
        except NoPlanError:
            raise
        except Exception as error:
            # A team in the field is better off with a simple order than with none.
            LOG.exception("the planner failed")
            return self._fall_back(situation, memory, f"the planner failed: {error}")

    def _plan(self, situation: Situation, memory: Memory) -> Proposal:
        formulation = catalogue.load(situation.domain)
        state, planning = situation.state, situation.planning
        world = formulation.world(state, situation.grid, situation.models, situation.version)
        attachments = bind(formulation.attachments, world, memory=memory)
        goals = formulation.attainable(attachments["pathCost"], state)
        unreachable = frozenset(target.id for target in state.targets) - goals
        if not goals:
            raise NoPlanError(f"no robot can reach {_listed(unreachable)}")
        problem = formulation.problem(world, state, sorted(goals))
        result = vars(planner)["solve"](
            formulation.domain_path,
            problem,
            attachments=attachments,
            timeout_s=planning.time_limit_s,
            node_limit=planning.node_limit,
            seed=planning.seed,
        )
        if result.plan is None:
            return self._fall_back(situation, memory, f"the planner says {result.outcome}")
        verdict = planner.validate(
            formulation.domain_path, problem, result.plan, attachments=attachments
        )
        if not verdict.valid:
            return self._fall_back(situation, memory, f"the validator refuses: {verdict}")
        assignments = self._with_idle_clearers(
            situation, memory, formulation.assignments(result.plan, state)
        )
        left_out = f"; out of reach: {_listed(unreachable)}" if unreachable else ""
        return Proposal(
            assignments=tuple(assignments),
            reason=f"a plan of {len(result.plan)} steps and {result.plan.makespan:.1f} s{left_out}",
            steps=_steps(formulation, situation, result.plan),
            validated=True,
            unreachable=unreachable,
        )

    def _fall_back(self, situation: Situation, memory: Memory, why: str) -> Proposal:
        proposal = self._fallback.propose(situation, memory)
        return Proposal(
            assignments=proposal.assignments,
            reason=f"{why}; instead {proposal.reason}",
            steps=proposal.steps,
        )

    @staticmethod
    def _with_idle_clearers(
        situation: Situation, memory: Memory, assignments: Sequence[Assignment]
    ) -> list[Assignment]:
        """A clearer that the plan does not need takes the nearest blockade nobody has taken."""
        busy = {assignment.robot for assignment in assignments}
        idle = [robot for robot in free(situation, "clearer") if robot not in busy]
        blockades = {blockade.id for blockade in situation.state.blockades}
        taken = being_cleared(situation) | {
            assignment.location
            for assignment in assignments
            if assignment.location in blockades and assignment.location is not None
        }
        if not idle or taken >= blockades:
            return list(assignments)
        travel = Travel(situation, memory)
        return [*assignments, *clear_nearest(situation, travel, idle, taken)]


def _steps(
    formulation: Formulation, situation: Situation, plan: planner.Plan
) -> tuple[PlanStep, ...]:
    names = formulation.names(situation.state)
    return tuple(
        PlanStep(
            start_s=situation.state.time_s + step.start,
            action=step.action,
            arguments=[names.id(name) for name in step.arguments],
            duration_s=step.duration,
        )
        for step in plan
    )


def _listed(targets: frozenset[str]) -> str:
    shown = sorted(targets)[:5]
    return ", ".join(shown) + (f" and {len(targets) - 5} more" if len(targets) > 5 else "")
