"""Robots of a simulated team join their maps over the service, which knows none of their scans."""

from pathlib import Path

import httpx
import numpy as np
import pytest

from scenarios.in_process_service import ADDRESS, service_in_process
from service.settings import Settings
from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.distributed import MapExchange, MapExchangeError, join, overlaid
from simulator.slam.grid_front_end import GridFrontEndParameters
from simulator.slam.pose import between, compose, inverse
from tests.simulator.slam.rooms import node_truth, office_drive, office_map

PARAMETERS = GridFrontEndParameters(sequence=25, stride=5)


def test_two_robots_agree_on_a_frame_and_a_map(tmp_path: Path) -> None:
    settings = Settings(database_url=f"sqlite:///{tmp_path}/maps.db")
    with (
        service_in_process(settings) as transport,
        httpx.Client(transport=transport, base_url=ADDRESS) as http,
    ):
        exchange = MapExchange(http)
        random = np.random.default_rng(5)
        own, other = office_map(0, 1), office_map(1, 3)
        shifted = other.with_graph(other.graph.moved(np.array([7.0, -20.0, 1.9])))
        first = join(exchange, "joint", own, random, PARAMETERS)
        second = join(exchange, "joint", shifted, random, PARAMETERS)
        assert first is not None
        assert second is not None
        assert second.constraints >= 3
        fetched = exchange.fetch("joint")
    truths = [node_truth(office_map(*key), office_drive(*key)) for key in ((0, 1), (1, 3))]
    world = compose(truths[0][0], inverse(first.robot_map.graph.poses[0]))
    apart = between(truths[1], compose(world, second.robot_map.graph.trajectory()))
    assert np.hypot(apart[:, 0], apart[:, 1]).max() < 0.5
    assert fetched is not None
    # What travelled is maps of a few kilobytes, less than a tenth of the scans.
    scans_bytes = sum(scan.ranges_m.nbytes for scan in own.scans.values())
    assert exchange.sent_bytes < 0.4 * scans_bytes


def test_maps_add_up_in_log_odds() -> None:
    first = OccupancyGrid(np.array([[80, -1], [20, 50]], dtype=np.int8), 0.5, (0.0, 0.0))
    second = OccupancyGrid(np.array([[80, 30]], dtype=np.int8), 0.5, (0.0, 0.0))
    joint = overlaid(first, second)
    assert joint.cells.tolist() == [[94, 30], [20, 50]]
    shifted = overlaid(first, OccupancyGrid(second.cells, 0.5, (1.0, 1.0)))
    assert shifted.cells.shape == (3, 4)
    assert shifted.cells[2].tolist() == [-1, -1, 80, 30]
    with pytest.raises(ValueError, match="different resolutions"):
        overlaid(first, OccupancyGrid(second.cells, 0.2, (0.0, 0.0)))


def test_a_service_that_is_away_is_named() -> None:
    def refuse(request: httpx.Request) -> httpx.Response:
        raise httpx.ConnectError("refused", request=request)

    http = httpx.Client(transport=httpx.MockTransport(refuse), base_url="http://nowhere")
    with pytest.raises(MapExchangeError, match="start it with `marsupial serve`"):
        MapExchange(http).fetch("joint")
