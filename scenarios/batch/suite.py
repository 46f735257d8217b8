"""A suite: a grid of maps, team sizes, seeds and strategies, read from a TOML file."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from scenarios.scenario_file import PlanningSection, ScenarioFileError


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class MapEntry(_Section):
    """A column of the grid: a scenario, perhaps on other maps or with fewer blockades."""

    name: str
    scenario: Path
    """the scenario whose map, robot types and limits are used"""
    map_seeds: tuple[int, ...] = ()
    """buildings or placements to alternate between; run k uses entry k modulo their number"""
    generator: str | None = None
    """draws these buildings instead of the scenario's map"""
    blockade_share: Annotated[float, Field(ge=0, le=1)] = 1.0
    figure: str = ""
    """what the picture of this map is called"""


class Limits(_Section):
    """What one run may use."""

    wall_s: Annotated[float, Field(gt=0)] = 600.0
    memory_mb: Annotated[int, Field(ge=256)] = 4096


class Quick(_Section):
    """The subset that `--quick` runs."""

    seeds: Annotated[int, Field(ge=1)] = 3
    teams: Annotated[int, Field(ge=1)] = 2
    maps: Annotated[int, Field(ge=1)] = 2


class Variant(_Section):
    """A strategy that is given something which the others are not."""

    strategy: str
    blockades_known: bool = False
    """it knows all blockades from the start: a bound, not a competitor"""


class Suite(_Section):
    """The content of a suite file."""

    name: str
    title: str = ""
    maps: tuple[MapEntry, ...] = Field(min_length=1)
    teams: tuple[dict[str, Annotated[int, Field(ge=0)]], ...] = Field(min_length=1)
    strategies: tuple[str, ...] = Field(min_length=1)
    """names of strategies, or of variants"""
    variants: dict[str, Variant] = {}
    reference: str = ""
    """strategy that the others are compared with; the last one if not given"""
    seeds: Annotated[int, Field(ge=1)] = 30
    """runs a cell, with seeds 1, 2, ...: the same starts for every strategy"""
    planning: PlanningSection | None = None
    limits: Limits = Limits()
    quick: Quick = Quick()

    @model_validator(mode="after")
    def _reference_is_a_strategy(self) -> Suite:
        if self.reference and self.reference not in self.strategies:
            raise ValueError(f"reference {self.reference!r} is none of the strategies")
        return self

    @property
    def compared_with(self) -> str:
        """The strategy that the others are compared with."""
        return self.reference or self.strategies[-1]

    def quickly(self) -> Suite:
        """The quick subset; teams spread over the whole range."""
        step = max(1, len(self.teams) // self.quick.teams)
        return self.model_copy(
            update={
                "seeds": min(self.seeds, self.quick.seeds),
                "teams": self.teams[::step][: self.quick.teams],
                "maps": self.maps[: self.quick.maps],
            }
        )

    def runs(self) -> list[RunSpec]:
        """Every run; all strategies of a seed stand together, so that an early end leaves pairs."""
        return [
            RunSpec(
                map_name=entry.name,
                scenario=str(entry.scenario),
                generator=entry.generator,
                map_seed=entry.map_seeds[seed % len(entry.map_seeds)] if entry.map_seeds else None,
                blockade_share=entry.blockade_share,
                team=tuple(sorted(team.items())),
                seed=seed,
                strategy=strategy,
                coordination=self.variants[strategy].strategy
                if strategy in self.variants
                else strategy,
                blockades_known=strategy in self.variants
                and self.variants[strategy].blockades_known,
            )
            for seed in range(1, self.seeds + 1)
            for entry in self.maps
            for team in self.teams
            for strategy in self.strategies
        ]


@dataclass(frozen=True)
class RunSpec:
    """One mission of a suite."""

    map_name: str
    scenario: str
    generator: str | None
    map_seed: int | None
    blockade_share: float
    team: tuple[tuple[str, int], ...]
    seed: int
    strategy: str
    """as the suite names it"""
    coordination: str
    """as the service names it"""
    blockades_known: bool

    @property
    def team_name(self) -> str:
        """`2 explorer + 1 clearer`: types in alphabetical order turned round, visitors first."""
        return " + ".join(f"{count} {kind}" for kind, count in reversed(self.team))

    @property
    def key(self) -> str:
        """What makes this run this run, within a suite."""
        return f"{self.map_name}|{self.team_name}|{self.seed}|{self.strategy}"


def read_suite(path: Path) -> Suite:
    """Reads a suite; scenario paths are relative to it.

    Raises:
        ScenarioFileError: which file, which key, why.
    """
    try:
        content: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ScenarioFileError(path, "", "no such file", "check the path") from None
    except tomllib.TOMLDecodeError as error:
        raise ScenarioFileError(path, "", f"not TOML: {error}", "mend that line") from None
    try:
        suite = Suite.model_validate(content)
    except ValidationError as invalid:
        first = invalid.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise ScenarioFileError(path, where, first["msg"], "correct it") from None
    maps = tuple(
        entry.model_copy(update={"scenario": (path.parent / entry.scenario).resolve()})
        for entry in suite.maps
    )
    for entry in maps:
        if not entry.scenario.is_file():
            raise ScenarioFileError(path, f"maps.{entry.name}", f"{entry.scenario} is not there")
    return suite.model_copy(update={"maps": maps})
