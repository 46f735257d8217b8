"""Coordination by temporal planning (thesis 3.3): plan all, execute each robot's first action.

The plan in force goes on unless the new one is better by a margin or something has happened that
it does not reckon with: a team that changes its mind at every event gets nowhere. What is urgent
(priorities, deadlines) is planned first where the plan for everything would be too late, and the
rest of the team plans for the rest.
"""

import logging
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite

import planner
from domains import catalogue
from domains.formulation import Formulation, OrderKind
from domains.mission_state import Activity, MissionState
from semantic_attachments import bind
from semantic_attachments.contract import Evaluator, Memory
from semantic_attachments.world import World
from service.coordination.exploration.horizon import within_horizon
from service.coordination.follow_ups import follow_ups
from service.coordination.idle_robots import with_idle_robots
from service.coordination.plan_choice import PROMPTNESS, steadiest
from service.coordination.plan_lag import behind_s
from service.coordination.plan_progress import Remainder, from_here, remainder
from service.coordination.plan_revision import Revision, revised, with_new_targets, without_visits
from service.coordination.remarks import remarks
from service.coordination.restricted_costs import RestrictedCosts
from service.coordination.strategy import NoPlanError, Proposal, Situation, Strategy
from service.coordination.travel import Travel
from service.coordination.urgency import Lateness, is_urgent, lateness, urgent
from service.messages.plan import PlanStep

LOG = logging.getLogger(__name__)
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
class Wanted:
    """What priorities and deadlines ask of a plan; times count from now."""

    deadlines_s: Mapping[str, float]
    soonest_s: Mapping[str, float]
    """When targets of the highest priority can be visited if they are all that counts."""
    first: Sequence[Sequence[str]]
    """Sets of targets to plan for before the others, the most wanted first."""

    def lateness(self, visits_s: Mapping[str, float]) -> Lateness:
        """How badly visits obey."""
        return lateness(visits_s, self.deadlines_s, self.soonest_s)


