"""What a mission shows of itself."""

from semantic_attachments.world import Blockade, World
from service.coordination.known_map import write_cells
from service.coordination.mission import Mission, MissionBlockade
from service.messages.instruction import InstructionStatus
from service.messages.plan import (
    BlockadeStatus,
    KnownMap,
    MissionDetail,
    PlanInForce,
    RobotStatus,
    TargetStatus,
)


def _blockade(blockade: MissionBlockade) -> BlockadeStatus:
    return BlockadeStatus(
        id=blockade.id,
        segment_m=blockade.segment_m,
        clear_duration_s=blockade.clear_duration_s,
        seen_at_s=blockade.seen_at_s,
        cleared_by=blockade.cleared_by,
        cleared_at_s=blockade.cleared_at_s,
    )


def mission_detail(mission: Mission) -> MissionDetail:
    """The mission in full."""
    return MissionDetail(
        id=mission.id,
        name=mission.request.name,
        fleet=mission.request.fleet,
        domain=next(
            (used.name for used in mission.resources if used.kind == "domain"),
            mission.request.domain,
        ),
        resources=list(mission.resources),
        strategy=mission.request.strategy,
        status=mission.status,
        status_reason=mission.status_reason,
        time_s=mission.time_s,
        revision=mission.revision,
        sequence=mission.sequence,
        targets_left=mission.targets_left,
        replans=mission.replans,
        robots=[
            RobotStatus(
                id=robot.id,
                type=robot.type,
                pose=robot.pose,
                state=robot.state,
                lost=robot.lost,
                left=robot.left,
                taken_over=robot.taken_over,
                carrier=robot.carrier,
                command=command.id if (command := mission.commands.get(robot.id)) else None,
                reported_at_s=robot.reported_at_s,
            )
            for robot in mission.robots.values()
        ],
        targets=[
            TargetStatus(
                id=target.id,
                position_m=target.position_m,
                visited_by=target.visited_by,
                visited_at_s=target.visited_at_s,
                removed=target.removed,
            )
            for target in mission.targets.values()
        ],
        blockades=[_blockade(blockade) for blockade in mission.blockades.values()],
        instructions=[
            InstructionStatus(
                id=given.id,
                instruction=given.instruction,
                given_at_s=given.given_at_s,
                remark=given.remark,
            )
            for given in mission.instructions.values()
        ],
        decisions=list(mission.decisions),
    )


def plan_in_force(mission: Mission) -> PlanInForce:
    """The plan that the commands come from; empty before the first one."""
    plan = mission.plan
    if plan is None:
        return PlanInForce(
            revision=mission.revision, steps=[], makespan_s=mission.time_s, validated=False
        )
    return PlanInForce(
        revision=plan.revision,
        steps=list(plan.steps),
        makespan_s=plan.end_s,
        validated=plan.validated,
    )


def known_map(mission: Mission) -> KnownMap:
    """The map with all known, uncleared blockades drawn in as occupied cells."""
    message, grid = mission.request.map, mission.map.grid
    open_blockades = [b for b in mission.blockades.values() if b.cleared_by is None]
    world = World(
        grid=grid,
        blockades={b.id: Blockade(b.id, b.segment_m, b.clear_duration_s) for b in open_blockades},
    )
    return KnownMap(
        resolution_m=message.resolution_m,
        origin_m=message.origin_m,
        width=message.width,
        height=message.height,
        encoding=message.encoding,
        cells=write_cells(world.cells_with_blockades()),
        terrain=None if grid.terrain is None else write_cells(grid.terrain),
        terrain_classes=message.terrain_classes,
        blockades=[_blockade(blockade) for blockade in open_blockades],
    )
