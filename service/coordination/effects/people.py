"""What people change in a mission that is under way."""

from service.coordination.events import (
    Event,
    InstructionGiven,
    InstructionWithdrawn,
    RobotJoined,
    RobotLeft,
    TargetAdded,
    TargetRemoved,
)
from service.coordination.fleet_robot import fleet_robot
from service.coordination.mission import GivenInstruction, Mission, MissionTarget
from service.messages.instruction import Deadline, Forbid, Instruction, Pin, Priority, TakeOver


def apply_change(mission: Mission, event: Event) -> None:
    """What people change in a mission that is under way."""
    mission.disturb()
    match event:
        case RobotJoined(robot=robot):
            mission.robots[robot.id] = fleet_robot(robot, mission.time_s)
            mission.decide(event.time_s, "robot joined", robot.id)
        case RobotLeft(robot=robot_id):
            mission.robots[robot_id].left = True
            mission.drop_command(robot_id)
            mission.decide(event.time_s, "robot left", robot_id)
        case TargetAdded(target=target):
            mission.targets[target.id] = MissionTarget(target.id, target.position_m)
            mission.decide(event.time_s, "target added", target.id)
        case TargetRemoved(target=target_id):
            mission.targets[target_id].removed = True
            mission.decide(event.time_s, "target removed", target_id)
        case InstructionGiven():
            _instruct(mission, event)
        case InstructionWithdrawn():
            _withdraw(mission, event)


def _instruct(mission: Mission, event: InstructionGiven) -> None:
    instruction = event.instruction
    mission.instructions[event.id] = GivenInstruction(event.id, instruction, event.time_s)
    if isinstance(instruction, TakeOver):
        mission.robots[instruction.robot].taken_over = True
        mission.drop_command(instruction.robot)
    mission.decide(event.time_s, "instruction", f"{event.id}: {describe(instruction)}")


def _withdraw(mission: Mission, event: InstructionWithdrawn) -> None:
    withdrawn = mission.instructions.pop(event.id).instruction
    if isinstance(withdrawn, TakeOver):
        mission.robots[withdrawn.robot].taken_over = any(
            isinstance(given.instruction, TakeOver) and given.instruction.robot == withdrawn.robot
            for given in mission.instructions.values()
        )
    mission.decide(event.time_s, "instruction withdrawn", f"{event.id}: {describe(withdrawn)}")


def describe(instruction: Instruction) -> str:
    """An instruction in a sentence."""
    match instruction:
        case Pin(robot=robot, location=location):
            return f"only {robot} goes to {location}"
        case Forbid(robot=robot, location=location):
            return f"{robot} does not go to {location}"
        case Priority(target=target, priority=priority):
            return f"{target} has priority {priority}"
        case Deadline(target=target, time_s=time_s):
            return f"visit {target} by {time_s:g} s"
        case TakeOver(robot=robot):
            return f"a person drives {robot}"
