"""When a robot counts as being where it was sent."""

import pytest

from service.coordination.fleet_robot import FleetRobot, has_left


@pytest.mark.parametrize(
    ("place", "metres", "left"),
    [
        ("target_1", 0.4, False),
        ("target_1", 0.6, True),
        ("blockade_1", 0.6, True),
        ("meeting 3 4", 1.4, False),
        ("meeting 3 4", 1.6, True),
    ],
)
def test_robots_that_meet_make_room_for_one_another(place: str, metres: float, left: bool) -> None:
    robot = FleetRobot("rover_1", "rover", (5.0 + metres, 5.0, 0.0))
    robot.arrived_at, robot.arrival_pose = place, (5.0, 5.0, 1.0)
    assert has_left(robot) is left
