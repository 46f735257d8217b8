"""Coordination by temporal planning (thesis 3.3): plan all, execute each robot's first action.

The plan in force goes on unless the new one is better by a margin or something has happened that
it does not reckon with: a team that changes its mind at every event gets nowhere. What is urgent
(priorities, deadlines) is planned first where the plan for everything would be too late, and the
rest of the team plans for the rest.
"""

import logging
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite

import planner
from domains import catalogue
from domains.formulation import Assignment, Formulation, Order, OrderKind
from domains.mission_state import Activity, MissionState
from semantic_attachments import bind
from semantic_attachments.contract import Evaluator, Memory
from semantic_attachments.world import World
from service.coordination.one_step_disaster import being_cleared, clear_nearest, free
from service.coordination.plan_progress import Remainder, from_here, remainder
from service.coordination.restricted_costs import RestrictedCosts
from service.coordination.strategy import NoPlanError, Proposal, Situation, Strategy
from service.coordination.travel import Travel
from service.messages.instruction import Deadline, Pin, Priority
from service.messages.plan import PlanStep

LOG = logging.getLogger(__name__)
AT_WORK = (Activity.CLEARING, Activity.DOCKING, Activity.UNDOCKING)
LAG_TOLERATED = 0.1
"""Part of the time left by which a team may be late that goes on without a new search."""
PRIORITY_SLACK = 1.05
"""A plan for everything may visit urgent targets this much later than a plan for them alone."""


class TemporalPlanning:
    """Plans the whole mission at every event and executes the first action of each robot."""

    def __init__(self, fallback: Strategy) -> None:
        self.fallback = fallback

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        """A validated plan within the budget, or the fallback's one-step assignment."""
        try:
            return Planning.of(situation, memory).propose()
        except NoPlanError:
            raise
        except PlanNotFoundError as error:
            return self._fall_back(situation, memory, str(error))
        except Exception as error:
            # A team in the field is better off with a simple order than with none.
            LOG.exception("the planner failed")
            return self._fall_back(situation, memory, f"the planner failed: {error}")

    def _fall_back(self, situation: Situation, memory: Memory, why: str) -> Proposal:
        proposal = self.fallback.propose(situation, memory)
        return replace(proposal, reason=f"{why}; instead {proposal.reason}")


class PlanNotFoundError(Exception):
    """There may be a plan, but the budget was too small to find it."""


