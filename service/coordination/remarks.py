"""Why the orders in force do not do what people have said (thesis 7.2.1)."""

from collections.abc import Collection, Iterator, Mapping
from math import inf

from domains.mission_state import Activity
from service.coordination.strategy import Situation
from service.messages.instruction import Deadline, Forbid, Instruction, Pin, Priority, TakeOver


def remarks(
    situation: Situation, visits_s: Mapping[str, float], unreachable: Collection[str]
) -> dict[str, str]:
    """A sentence for each instruction that is not obeyed, by its id.

    Args:
        visits_s: when targets are visited as things are planned, from now.
        unreachable: targets that nobody can visit, as far as is known.
    """
    told = {}
    for identifier, instruction in situation.instructions:
        reason = next(_reasons(situation, instruction, visits_s, unreachable), "")
        if reason:
            told[identifier] = reason
    return told


def remarks_without_plan(situation: Situation, why: str) -> dict[str, str]:
    """What is said where nothing at all can be planned."""
    told = remarks(situation, {}, ())
    for identifier, instruction in situation.instructions:
        if not isinstance(instruction, Forbid | TakeOver) and _is_open(situation, instruction):
            told[identifier] = f"nothing can be planned: {why}"
    return told


def _reasons(
    situation: Situation,
    instruction: Instruction,
    visits_s: Mapping[str, float],
    unreachable: Collection[str],
) -> Iterator[str]:
    if not _is_open(situation, instruction):
        return
    match instruction:
        case Pin():
            yield from _pin(situation, instruction, unreachable)
        case Forbid(robot=robot, location=location):
            for one in situation.state.robots:
                if (
                    one.id == robot
                    and one.activity is Activity.CLEARING
                    and one.partner == location
                ):
                    yield f"{robot} is at work there until {one.free_at_s:.0f} s"
        case Deadline(target=target, time_s=time_s):
            yield from _deadline(situation, target, time_s, visits_s, unreachable)
        case Priority(target=target):
            if target in unreachable:
                yield f"no robot can reach {target}, as far as is known"
            elif target not in visits_s:
                yield "no visit is planned yet: more urgent targets take the robots that could go"
        case TakeOver():
            return


def _pin(situation: Situation, pin: Pin, unreachable: Collection[str]) -> Iterator[str]:
    for robot in situation.state.robots:
        if robot.id == pin.robot and robot.activity is Activity.FAILED:
            yield f"{pin.robot} takes no part at the moment"
    for identifier, other in situation.instructions:
        match other:
            case Pin(robot=name, location=place) if place == pin.location and name != pin.robot:
                yield f"{place} is pinned to {name} as well ({identifier}): nobody can go"
            case Forbid(robot=name, location=place) if (name, place) == (pin.robot, pin.location):
                yield f"{name} is forbidden to go there ({identifier})"
    if pin.location in unreachable:
        yield f"{pin.robot} cannot reach {pin.location}, as far as is known"


def _deadline(
    situation: Situation,
    target: str,
    time_s: float,
    visits_s: Mapping[str, float],
    unreachable: Collection[str],
) -> Iterator[str]:
    visit_s = situation.state.time_s + visits_s.get(target, inf)
    if target in unreachable:
        yield f"no robot can reach {target}, as far as is known"
    elif target not in visits_s:
        yield "no visit is planned yet: other deadlines take the robots that could go"
    elif visit_s > time_s:
        yield f"the earliest visit found is at {visit_s:.1f} s"


def _is_open(situation: Situation, instruction: Instruction) -> bool:
    """Whether there is still something to obey."""
    place = getattr(instruction, "target", None) or getattr(instruction, "location", None)
    state = situation.state
    return place is None or place in {
        *(target.id for target in state.targets),
        *(blockade.id for blockade in state.blockades),
    }
