"""Scans of a mission's robots, fused into one 3D map; slices, passages and files of it."""

from http import HTTPStatus
from typing import Annotated

import numpy as np
from fastapi import APIRouter, Depends, Query, Request, Response
from numpy.typing import NDArray

from service.access import needs
from service.coordination.known_map import write_cells
from service.json_body import read_limited
from service.messages.base import Message
from service.problem_details import ProblemError, not_found
from service.routes.missions import CoordinatorOf
from service.scan_maps import Frame, MissionScans, ScanError, ScanMaps, read_scan

ROUTER = APIRouter(
    prefix="/v1/missions/{mission_id}", tags=["scans"], dependencies=[Depends(needs("operate"))]
)
Metres = Annotated[float, Query(ge=-1e4, le=1e4)]
MEDIA_TYPE = "application/vnd.marsupial.scan"


class ScanTaken(Message):
    """What became of a scan."""

    beams: int
    scans: dict[str, int]
    """By robot."""
    memory_bytes: int


class MapCells(Message):
    """Cells in the frame of the mission's map, as a map patch of a report."""

    row: int
    column: int
    width: int
    height: int
    cells: str
    terrain: str | None = None


def scan_maps(request: Request) -> ScanMaps:
    """The 3D maps of this service."""
    found: ScanMaps = request.app.state.scan_maps
    if found.factory is None:
        raise ProblemError(
            HTTPStatus.NOT_FOUND, "no-scan-maps", "this service has no 3D maps installed"
        )
    return found


async def scans_of(
    found: CoordinatorOf, maps: Annotated[ScanMaps, Depends(scan_maps)]
) -> MissionScans:
    """The 3D map of the mission a path names."""
    scans = await maps.find(found.mission.id)
    if scans is None:
        raise not_found("3D map of mission", found.mission.id)
    return scans


ScansOf = Annotated[MissionScans, Depends(scans_of)]


@ROUTER.post(
    "/scans",
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}},
        }
    },
)
async def add_scan(
    request: Request,
    found: CoordinatorOf,
    maps: Annotated[ScanMaps, Depends(scan_maps)],
    *,
    robot: Annotated[str, Query(max_length=64)],
    resolution_m: Annotated[float, Query(ge=0.005, le=10.0)] = 0.1,
    max_range_m: Annotated[float | None, Query(gt=0.0, le=1e4)] = None,
) -> ScanTaken:
    """Fuses a robot's scan into the mission's 3D map."""
    mission = found.mission
    if mission.is_over:
        raise ProblemError(HTTPStatus.CONFLICT, "mission-over", "the mission is over")
    if robot not in mission.robots:
        raise not_found("robot", robot)
    body = await read_limited(request, request.app.state.settings.max_body_bytes)
    try:
        scan = read_scan(body)
        scans = await maps.insert(mission.id, robot, scan, resolution_m, max_range_m)
    except ScanError as error:
        raise ProblemError(HTTPStatus.UNPROCESSABLE_ENTITY, "scan-refused", str(error)) from None
    except MemoryError as error:
        raise ProblemError(HTTPStatus.CONFLICT, "map-full", str(error)) from None
    return ScanTaken(
        beams=len(scan[1]), scans=dict(scans.scans), memory_bytes=scans.map.memory_bytes()
    )


@ROUTER.get("/scan-map", response_class=Response)
async def get_scan_map(
    scans: ScansOf, kind: Annotated[str, Query(alias="format", pattern="^(bt|ot)$")] = "bt"
) -> Response:
    """The 3D map as a file of OctoMap."""
    async with scans.lock:
        try:
            contents = scans.map.to_bytes(f".{kind}")
        except ValueError as error:
            raise ProblemError(HTTPStatus.CONFLICT, "map-not-writable", str(error)) from None
    return Response(contents, media_type="application/octet-stream")


@ROUTER.get("/scan-map/slice")
async def get_slice(
    found: CoordinatorOf, scans: ScansOf, low_m: Metres, high_m: Metres
) -> MapCells:
    """The most likely obstacle of each column in a height band."""
    if high_m <= low_m:
        raise ProblemError(
            HTTPStatus.UNPROCESSABLE_ENTITY, "empty-band", f"{high_m} m is not above {low_m} m"
        )
    frame = _frame(found)
    async with scans.lock:
        return _cells(scans.map.band(frame, low_m, high_m))


@ROUTER.get("/scan-map/passages")
async def get_passages(
    found: CoordinatorOf,
    scans: ScansOf,
    height: Annotated[list[str], Query(min_length=1, max_length=16)],
    floor_m: Metres = 0.0,
    step_m: Annotated[float, Query(ge=0.0, le=10.0)] = 0.1,
) -> MapCells:
    """Where robots of several heights find their way: a patch for the mission's map.

    `height=default:1.8&height=low:0.6` puts what robots of 1.8 m pass into the terrain class
    `default`, and what only robots of 0.6 m pass into `low`. Classes are those of the mission's
    map. Sent with the next report, the patch is what missions are planned on.
    """
    grid, frame = found.grid, _frame(found)
    heights = _heights(height, grid.terrain_classes)
    aside = _under_robots(found, frame)
    cells = np.full((frame.height, frame.width), -1, np.int8)
    terrain = np.zeros(cells.shape, np.uint8)
    async with scans.lock:
        for name, height_m in heights:  # the lowest robot first: whoever is taller overwrites
            way = scans.map.passage(frame, floor_m, step_m, height_m)
            if name == heights[0][0]:
                cells = way.copy()
            terrain[way == 0] = grid.terrain_classes.index(name)
    cells[aside] = -1
    return _cells(cells, terrain)


def _heights(texts: list[str], classes: tuple[str, ...]) -> list[tuple[str, float]]:
    """Terrain class and height of each robot, the lowest first."""
    heights = []
    for text in texts:
        name, _, number = text.rpartition(":")
        try:
            height_m = float(number)
        except ValueError:
            height_m = 0.0
        if name not in classes or not 0.0 < height_m <= 100.0:
            raise ProblemError(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                "unknown-height",
                f"{text!r} is not CLASS:METRES with a terrain class of the map: "
                f"{', '.join(classes)}",
            )
        heights.append((name, height_m))
    return sorted(heights, key=lambda entry: entry[1])


def _frame(found: CoordinatorOf) -> Frame:
    grid = found.grid
    return Frame(grid.origin_m, grid.resolution_m, grid.width, grid.height)


def _under_robots(found: CoordinatorOf, frame: Frame) -> NDArray[np.bool_]:
    """Cells under the fleet's own robots: one sees another as an obstacle, which soon moves on."""
    aside = np.zeros((frame.height, frame.width), dtype=bool)
    types = found.mission.request.robot_types
    x = frame.origin_m[0] + (np.arange(frame.width) + 0.5) * frame.resolution_m
    y = frame.origin_m[1] + (np.arange(frame.height) + 0.5) * frame.resolution_m
    for robot in found.mission.robots.values():
        reach_m = types[robot.type].radius_m + 2 * frame.resolution_m
        aside |= np.hypot(x[None, :] - robot.pose[0], y[:, None] - robot.pose[1]) <= reach_m
    return aside


def _cells(cells: NDArray[np.int8], terrain: NDArray[np.uint8] | None = None) -> MapCells:
    height, width = cells.shape
    return MapCells(
        row=0,
        column=0,
        width=width,
        height=height,
        cells=write_cells(cells),
        terrain=None if terrain is None else write_cells(terrain),
    )