@dataclass(frozen=True)
class Planning:
    """One decision."""

    situation: Situation
    memory: Memory
    formulation: Formulation
    domain: planner.Domain
    world: World
    attachments: Mapping[str, Evaluator]

    @classmethod
    def of(cls, situation: Situation, memory: Memory) -> "Planning":
        """Binds the domain's attachments to the situation's world."""
        formulation = catalogue.load(situation.domain)
        # As bytes: a text from a request is never taken for a path.
        text = situation.domain_text
        domain = planner.read_domain(formulation.domain_path if text is None else text.encode())
        state = situation.state
        world = Travel.of(situation, memory).world
        names = formulation.names(state)
        needed = [*formulation.attachments]
        known = {name.lower() for name in needed}
        needed += [module.name for module in domain.modules if module.name.lower() not in known]
        bound: dict[str, Evaluator] = dict(bind(needed, world, memory=memory))
        if situation.avoid:
            pairs = {
                (names.name(robot), names.name(place))
                for robot, place in situation.avoid
                if robot in names and place in names
            }
            bound["pathCost"] = RestrictedCosts(bound["pathCost"], frozenset(pairs))
        return cls(situation, memory, formulation, domain, world, bound)

    def propose(self) -> Proposal:
        """The plan in force if it is as good, a new one otherwise."""
        state = self.situation.state
        goals = self.formulation.attainable(self.attachments["pathCost"], state)
        unreachable = frozenset(target.id for target in state.targets) - goals
        if not goals:
            raise NoPlanError(f"no robot can reach {_listed(unreachable)}")
        if self.situation.hurried and (kept := self._kept(None, goals)) is not None:
            return kept
        plan, how = self._plan(goals)
        kept = self._kept(plan, goals)
        if kept is not None:
            return kept
        assignments = self._with_idle_clearers(self.formulation.assignments(plan, state))
        left_out = f"; out of reach: {_listed(unreachable)}" if unreachable else ""
        return Proposal(
            assignments=tuple(assignments),
            reason=f"{how} of {len(plan)} steps and {plan.makespan:.1f} s{left_out}",
            steps=self._steps(plan),
            validated=True,
            unreachable=unreachable,
            remarks=self._remarks(plan, unreachable),
        )

    # Plans

    def _plan(self, goals: Collection[str]) -> tuple[planner.Plan, str]:
        state = self.situation.state
        everything = self._solve(state, goals)
        urgent = self._urgent(goals)
        if not urgent:
            return everything, "a plan"
        first = self._solve(state, urgent)
        allowed_s = {
            target: min(
                first.makespan * PRIORITY_SLACK,
                self.situation.deadlines_s.get(target, float("inf")) - state.time_s,
            )
            for target in urgent
        }
        arrivals_s = self._visits_s(everything)
        if all(arrivals_s.get(target, float("inf")) <= allowed_s[target] for target in urgent):
            return everything, "a plan"
        return self._with_rest(first, goals, urgent), "a plan for what is urgent first,"

    def _urgent(self, goals: Collection[str]) -> list[str]:
        """The attainable targets of the highest priority; a deadline ranks above all."""
        deadlines = [target for target in self.situation.deadlines_s if target in goals]
        if deadlines:
            return sorted(deadlines)
        priorities = {t: p for t, p in self.situation.priorities.items() if t in goals}
        highest = max(priorities.values(), default=0)
        return sorted(target for target, p in priorities.items() if p == highest)

    def _with_rest(
        self, first: planner.Plan, goals: Collection[str], urgent: Collection[str]
    ) -> planner.Plan:
        """`first`, and beside it a plan of the robots it does not need, if they go together."""
        state = self.situation.state
        names = self.formulation.names(state)
        engaged = {order.robot for step in first for order in self.formulation.orders(step, names)}
        rest_state = replace(
            state,
            robots=tuple(
                replace(robot, activity=Activity.FAILED) if robot.id in engaged else robot
                for robot in state.robots
            ),
        )
        attainable = self.formulation.attainable(self.attachments["pathCost"], rest_state)
        rest = sorted(attainable & set(goals) - set(urgent))
        if not rest:
            return first
        try:
            second = self._solve(rest_state, rest)
        except PlanNotFoundError:
            return first
        both = planner.Plan(tuple(sorted([*first, *second], key=lambda step: step.start)))
        problem = self.formulation.problem(self.world, state, sorted({*urgent, *rest}))
        verdict = planner.validate(self.domain, problem, both, attachments=self.attachments)
        return both if verdict.valid else first

    def _solve(self, state: MissionState, goals: Collection[str]) -> planner.Plan:
        planning = self.situation.planning
        result = planner.solve(
            self.domain,
            self.formulation.problem(self.world, state, sorted(goals)),
            attachments=self.attachments,
            timeout_s=planning.time_limit_s,
            node_limit=planning.node_limit,
            seed=planning.seed,
            warm_start=self._warm_start(),
        )
        if result.plan is None:
            raise PlanNotFoundError(f"planning ended without a plan ({result.outcome})")
        return result.plan

    # The plan in force

    def _warm_start(self) -> planner.Plan | None:
        situation = self.situation
        if not situation.in_force:
            return None
        left = remainder(self.formulation, situation.state, situation.in_force, situation.done)
        return from_here(left, self.formulation, situation.state)

    def _kept(self, plan: planner.Plan | None, goals: Collection[str]) -> Proposal | None:
        """The next orders of the plan in force, if that is nearly as good as `plan`.

        Without a plan to compare with: if it goes on nearly as it was planned.
        """
        situation, state = self.situation, self.situation.state
        if not situation.in_force:
            return None
        left = remainder(self.formulation, state, situation.in_force, situation.done)
        visits = {target for _, target in left.ends_s()}
        if not visits >= set(goals):
            return None
        assignments = left.assignments(self.formulation, state)
        lag_s = self._lag_s(left, assignments)
        if not isfinite(lag_s):
            return None
        left_s = left.plan.makespan + lag_s
        if plan is None:
            if lag_s > left_s * LAG_TOLERATED:
                return None
            compared = "others wait for the planners"
        elif plan.makespan < left_s * (1.0 - situation.planning.margin):
            return None
        else:
            compared = f"a new one would take {plan.makespan:.1f} s"
        return Proposal(
            assignments=tuple(self._with_idle_clearers(assignments)),
            reason=f"the plan in force goes on with {left_s:.1f} s left, {compared}",
            keeps_plan=True,
            remarks=self._remarks(left.plan, frozenset(), left),
        )

    def _lag_s(self, left: Remainder, assignments: Sequence[Assignment]) -> float:
        """By how much the team is behind the plan [s]; infinite if it can no longer be carried out.

        A robot on its way is late by the time it still needs; whatever has not begun is late
        since it should have.
        """
        travel = Travel.of(self.situation, self.memory)
        state = self.situation.state
        busy_until_s = {
            robot.id: robot.free_at_s - state.time_s
            for robot in state.robots
            if robot.activity in AT_WORK
        }
        driving = {
            assignment.robot: assignment.location
            for assignment in assignments
            if assignment.kind in (OrderKind.MOVE, OrderKind.EXPLORE)
        }
        if not busy_until_s and not any(a.kind is not OrderKind.WAIT for a in assignments):
            return float("inf")
        lag_s = 0.0
        for step, orders in left.orders:
            robot, location = orders[0].robot, orders[0].location
            if robot in busy_until_s:
                lag_s = max(lag_s, busy_until_s.pop(robot) - step.end)
            elif driving.get(robot) == location:
                del driving[robot]
                if location not in travel.names:
                    return float("inf")
                lag_s = max(lag_s, travel.times_s([robot], [location])[0][0] - step.end)
            else:
                lag_s = max(lag_s, -step.start, self._detour_s(travel, left, step, orders[0]))
        return lag_s

    @staticmethod
    def _detour_s(travel: Travel, left: Remainder, step: planner.Step, order: Order) -> float:
        """By how much a later movement takes longer than planned, because of a new blockade [s]."""
        if order.kind not in (OrderKind.MOVE, OrderKind.EXPLORE):
            return 0.0
        start = left.names.id(step.arguments[1])
        if start not in travel.names or order.location not in travel.names:
            return 0.0  # it starts where somebody has been: its robot is there, or on its way
        (time_s,) = travel.times_between_s(order.robot, [start], order.location)
        return time_s - (step.duration or 0.0)

    # What is told

    def _with_idle_clearers(self, assignments: Sequence[Assignment]) -> list[Assignment]:
        """A clearer that the plan does not need takes the nearest blockade nobody has taken."""
        situation = self.situation
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
        travel = Travel.of(situation, self.memory)
        return [*assignments, *clear_nearest(situation, travel, idle, taken)]

    def _steps(self, plan: planner.Plan) -> tuple[PlanStep, ...]:
        names = self.formulation.names(self.situation.state)
        return tuple(
            PlanStep(
                start_s=self.situation.state.time_s + step.start,
                action=step.action,
                arguments=[names.id(name) for name in step.arguments],
                duration_s=step.duration,
            )
            for step in plan
        )

    def _visits_s(self, plan: planner.Plan) -> dict[str, float]:
        """When each target is visited, from now [s]."""
        names = self.formulation.names(self.situation.state)
        return {
            order.location: step.end
            for step in plan
            for order in self.formulation.orders(step, names)
            if order.kind is OrderKind.EXPLORE
        }

    def _remarks(
        self, plan: planner.Plan, unreachable: frozenset[str], left: Remainder | None = None
    ) -> dict[str, str]:
        """Why instructions cannot be obeyed, by their ids."""
        now_s = self.situation.state.time_s
        if left is None:
            visits_s = self._visits_s(plan)
        else:
            visits_s = {target: end_s for (_, target), end_s in left.ends_s().items()}
        remarks = {}
        for identifier, instruction in self.situation.instructions:
            match instruction:
                case Pin(robot=robot, location=location) if location in unreachable:
                    remarks[identifier] = f"{robot} cannot reach {location}, as far as is known"
                case Deadline(target=target) | Priority(target=target) if target in unreachable:
                    remarks[identifier] = f"no robot can reach {target}, as far as is known"
                case Deadline(target=target, time_s=time_s) if (
                    target in visits_s and now_s + visits_s[target] > time_s
                ):
                    remarks[identifier] = (
                        f"the earliest visit found is at {now_s + visits_s[target]:.1f} s"
                    )
        return remarks


def _listed(targets: frozenset[str]) -> str:
    shown = sorted(targets)[:5]
    return ", ".join(shown) + (f" and {len(targets) - 5} more" if len(targets) > 5 else "")
