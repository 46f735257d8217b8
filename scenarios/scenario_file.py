"""Reads a scenario file: which building, which fleet, which mission, how much planning.

Positions are metres in the map frame, headings radians, times seconds. Paths in a scenario file are
relative to it.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

Position = tuple[float, float]
Pose = tuple[float, float, float]
S = TypeVar("S", bound="_Section")


class ScenarioFileError(ValueError):
    """A scenario file that cannot be run: which file, which key, why, and how to mend it."""

    def __init__(self, path: Path, where: str, why: str, mend: str = "") -> None:
        place = f"{path}: {where}" if where else f"{path}"
        super().__init__(f"{place}: {why}" + (f"; {mend}" if mend else ""))


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class MapSection(_Section):
    """A map_server YAML file, an image with the size of what it shows, or a generated building."""

    file: Path | None = None
    generator: str | None = None
    """a building of `scenarios.maps`, with targets and blockades, drawn by `seed`"""
    seed: int = 1
    image: Path | None = None
    """dark pixels are walls; the whole image spans `size_m`"""
    size_m: tuple[Annotated[float, Field(gt=0)], Annotated[float, Field(gt=0)]] | None = None
    resolution_m: Annotated[float, Field(gt=0)] = 0.2
    """cell size an image is sampled to"""
    inside_m: Position | None = None
    """a point of the building, where an image shows more than one closed area"""
    annotations: Path | None = None
    """TOML file with `[[targets]]` and `[[blockades]]`"""

    @model_validator(mode="after")
    def _one_source(self) -> MapSection:
        if [self.file, self.image, self.generator].count(None) != 2:
            raise ValueError(
                "give one of file (map_server YAML), image (with size_m) and generator"
            )
        if self.image is not None and self.size_m is None:
            raise ValueError("an image needs size_m = [width, height] of what it shows")
        return self


class RobotTypeSection(_Section):
    """Body, drive and senses of a kind of robot."""

    radius_m: Annotated[float, Field(gt=0)] = 0.3
    speed_m_s: Annotated[float, Field(gt=0)] = 1.0
    turn_rate_rad_s: Annotated[float, Field(gt=0)] = 2.0
    """of a differential drive, which turns on the spot"""
    drive: Literal["differential", "ackermann"] = "differential"
    turning_radius_m: Annotated[float, Field(gt=0)] = 0.8
    """least radius of an Ackermann drive"""
    sensor_range_m: Annotated[float, Field(gt=0)] = 5.0
    beams: Annotated[int, Field(ge=8)] = 180
    enters: tuple[str, ...] = ("default",)
    capacity: Annotated[int, Field(ge=0)] = 0
    """how many robots it can carry"""
    carried_by: str | None = None
    """type of the carriers that the robots of a `team` ride on at the start"""


class RobotSection(_Section):
    """A robot with its own start pose."""

    id: str
    type: str
    pose: Pose
    carrier: str | None = None


class TargetSection(_Section):
    """A place to visit."""

    id: str
    position_m: Position


class BlockadeSection(_Section):
    """A hidden obstacle across a passage."""

    id: str
    segment_m: tuple[Position, Position]
    clear_duration_s: Annotated[float, Field(ge=0)]


class PlanningSection(_Section):
    """How much planning a replan may take."""

    time_limit_s: Annotated[float, Field(gt=0, le=60)] = 0.3
    node_limit: Annotated[int, Field(ge=1)] | None = None
    """search nodes a replan: with it a seed repeats to the bit"""
    margin: Annotated[float, Field(ge=0, le=0.5)] = 0.02
    """share of the remaining makespan by which a new plan must be better to replace a valid one"""


class NoiseSection(_Section):
    """Standard deviations of sensing; zero switches a noise off."""

    laser_range_m: Annotated[float, Field(ge=0)] = 0.0
    odometry_m: Annotated[float, Field(ge=0)] = 0.0
    """of the position after a metre driven; grows with the square root of the way"""
    odometry_rad: Annotated[float, Field(ge=0)] = 0.0
    """of the heading after a radian turned"""
    odometry_rad_per_m: Annotated[float, Field(ge=0)] = 0.0
    """of the heading after a metre driven"""


class CommunicationSection(_Section):
    """How far the radios of the robots and of the service reach."""

    range_m: Annotated[float, Field(gt=0)]
    base_m: Position | None = None
    """where the service's radio stands; where the first robot starts if it is left out"""
    lease_s: Annotated[float, Field(gt=0)] = 600.0
    """for how long the service reckons with a robot that it does not hear"""


