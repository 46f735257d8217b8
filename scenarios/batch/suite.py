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


Teams = tuple[dict[str, Annotated[int, Field(ge=0)]], ...]


class Arm(_Section):
    """More strategies on a part of a map's grid: what is not worth thirty runs a cell."""

    strategies: Annotated[tuple[str, ...], Field(min_length=1)]
    teams: Teams | None = None
    """the map's teams if not given"""
    seeds: Annotated[int, Field(ge=1)] | None = None
    """the map's seeds if not given"""


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
    strategies: Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    """the suite's strategies if not given"""
    teams: Annotated[Teams, Field(min_length=1)] | None = None
    """the suite's teams if not given"""
    seeds: Annotated[int, Field(ge=1)] | None = None
    """the suite's seeds if not given"""
    arms: tuple[Arm, ...] = ()
    """strategies that this map is given beside, on fewer teams or seeds"""


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
    teams: Teams = Field(min_length=1)
    strategies: tuple[str, ...] = Field(min_length=1)
    """names of strategies, or of variants"""
    variants: dict[str, Variant] = {}
    subject: str = ""
    """strategy that is compared with each of the others; the first one if not given"""
    seeds: Annotated[int, Field(ge=1)] = 30
    """runs a cell, with seeds 1, 2, ...: the same starts for every strategy"""
    planning: PlanningSection | None = None
    limits: Limits = Limits()
    quick: Quick = Quick()

    @model_validator(mode="after")
    def _subject_is_a_strategy(self) -> Suite:
        if self.subject and self.subject not in self.all_strategies:
            raise ValueError(f"subject {self.subject!r} is none of the strategies")
        return self

    @model_validator(mode="after")
    def _maps_have_names_of_their_own(self) -> Suite:
        names = [entry.name for entry in self.maps]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"two maps are called {twice[0]!r}")
        return self

    @property
    def compared(self) -> str:
        """The strategy that is compared with each of the others."""
        return self.subject or self.strategies[0]

    @property
    def all_strategies(self) -> tuple[str, ...]:
        """Every strategy that some map is given, in the order of the file."""
        own = [name for entry in self.maps for name in entry.strategies or ()]
        beside = [name for entry in self.maps for arm in entry.arms for name in arm.strategies]
        return tuple(dict.fromkeys((*self.strategies, *own, *beside)))

    def quickly(self) -> Suite:
        """The quick subset; teams spread over the whole range."""

        def some(teams: Teams) -> Teams:
            return teams[:: max(1, len(teams) // self.quick.teams)][: self.quick.teams]

        maps = tuple(
            entry.model_copy(
                update={
                    "seeds": min(entry.seeds or self.seeds, self.quick.seeds),
                    "teams": some(entry.teams or self.teams),
                    "arms": tuple(
                        arm.model_copy(update={"seeds": 1, "teams": arm.teams and arm.teams[:1]})
                        for arm in entry.arms
                    ),
                }
            )
            for entry in self.maps[: self.quick.maps]
        )
        return self.model_copy(update={"maps": maps})

    def runs(self) -> list[RunSpec]:
        """Every run; all strategies of a seed stand together, so that an early end leaves pairs."""
        made: dict[str, tuple[int, RunSpec]] = {}
        for entry in self.maps:
            seeds = entry.seeds or self.seeds
            teams = entry.teams or self.teams
            whole = Arm(strategies=entry.strategies or self.strategies)
            for arm in (whole, *entry.arms):
                for team in arm.teams or teams:
                    for seed in range(1, (arm.seeds or seeds) + 1):
                        for strategy in arm.strategies:
                            spec = self._spec(entry, team, seed, strategy)
                            made.setdefault(spec.key, (seed, spec))
        return [spec for _, spec in sorted(made.values(), key=lambda one: one[0])]

    def _spec(self, entry: MapEntry, team: dict[str, int], seed: int, strategy: str) -> RunSpec:
        variant = self.variants.get(strategy, Variant(strategy=strategy))
        return RunSpec(
            map_name=entry.name,
            scenario=str(entry.scenario),
            generator=entry.generator,
            map_seed=entry.map_seeds[seed % len(entry.map_seeds)] if entry.map_seeds else None,
            blockade_share=entry.blockade_share,
            team=tuple(sorted(team.items())),
            seed=seed,
            strategy=strategy,
            coordination=variant.strategy,
            blockades_known=variant.blockades_known,
        )


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
        why = first["msg"].removeprefix("Value error, ")
        raise ScenarioFileError(path, where, why, "correct it") from None
    maps = tuple(
        entry.model_copy(update={"scenario": (path.parent / entry.scenario).resolve()})
        for entry in suite.maps
    )
    for entry in maps:
        if not entry.scenario.is_file():
            raise ScenarioFileError(path, f"maps.{entry.name}", f"{entry.scenario} is not there")
    return suite.model_copy(update={"maps": maps})
