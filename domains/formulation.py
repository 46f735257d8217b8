"""What every domain's formulation does: mission state -> world and problem; plan -> orders for
robots.

The loop is that of figure 3.2 of Wurm's thesis: the state of robots and world becomes a PDDL
problem, and of the plan only
the first action of each robot is executed before the next problem is posed.
"""

from abc import ABC, abstractmethod
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from math import isfinite
from pathlib import Path

from domains.mission_state import Activity, MeetingPoint, MissionState, RobotState, Target
from domains.naming import Names
from domains.pddl_text import ProblemText
from planner import Plan, Step
from semantic_attachments.world import Blockade, GridMap, Location, RobotModel, World

PathCost = Callable[[str, str, str], float]
"""(robot, from, to) -> seconds, all PDDL names; infinite where there is no way."""


def asked(
    cost: PathCost, calls: Sequence[tuple[str, str, str]]
) -> dict[tuple[str, str, str], float]:
    """The travel times [s] of some (robot, from, to), all PDDL names; asked at once."""
    many = getattr(cost, "many", None)
    times_s = [cost(*call) for call in calls] if many is None else many(calls)
    return dict(zip(calls, times_s, strict=True))


def reachable(cost: PathCost, robot: str, starts: Iterable[str], goals: Iterable[str]) -> set[str]:
    """The goals that a robot can reach from one of the starts, all PDDL names; asked at once."""
    calls = [(robot, start, goal) for goal in goals for start in starts]
    if not calls:
        return set()
    return {call[2] for call, time_s in asked(cost, calls).items() if isfinite(time_s)}


class OrderKind(StrEnum):
    """What a robot is told to do."""

    MOVE = "move"
    EXPLORE = "explore"
    CLEAR = "clear"
    DOCK = "dock"
    UNDOCK = "undock"
    WAIT = "wait"


@dataclass(frozen=True, slots=True)
class Assignment:
    """The next thing a robot does according to a plan; ids are the mission's."""

    robot: str
    kind: OrderKind
    location: str | None = None
    """Where: a target, blockade or meeting point."""
    partner: str | None = None
    """The other robot of docking and undocking."""
    expected_duration_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Order:
    """How one step of a plan reads as an order for one of the robots that take part in it."""

    robot: str
    kind: OrderKind
    location: str
    partner: str | None = None


def place_of(robot: str) -> str:
    """The id of the place where a robot is now, a location of its own."""
    return f"{robot} place"


@lru_cache(maxsize=64)
def _names_of(ids: tuple[str, ...]) -> Names:
    """Asked for many times a decision, always by the same ids."""
    return Names(ids)


