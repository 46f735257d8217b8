"""What frontiers that were found do to a mission."""

from service.coordination.events import FrontiersFound
from service.coordination.mission import Mission, MissionTarget


def apply_frontiers(mission: Mission, event: FrontiersFound) -> None:
    """The open exploration targets are those of the event; others have been seen meanwhile."""
    there = {target.id for target in event.targets}
    for target in list(mission.targets.values()):
        if target.is_frontier and target.is_open and target.id not in there:
            target.removed = True
            if not any(place == target.id for _, place in mission.failures):
                # Nobody has been there, and nobody failed: nothing to remember.
                del mission.targets[target.id]
    for found in event.targets:
        known = mission.targets.get(found.id)
        if known is None:
            mission.targets[found.id] = MissionTarget(found.id, found.position_m, is_frontier=True)
            mission.frontiers_named += 1
        else:
            known.position_m = found.position_m
            if found.id in mission.target_places_m:
                mission.target_places_m[found.id] = found.position_m
