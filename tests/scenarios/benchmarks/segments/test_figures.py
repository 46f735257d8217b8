"""The figure of time saved."""

from xml.etree import ElementTree

from scenarios.batch.comparison import compare
from scenarios.benchmarks.segments.figures import improvement_figure


def test_a_point_for_each_team_and_strategy_filled_where_significant() -> None:
    rows = [
        {
            "map": "m",
            "team": f"{robots} robots",
            "seed": seed,
            "strategy": strategy,
            "status": "completed",
            "duration_s": 100.0 + seed - gain * (0.8 + 0.1 * (seed % 4)),
        }
        for robots in (2, 10)
        for seed in range(8)
        for strategy, gain in (("nearest", 0.0), ("segments", 20.0), ("greedy", 0.1 * (seed - 4)))
    ]
    comparisons = [c for arm in ("segments", "greedy") for c in compare(rows, arm, "nearest")]
    drawn = ElementTree.fromstring(improvement_figure("time saved", comparisons))
    circles = [e for e in drawn.iter() if e.tag.endswith("circle")]
    texts = [e.text for e in drawn.iter() if e.tag.endswith("text")]
    assert len(circles) == 4 + 2
    assert sum(circle.get("fill") == "white" for circle in circles) == 2
    assert texts.index("2 robots") < texts.index("10 robots")
    assert {"segments", "greedy", "0 %"} <= set(texts)
