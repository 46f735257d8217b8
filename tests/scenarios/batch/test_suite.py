"""Suites read, expand to the whole grid, and say what is wrong."""

from pathlib import Path

import pytest

from scenarios.batch.command import run_suite
from scenarios.batch.suite import read_suite
from scenarios.commands.bench import suite_files
from scenarios.exit_codes import CommandError
from scenarios.scenario_file import ScenarioFileError


@pytest.mark.parametrize("name", sorted(suite_files()))
def test_shipped_suites_read(name: str) -> None:
    suite = read_suite(suite_files()[name])
    runs = suite.runs()
    assert len(runs) == len({spec.key for spec in runs})
    assert {spec.strategy for spec in runs} == set(suite.all_strategies)
    quick = suite.quickly()
    assert 0 < len(quick.runs()) <= 50
    assert {spec.key for spec in quick.runs()} <= {spec.key for spec in runs}
    assert {spec.strategy for spec in quick.runs()} >= set(suite.strategies)


def test_strategies_share_map_and_seed() -> None:
    suite = read_suite(suite_files()["disaster"])
    first, second = suite.runs()[:2]
    assert first.strategy != second.strategy
    assert (first.map_seed, first.seed, first.team) == (second.map_seed, second.seed, second.team)


def test_disaster_has_the_thesis_maps_and_eight_teams() -> None:
    suite = read_suite(suite_files()["disaster"])
    assert suite.seeds == 30
    assert len(suite.teams) >= 8
    assert all(len(entry.map_seeds) >= 5 for entry in suite.maps)


def test_maps_have_grids_of_their_own_and_arms_beside(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("", encoding="utf-8")
    path = tmp_path / "suite.toml"
    path.write_text(
        """
name = "s"
strategies = ["x", "y"]
teams = [{ explorer = 1 }, { explorer = 2 }]
seeds = 3
[[maps]]
name = "whole"
scenario = "a.toml"
[[maps.arms]]
strategies = ["y", "z"]
teams = [{ explorer = 2 }]
seeds = 2
[[maps]]
name = "part"
scenario = "a.toml"
strategies = ["x"]
teams = [{ explorer = 1 }]
seeds = 1
""",
        encoding="utf-8",
    )
    suite = read_suite(path)
    runs = suite.runs()
    assert suite.all_strategies == ("x", "y", "z")
    assert sorted(spec.key for spec in runs if spec.map_name == "part") == ["part|1 explorer|1|x"]
    whole = [spec for spec in runs if spec.map_name == "whole"]
    assert len(whole) == 2 * 2 * 3 + 2
    assert [s.key for s in whole if s.strategy == "z"] == [
        f"whole|2 explorer|{seed}|z" for seed in (1, 2)
    ]
    assert [spec.seed for spec in runs] == sorted(spec.seed for spec in runs)


def test_a_variant_is_a_strategy_that_knows_more() -> None:
    runs = {spec.strategy: spec for spec in read_suite(suite_files()["disaster"]).runs()}
    bound = runs["planner with blockades known"]
    assert (bound.coordination, bound.blockades_known) == ("planner", True)
    assert (runs["hungarian"].coordination, runs["hungarian"].blockades_known) == (
        "hungarian",
        False,
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[[maps]]", "[[map]]", "maps"),
        ('"a.toml"', '"b.toml"', "b.toml is not there"),
        ('subject = "x"', 'subject = "z"', "subject 'z' is none of the strategies"),
        ('name = "s"', 'name = "s', "not TOML"),
    ],
)
def test_faults_are_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    text = """
name = "s"
strategies = ["x", "y"]
subject = "x"
teams = [{ explorer = 1 }]
[[maps]]
name = "m"
scenario = "a.toml"
"""
    (tmp_path / "a.toml").write_text("", encoding="utf-8")
    path = tmp_path / "suite.toml"
    path.write_text(text, encoding="utf-8")
    assert read_suite(path).name == "s"
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(ScenarioFileError, match=message):
        read_suite(path)


def test_two_maps_of_one_name_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("", encoding="utf-8")
    path = tmp_path / "suite.toml"
    entry = '[[maps]]\nname = "m"\nscenario = "a.toml"\n'
    text = f'name = "s"\nstrategies = ["x"]\nteams = [{{ explorer = 1 }}]\n{entry}{entry}'
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioFileError, match="two maps are called 'm'"):
        read_suite(path)


def test_a_misspelt_strategy_is_refused_before_any_run(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("", encoding="utf-8")
    path = tmp_path / "suite.toml"
    path.write_text(
        'name = "s"\nstrategies = ["hungarain"]\nteams = [{ explorer = 1 }]\n'
        '[[maps]]\nname = "m"\nscenario = "a.toml"\n',
        encoding="utf-8",
    )
    with pytest.raises(CommandError, match="no strategy 'hungarain': there are auction"):
        run_suite(path, tmp_path / "out", quick=False, jobs=1, resume=False)
    assert not (tmp_path / "out").exists()


def test_a_team_of_robots_that_the_scenario_lacks_is_refused_before_any_run(tmp_path: Path) -> None:
    path = tmp_path / "suite.toml"
    scenario = Path("scenarios/disaster/hospital.toml").resolve()
    path.write_text(
        'name = "s"\nstrategies = ["planner"]\nteams = [{ explorer = 1, sweeper = 1 }]\n'
        f'[[maps]]\nname = "m"\nscenario = "{scenario}"\n',
        encoding="utf-8",
    )
    with pytest.raises(CommandError, match="type 'sweeper', which hospital\\.toml does not"):
        run_suite(path, tmp_path / "out", quick=False, jobs=1, resume=False)
    assert not (tmp_path / "out").exists()
