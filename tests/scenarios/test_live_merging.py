"""Unknown start poses: maps merged over the service while driving, then a mission on that map."""

from pathlib import Path

import httpx
import numpy as np
import pytest

from scenarios.in_process_service import ADDRESS, service_in_process
from scenarios.service_link import ServiceLink
from service.settings import Settings
from simulator.fleet_client import FleetClient
from simulator.fleet_scenario import FleetScenario, RobotStart, RobotType, Target
from simulator.simulation import Simulation
from simulator.slam.distributed import MapExchange
from simulator.slam.experiments.floors import office_floor
from simulator.slam.grid_front_end import GridFrontEndParameters
from simulator.slam.live_merging import JointFrameService, LiveParameters, survey
from simulator.slam.map_files import write_map_server
from simulator.slam.pose import between

PARAMETERS = LiveParameters(
    first_nodes=100, retry_nodes=25, merging=GridFrontEndParameters(sequence=25, stride=5)
)


@pytest.mark.slow
def test_a_team_that_knows_nothing_of_one_another_carries_out_a_mission(tmp_path: Path) -> None:
    grid, stops = office_floor(11, 0, rooms=3)
    write_map_server(grid, tmp_path / "floor.yaml")
    tours = {"scout_1": stops, "scout_2": (*stops[3:], *stops[1:4])}
    settings = Settings(database_url=f"sqlite:///{tmp_path}/live.db", executor="threads")
    with (
        service_in_process(settings) as transport,
        httpx.Client(transport=transport, base_url=ADDRESS) as http,
    ):
        exchange = MapExchange(http)
        members = survey(
            grid,
            tours,
            exchange,
            "joint",
            random=np.random.default_rng(4),
            parameters=PARAMETERS,
        )
        assert all(member.frame is not None for member in members.values())
        one, other = (member.world_in_joint() for member in members.values())
        apart = between(one, other)
        assert np.hypot(apart[0], apart[1]) < 0.5
        fetched = exchange.fetch("joint")
        assert fetched is not None
        scenario = FleetScenario(
            name="live merging",
            map_path=tmp_path / "floor.yaml",
            robot_types=(RobotType("explorer", radius_m=0.2, beams=72),),
            robots=tuple(
                RobotStart(robot, "explorer", (float(x), float(y), float(heading)))
                for robot, (x, y, heading) in ((r, m.truth) for r, m in members.items())
            ),
            targets=(Target("west", tuple(stops[0])), Target("east", tuple(stops[-3]))),
            time_limit_s=600.0,
        )
        link = ServiceLink(http)
        service = JointFrameService(link, fetched[0], members)
        simulation = Simulation(scenario, FleetClient(service))
        for _ in simulation.run():
            pass
    assert simulation.result is not None
    assert simulation.result.outcome == "completed"
    assert sorted(simulation.result.visited) == ["east", "west"]
    assert simulation.result.contacts.wall == 0
