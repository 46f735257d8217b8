"""Scenario files: every shipped one reads, and a faulty one says file, key, reason and remedy."""

from pathlib import Path

import pytest

import scenarios
from scenarios.scenario_file import ScenarioFileError, read_scenario

ROOM = Path(scenarios.__file__).parent
HOSPITAL = ROOM / "disaster" / "hospital.toml"

SMALL = """
name = "small"
[map]
file = "small.yaml"
[robot_types.explorer]
speed_m_s = 1.0
[team]
explorer = 1
"""


def written(folder: Path, text: str) -> Path:
    (folder / "small.yaml").write_text("image: small.pgm\n", encoding="utf-8")
    path = folder / "small.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_hospital_has_the_thesis_numbers() -> None:
    scenario = read_scenario(HOSPITAL)
    assert len(scenario.targets) == 15
    assert len(scenario.blockades) == 18
    assert scenario.team == {"explorer": 2, "clearer": 2}
    assert scenario.map.file is not None
    assert scenario.map.file.is_file()


def test_targets_of_file_and_annotations_add_up(tmp_path: Path) -> None:
    (tmp_path / "places.toml").write_text(
        '[[targets]]\nid = "a"\nposition_m = [1, 2]\n', encoding="utf-8"
    )
    text = SMALL.replace("[map]", '[[targets]]\nid = "b"\nposition_m = [3, 4]\n[map]')
    text = text.replace("[robot_types", 'annotations = "places.toml"\n[robot_types')
    scenario = read_scenario(written(tmp_path, text))
    assert [target.id for target in scenario.targets] == ["a", "b"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "small"', "", "name: is missing; add it"),
        ('"small.yaml"', '"none.yaml"', "map.file: .*none.yaml is not there; put the map"),
        ("speed_m_s = 1.0", "speed = 1.0", "robot_types.explorer.speed: is not a key"),
        ("speed_m_s = 1.0", "speed_m_s = -1", "speed_m_s: input should be greater than 0, not -1"),
        ("explorer = 1", "explorers = 1", "unknown robot type 'explorers'; use one of explorer"),
        ("explorer = 1", "explorer = 0", "no robots; add a"),
        ('file = "small.yaml"', "", "map: give one of file"),
        ("[team]", "[team", "not TOML: .*line 7"),
    ],
)
def test_faults_are_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = written(tmp_path, SMALL.replace(old, new))
    with pytest.raises(ScenarioFileError, match=message) as fault:
        read_scenario(path)
    assert "small.toml" in str(fault.value)


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(ScenarioFileError, match="no such file"):
        read_scenario(tmp_path / "none.toml")
    with pytest.raises(ScenarioFileError, match="is a folder"):
        read_scenario(tmp_path)
