"""Attachments: distances, all pairs, replanning, share of planning time, motions.

Times are CPU seconds of one process unless a column says otherwise; what counts are ratios measured
in the same run.
"""

from pathlib import Path

from scenarios.benchmarks.attachments import all_pairs, motion, one_to_all, planning, replanning


def run(*, quick: bool, out: Path) -> str:
    """Measures everything; the tables also go to `attachments.md` in the folder `out`."""
    parts = [
        part.run(quick=quick) for part in (one_to_all, all_pairs, replanning, planning, motion)
    ]
    report = "\n\n".join(parts) + "\n"
    out.mkdir(parents=True, exist_ok=True)
    (out / "attachments.md").write_text(report, encoding="utf-8")
    return report