class FailureSection(_Section):
    """A robot that dies, or stands still for `duration_s`, at `time_s`."""

    robot: str
    time_s: Annotated[float, Field(ge=0)]
    duration_s: Annotated[float, Field(gt=0)] | None = None


class ScenarioFile(_Section):
    """The content of a scenario file."""

    name: str
    description: str = ""
    domain: str = "disaster"
    strategy: str = "planner"
    time_limit_s: Annotated[float, Field(gt=0)] = 7200.0
    report_period_s: Annotated[float, Field(gt=0)] = 5.0
    scan_period_s: Annotated[float, Field(gt=0)] = 0.2
    """between two sweeps of a robot's laser"""
    map: MapSection
    robot_types: dict[str, RobotTypeSection]
    team: dict[str, Annotated[int, Field(ge=0, le=1000)]] = {}
    """how many robots of each type; their start poses are drawn by the seed"""
    robots: tuple[RobotSection, ...] = ()
    """robots with start poses of their own, instead of or beside `team`"""
    targets: tuple[TargetSection, ...] = ()
    blockades: tuple[BlockadeSection, ...] = ()
    blockade_share: Annotated[float, Field(ge=0, le=1)] = 1.0
    """share of the blockades that are there; the seed draws which"""
    blockades_known: bool = False
    """whether the fleet knows all blockades when it starts"""
    explores: bool = False
    """whether the building is unknown; a generated one is then without targets and blockades"""
    planning: PlanningSection = PlanningSection()
    noise: NoiseSection = NoiseSection()
    communication: CommunicationSection | None = None
    """radios reach everywhere if it is left out"""
    failures: tuple[FailureSection, ...] = ()

    @model_validator(mode="after")
    def _types_exist(self) -> ScenarioFile:
        known = ", ".join(sorted(self.robot_types))
        carriers = [kind.carried_by for kind in self.robot_types.values() if kind.carried_by]
        for kind in [*self.team, *(robot.type for robot in self.robots), *carriers]:
            if kind not in self.robot_types:
                raise ValueError(f"unknown robot type {kind!r}: use one of {known}, or define it")
        if not self.robots and not any(self.team.values()):
            raise ValueError("no robots: add a [team] table such as explorer = 2")
        return self


class AnnotationsFile(_Section):
    """What stands in a building: mission targets and blockades."""

    sealed_fraction: float | None = None
    targets: tuple[TargetSection, ...] = ()
    blockades: tuple[BlockadeSection, ...] = ()


def read_scenario(path: Path) -> ScenarioFile:
    """Reads and checks a scenario file; targets and blockades of its annotations are merged in."""
    scenario = _checked(ScenarioFile, path)
    folder = path.parent
    updates: dict[str, Any] = {"map": _resolved(scenario.map, folder)}
    if scenario.map.annotations is not None:
        annotations = _checked(AnnotationsFile, folder / scenario.map.annotations)
        updates["targets"] = (*annotations.targets, *scenario.targets)
        updates["blockades"] = (*annotations.blockades, *scenario.blockades)
    scenario = scenario.model_copy(update=updates)
    for key in ("file", "image"):
        source = getattr(scenario.map, key)
        if source is not None and not source.is_file():
            raise ScenarioFileError(
                path, f"map.{key}", f"{source} is not there", "put the map in that place"
            )
    return scenario


def _resolved(section: MapSection, folder: Path) -> MapSection:
    paths = {
        key: (folder / value).resolve()
        for key in ("file", "image", "annotations")
        if (value := getattr(section, key)) is not None
    }
    return section.model_copy(update=paths)


def _checked(section: type[S], path: Path) -> S:
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ScenarioFileError(path, "", "no such file", "check the path") from None
    except IsADirectoryError:
        raise ScenarioFileError(path, "", "is a folder", "name the .toml file in it") from None
    except UnicodeDecodeError:
        raise ScenarioFileError(path, "", "is not UTF-8 text", "save it as UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise ScenarioFileError(path, "", f"not TOML: {error}", "mend that line") from None
    try:
        return section.model_validate(content)
    except ValidationError as invalid:
        first = invalid.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise ScenarioFileError(path, where, *_reason(first["type"], first)) from None


def _reason(kind: str, error: Any) -> tuple[str, str]:
    """Why a value is refused, and how to mend it."""
    if kind == "missing":
        return "is missing", "add it"
    if kind == "extra_forbidden":
        return "is not a key of a scenario", "check its spelling or remove it"
    if kind == "value_error":
        why, _, mend = str(error["ctx"]["error"]).partition(": ")
        return why, mend
    why = error["msg"][0].lower() + error["msg"][1:]
    return f"{why}, not {error['input']!r}", "correct the value"
