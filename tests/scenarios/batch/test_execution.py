"""A suite's journal survives kills, and a resumed suite does only what is missing."""

from pathlib import Path

import pytest

import scenarios
from scenarios.batch.execution import JOURNAL, TABLE, Row, execute, rows
from scenarios.batch.findings import findings
from scenarios.batch.results import write
from scenarios.batch.run_process import run_in_process
from scenarios.batch.suite import Limits, MapEntry, RunSpec, Suite

SUITE = Suite(
    name="small",
    maps=(MapEntry(name="m", scenario=Path("m.toml"), map_seeds=(7, 8)),),
    teams=({"explorer": 1, "clearer": 1},),
    strategies=("planner", "hungarian"),
    seeds=2,
)


class Counting:
    """Stands for the runs, remembers which were asked for, and may break off."""

    def __init__(self, breaks_at: int | None = None) -> None:
        self.asked: list[str] = []
        self.breaks_at = breaks_at

    def __call__(self, _: Suite, spec: RunSpec) -> Row:
        self.asked.append(spec.key)
        if len(self.asked) == self.breaks_at:
            raise KeyboardInterrupt
        return {"status": "completed", "duration_s": float(spec.seed)}


def test_every_run_once(tmp_path: Path) -> None:
    perform = Counting()
    steps = list(execute(SUITE, tmp_path, perform=perform))
    assert steps == [(k, 4) for k in range(5)]
    assert sorted(perform.asked) == sorted(spec.key for spec in SUITE.runs())
    first = rows(tmp_path)[0]
    assert {"revision", "version", "numpy", "seed", "strategy", "map_seed"} <= first.keys()


def test_results_are_not_overwritten(tmp_path: Path) -> None:
    list(execute(SUITE, tmp_path, perform=Counting()))
    with pytest.raises(FileExistsError, match="--resume"):
        list(execute(SUITE, tmp_path, perform=Counting()))


def test_resume_after_a_kill_does_the_rest(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        list(execute(SUITE, tmp_path, perform=Counting(breaks_at=3)))
    journal = tmp_path / JOURNAL
    journal.write_text(journal.read_text(encoding="utf-8") + '{"key": "cut o', encoding="utf-8")
    again = Counting()
    steps = list(execute(SUITE, tmp_path, resume=True, perform=again))
    assert steps[0] == (2, 4)
    assert len(again.asked) == 2
    assert len(rows(tmp_path)) == 4


def test_a_crash_is_a_row(tmp_path: Path) -> None:
    missing = MapEntry(name="m", scenario=tmp_path / "none.toml")
    suite = SUITE.model_copy(update={"maps": (missing,), "limits": Limits(wall_s=60)})
    row = run_in_process(suite, suite.runs()[0])
    assert row["status"] == "crashed"
    assert "none.toml" in row["reason"]


def test_a_run_that_takes_too_long_is_killed() -> None:
    hospital = Path(scenarios.__file__).parent / "disaster" / "hospital.toml"
    long = MapEntry(name="m", scenario=hospital)
    suite = SUITE.model_copy(update={"maps": (long,), "limits": Limits(wall_s=0.3)})
    assert run_in_process(suite, suite.runs()[0])["status"] == "killed"


def test_a_published_table_is_continued(tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    with pytest.raises(KeyboardInterrupt):
        list(execute(SUITE, first, perform=Counting(breaks_at=4)))
    write(findings(SUITE, rows(first)), first)
    second.mkdir()
    (second / TABLE).write_bytes((first / TABLE).read_bytes())
    assert rows(second) == rows(first)
    assert [list(row) for row in rows(second)] == [list(row) for row in rows(first)]
    with pytest.raises(FileExistsError, match="--resume"):
        list(execute(SUITE, second, perform=Counting()))
    again = Counting()
    assert list(execute(SUITE, second, resume=True, perform=again)) == [(3, 4), (4, 4)]
    done = {row["key"] for row in rows(first)}
    assert again.asked == [spec.key for spec in SUITE.runs() if spec.key not in done]
    assert len(rows(second)) == 4


def test_a_table_may_hold_real_maps_and_rows_cut_off(tmp_path: Path) -> None:
    real = SUITE.model_copy(update={"maps": (MapEntry(name="m", scenario=Path("m.toml")),)})
    list(execute(real, tmp_path, perform=Counting()))
    whole = rows(tmp_path)
    write(findings(real, whole), tmp_path)
    (tmp_path / JOURNAL).unlink()
    assert [{**row, "map_seed": None} for row in whole] == rows(tmp_path)
    table = tmp_path / TABLE
    table.write_text(table.read_text(encoding="utf-8")[:-80], encoding="utf-8")
    assert rows(tmp_path) == whole[:-1]
    findings(real, rows(tmp_path))


def test_a_table_of_something_else_is_no_result(tmp_path: Path) -> None:
    (tmp_path / TABLE).write_text("name,amount\nscrews,12\n", encoding="utf-8")
    assert rows(tmp_path) == []