class Formulation(ABC):
    """A domain's view of a mission.

    Subclasses say which modules the domain calls, how a state reads as facts and goals, and how a
    plan's
    step reads as orders.
    """

    wait_margin_s = 0.5
    """A step that starts later than this waits for another robot; its robot waits too."""

    def __init__(self, folder: Path, attachments: Sequence[str]) -> None:
        self.name = folder.name
        self.domain_path = folder / "domain.pddl"
        self.attachments = tuple(attachments)

    @abstractmethod
    def write(
        self, text: ProblemText, world: World, state: MissionState, goals: Iterable[str]
    ) -> None:
        """Adds objects, facts and goals of `state`; `goals` are the ids of the targets to visit."""

    @abstractmethod
    def orders(self, step: Step, names: Names) -> Sequence[Order]:
        """The orders that a step means, one for each robot taking part."""

    def departing(
        self, action: str, ids: tuple[str, ...], robot: RobotState, state: MissionState
    ) -> Sequence[tuple[str, tuple[str, ...]]]:
        """A step of an older plan as its robot, which is somewhere else now, would begin it.

        Actions and ids of their arguments; more than one if it has to get there first. A step that
        does not depend on where its robot is stays as it is.
        """
        del robot, state
        return [(action, ids)]

    def standing(self, robot: RobotState, state: MissionState) -> str:
        """Id of the place that a free robot begins its first step from."""
        del state
        return place_of(robot.id)

    def visit(self, robot: str, start: str, target: str) -> tuple[str, tuple[str, ...]] | None:
        """Action and arguments, as ids, of a robot that goes from a place to visit a target.

        None where that depends on more than the places.
        """
        del robot, start, target
        return None

    def worthwhile(self, cost: PathCost, state: MissionState) -> tuple[MeetingPoint, ...]:
        """The meeting points that a plan could need; the fewer, the smaller the problem."""
        del cost
        return state.meeting_points

    @abstractmethod
    def attainable(self, world: World, cost: PathCost, state: MissionState) -> frozenset[str]:
        """Ids of the targets that the team can visit, as far as is known (delete relaxation)."""

    @staticmethod
    def names(state: MissionState) -> Names:
        """PDDL names of everything in a state, the same for the same state."""
        return _names_of(
            (
                *(robot.id for robot in state.robots),
                *(target.id for target in state.targets),
                *(blockade.id for blockade in state.blockades),
                *(meeting.id for meeting in state.meeting_points),
                *(place_of(robot.id) for robot in state.robots),
            )
        )

    def world(
        self,
        state: MissionState,
        grid: GridMap,
        models: Mapping[str, RobotModel],
        version: int = 0,
    ) -> World:
        """The frozen world that the attachments see, keyed by PDDL names.

        Args:
            grid: the map as known, without blockades.
            models: robot model of each robot type.
        """
        names = self.names(state)
        locations = {
            names.name(place_of(robot.id)): Location(position_m=robot.position_m)
            for robot in state.robots
        }
        places: tuple[Target | MeetingPoint, ...] = (*state.targets, *state.meeting_points)
        for place in places:
            locations[names.name(place.id)] = Location(
                place.position_m, unknown_m2=getattr(place, "unknown_m2", 0.0)
            )
        blockades = {}
        for blockade in state.blockades:
            name = names.name(blockade.id)
            locations[name] = Location(position_m=blockade.centre_m, blockade=name)
            blockades[name] = Blockade(
                id=name,
                segment_m=blockade.segment_m,
                clear_duration_s=blockade.clear_duration_s,
            )
        return World(
            grid=grid,
            locations=locations,
            robots={names.name(robot.id): models[robot.type] for robot in state.robots},
            blockades=blockades,
            version=version,
        )

    def problem(
        self,
        world: World,
        state: MissionState,
        goals: Iterable[str] | None = None,
        name: str = "mission",
    ) -> str:
        """PDDL text of the problem a state poses.

        Args:
            goals: ids of the targets to visit; all of them if not given.
            name: the problem's name.
        """
        text = ProblemText(name=name, domain=self.name, names=self.names(state))
        self.write(text, world, state, [t.id for t in state.targets] if goals is None else goals)
        return text.render()

    def assignments(
        self, plan: Plan, state: MissionState, names: Names | None = None
    ) -> tuple[Assignment, ...]:
        """What each free robot does first; a robot without a step in the plan gets none.

        A movement to where the robot has just arrived is skipped. A step that has to wait for
        somebody else makes its robot wait at its place.

        Args:
            names: the plan's names, if they are not those of `state` because it is an older plan.
        """
        agenda = self._agenda(plan, names or self.names(state))
        return tuple(
            self._first(robot, agenda[robot.id])
            for robot in state.robots
            if agenda[robot.id] and robot.activity in (Activity.FREE, Activity.DOCKED)
        )

    def following(
        self, plan: Plan, state: MissionState, names: Names | None = None
    ) -> dict[str, tuple[Assignment, ...]]:
        """What each free robot does after its first step, up to where it waits for somebody else.

        For robots that cannot be told what to do next. Who docks or undocks waits for the other
        one at that place, so that ends nothing.

        Args:
            names: as for `assignments`.
        """
        agenda = self._agenda(plan, names or self.names(state))
        return {
            robot.id: self._after_first(robot, agenda[robot.id])
            for robot in state.robots
            if agenda[robot.id] and robot.activity in (Activity.FREE, Activity.DOCKED)
        }

    def _after_first(
        self, robot: RobotState, agenda: Sequence[tuple[Step, Order]]
    ) -> tuple[Assignment, ...]:
        if self._first(robot, agenda).kind is OrderKind.WAIT:
            return ()
        first = next(
            index
            for index, (_, order) in enumerate(agenda)
            if order.kind is not OrderKind.MOVE or order.location != robot.arrived_at
        )
        after: list[Assignment] = []
        free_s = agenda[first][0].end
        for step, order in agenda[first + 1 :]:
            meets = order.kind in (OrderKind.DOCK, OrderKind.UNDOCK)
            if step.start > free_s + self.wait_margin_s and not meets:
                break
            after.append(
                Assignment(
                    robot.id, order.kind, order.location, order.partner, step.duration or 0.0
                )
            )
            free_s = step.end
        return tuple(after)

    def _agenda(self, plan: Plan, names: Names) -> dict[str, list[tuple[Step, Order]]]:
        agenda: dict[str, list[tuple[Step, Order]]] = defaultdict(list)
        for step in sorted(plan, key=lambda step: step.start):
            for order in self.orders(step, names):
                agenda[order.robot].append((step, order))
        return agenda

    def _first(self, robot: RobotState, agenda: Sequence[tuple[Step, Order]]) -> Assignment:
        begun_s = 0.0
        for step, order in agenda:
            if order.kind is OrderKind.MOVE and order.location == robot.arrived_at:
                # In an older plan the movement may lie in the past: now is the earliest.
                begun_s = max(0.0, step.start + (step.duration or 0.0))
                continue
            kind = order.kind if step.start <= begun_s + self.wait_margin_s else OrderKind.WAIT
            return Assignment(
                robot=robot.id,
                kind=kind,
                location=order.location,
                partner=order.partner,
                expected_duration_s=step.duration or 0.0,
            )
        return Assignment(robot=robot.id, kind=OrderKind.WAIT, location=robot.arrived_at)