@dataclass(frozen=True)
class Planning:
    """One decision."""

    situation: Situation
    memory: Memory
    formulation: Formulation
    domain: planner.Domain
    world: World
    attachments: Mapping[str, Evaluator]
    state: MissionState
    """The situation's, with the meeting points that a plan could need."""
    revision: Revision
    """The plan in force, with targets that are there."""

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
            for name in ("pathCost", "exploreCost"):
                if name in bound:
                    bound[name] = RestrictedCosts(bound[name], frozenset(pairs))
        places = formulation.worthwhile(bound["pathCost"], state)
        fewer = replace(state, meeting_points=places)
        if formulation.names(fewer).agree_with(names):
            state = fewer
        revision = Revision(situation.in_force)
        if situation.explores_with_carriers:
            reached = {command.location or "" for command in situation.done}
            revision = revised(situation.in_force, reached, state, situation.target_places_m)
        return cls(situation, memory, formulation, domain, world, bound, state, revision)

    def propose(self) -> Proposal:
        """The plan in force if it is as good, a new one otherwise."""
        state = self.state
        attainable = self._attainable(state)
        unreachable = frozenset(target.id for target in state.targets) - attainable
        explores = self.situation.explores_with_carriers
        if not attainable and explores:
            # Somebody may get near enough to see what is there.
            raise PlanNotFoundError(f"no robot can enter {_listed(unreachable)}")
        if not attainable:
            raise NoPlanError(f"no robot can reach {_listed(unreachable)}")
        goals = attainable
        if explores:
            goals = within_horizon(self.situation, attainable, self.memory)
        goes_on = self.situation.hurried or (explores and self.situation.only_map_changed)
        if goes_on and (kept := self._kept(None, goals)) is not None:
            return kept
        plan, how = self._plan(goals)
        # A team that explores has compared plans that keep robots on their ways with the others.
        if not explores and (kept := self._kept(plan, goals)) is not None:
            return kept
        assignments = with_idle_robots(
            self.formulation.assignments(plan, state), self.situation, self.memory
        )
        left_out = f"; out of reach: {_listed(unreachable)}" if unreachable else ""
        return Proposal(
            assignments=tuple(assignments),
            then=follow_ups(self.situation, self.formulation, plan, assignments),
            reason=f"{how} of {len(plan)} steps and {plan.makespan:.1f} s{left_out}",
            steps=self._steps(plan),
            validated=True,
            unreachable=unreachable,
            remarks=self._remarks(plan, unreachable),
        )

    def _attainable(self, state: MissionState) -> frozenset[str]:
        return self.formulation.attainable(self.world, self.attachments["pathCost"], state)

    # Plans

    def _plan(self, goals: Collection[str]) -> tuple[planner.Plan, str]:
        """A plan for everything, unless one that begins with what is urgent obeys people better."""
        state = self.state
        everything = self._solve(state, goals)
        if not is_urgent(self.situation, goals):
            return everything, "a plan"
        wanted = self._wanted(goals)
        best, how = everything, "a plan"
        least = wanted.lateness(self._expected_s(everything))
        for chosen in wanted.first:
            if least == Lateness(0, 0.0, 0.0):
                break
            try:
                plan = self._with_rest(self._solve(state, chosen), goals, chosen)
            except PlanNotFoundError:
                continue
            late = wanted.lateness(self._expected_s(plan))
            if late < least:
                best, how, least = plan, "a plan for what is urgent first,", late
        return best, how

    def _wanted(self, goals: Collection[str]) -> "Wanted":
        """What people want of these targets, and what could be planned first to give it to them."""
        situation = self.situation
        by_time, top = urgent(situation, goals)
        deadlines_s = {t: situation.deadlines_s[t] - situation.state.time_s for t in by_time}
        soonest_s = {}
        if top:
            alone_s = self._visits_s(self._solve(self.state, top))
            soonest_s = dict.fromkeys(top, max(alone_s.values(), default=0.0) * PRIORITY_SLACK)
        first = [sorted({*by_time, *top}), by_time, by_time[:1], top]
        distinct = [part for index, part in enumerate(first) if part and part not in first[:index]]
        return Wanted(deadlines_s, soonest_s, distinct)

    def _with_rest(
        self, first: planner.Plan, goals: Collection[str], urgent: Collection[str]
    ) -> planner.Plan:
        """`first`, and beside it a plan of the robots it does not need, if they go together."""
        state = self.state
        names = self.formulation.names(state)
        engaged = {order.robot for step in first for order in self.formulation.orders(step, names)}
        rest_state = replace(
            state,
            robots=tuple(
                replace(robot, activity=Activity.FAILED) if robot.id in engaged else robot
                for robot in state.robots
            ),
        )
        rest = sorted(self._attainable(rest_state) & set(goals) - set(urgent))
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
        if self.situation.explores_with_carriers:
            state = self._narrowed(state, goals)
        result = planner.solve(
            self.domain,
            self.formulation.problem(self.world, state, sorted(goals)),
            attachments=self.attachments,
            timeout_s=planning.time_limit_s,
            node_limit=planning.node_limit,
            seed=planning.seed,
            warm_start=self._warm_start(state, goals),
            promptness=PROMPTNESS if self.situation.explores_with_carriers else 0.0,
        )
        if result.plan is None:
            raise PlanNotFoundError(f"planning ended without a plan ({result.outcome})")
        if not self.situation.explores_with_carriers:
            return result.plan
        going = {
            robot: self.revision.successors.get(place, place)
            for robot, place in self.situation.going.items()
            if place not in self.revision.gone
        }
        return steadiest(result.plans, going, self.formulation, state)

    def _narrowed(self, state: MissionState, goals: Collection[str]) -> MissionState:
        """Only what plans for these targets can need."""
        near = replace(state, targets=tuple(t for t in state.targets if t.id in goals))
        places = self.formulation.worthwhile(self.attachments["pathCost"], near)
        near = replace(near, meeting_points=places)
        names = self.formulation.names
        return near if names(near).agree_with(names(self.state)) else state

    # The plan in force

    def _warm_start(self, state: MissionState, goals: Collection[str]) -> planner.Plan | None:
        steps = self.revision.steps
        if not steps:
            return None
        explores = self.situation.explores_with_carriers
        if explores:
            steps = without_visits(steps, {target.id for target in self.state.targets} - {*goals})
        left = remainder(self.formulation, state, steps, self.situation.done)
        plan = from_here(left, self.formulation, state)
        if not explores:
            return plan
        cost = self.attachments["pathCost"]
        return with_new_targets(plan, goals, state, self.formulation, cost)

    def _kept(self, plan: planner.Plan | None, goals: Collection[str]) -> Proposal | None:
        """The next orders of the plan in force, if that is nearly as good as `plan`.

        Without a plan to compare with: if it goes on nearly as it was planned.
        """
        situation, state = self.situation, self.state
        if not situation.in_force or self.revision.gone or self.revision.successors:
            return None
        left = remainder(self.formulation, state, situation.in_force, situation.done)
        visits = {target for _, target in left.ends_s()}
        if not visits >= set(goals):
            return None
        assignments = left.assignments(self.formulation, state)
        lag_s = behind_s(left, assignments, situation, Travel.of(situation, self.memory))
        if not isfinite(lag_s):
            return None
        left_s = left.plan.makespan + lag_s
        if plan is None:
            good_enough = lag_s <= left_s * LAG_TOLERATED
            compared = "others wait for the planners"
            if situation.only_map_changed:
                compared = "the map shows nothing new to go to"
        else:
            good_enough = plan.makespan >= left_s * (1.0 - situation.planning.margin)
            good_enough &= not self._obeys_better(plan, left, lag_s)
            compared = f"a new one would take {plan.makespan:.1f} s"
        if not good_enough:
            return None
        assignments = tuple(with_idle_robots(assignments, situation, self.memory))
        return Proposal(
            assignments=assignments,
            then=follow_ups(situation, self.formulation, left.plan, assignments, left.names),
            reason=f"the plan in force goes on with {left_s:.1f} s left, {compared}",
            keeps_plan=True,
            remarks=self._remarks(left.plan, frozenset(), left),
        )

    def _obeys_better(self, plan: planner.Plan, left: Remainder, lag_s: float) -> bool:
        """Whether a new plan meets deadlines that the plan in force would miss."""
        now_s = self.situation.state.time_s
        deadlines_s = {t: time_s - now_s for t, time_s in self.situation.deadlines_s.items()}
        kept_s = {target: end_s + lag_s for target, end_s in _visits_left_s(left).items()}
        new = lateness(self._visits_s(plan), deadlines_s, {})
        return new.deadlines_missed < lateness(kept_s, deadlines_s, {}).deadlines_missed

    # What is told

    def _steps(self, plan: planner.Plan) -> tuple[PlanStep, ...]:
        names = self.formulation.names(self.state)
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
        names = self.formulation.names(self.state)
        return {
            order.location: step.end
            for step in plan
            for order in self.formulation.orders(step, names)
            if order.kind is OrderKind.EXPLORE
        }

    def _expected_s(self, plan: planner.Plan) -> dict[str, float]:
        """When targets are visited, from now [s]; urgent ones that are left for later also.

        At the soonest a robot that explores goes there after the last thing it has to do.
        """
        visits_s = self._visits_s(plan)
        later = sorted({*self.situation.deadlines_s, *self.situation.priorities} - visits_s.keys())
        if not later:
            return visits_s
        state = self.state
        names, travel = self.formulation.names(state), Travel.of(self.situation, self.memory)
        last: dict[str, tuple[float, str]] = {}
        explores: set[str] = set()
        for step in sorted(plan, key=lambda step: step.end):
            for order in self.formulation.orders(step, names):
                last[order.robot] = (step.end, order.location)
                if order.kind is OrderKind.EXPLORE:
                    explores.add(order.robot)
        for target in later:
            times_s = [
                last[robot][0] + travel.times_between_s(robot, [last[robot][1]], target)[0]
                for robot in sorted(explores)
            ]
            if (soonest_s := min(times_s, default=inf)) < inf:
                visits_s[target] = soonest_s
        return visits_s

    def _remarks(
        self, plan: planner.Plan, unreachable: frozenset[str], left: Remainder | None = None
    ) -> dict[str, str]:
        """Why instructions cannot be obeyed, by their ids."""
        visits_s = self._expected_s(plan) if left is None else _visits_left_s(left)
        return remarks(self.situation, visits_s, unreachable)


def _visits_left_s(left: Remainder) -> dict[str, float]:
    return {target: end_s for (_, target), end_s in left.ends_s().items()}


def _listed(targets: frozenset[str]) -> str:
    shown = sorted(targets)[:5]
    return ", ".join(shown) + (f" and {len(targets) - 5} more" if len(targets) > 5 else "")
