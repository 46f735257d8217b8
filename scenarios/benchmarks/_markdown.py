"""Markdown tables."""

from collections.abc import Sequence


def table(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A titled table; floats with three significant digits."""
    lines = [f"### {title}", "", _row(columns), _row(["---"] * len(columns))]
    return "\n".join(lines + [_row([_shown(cell) for cell in row]) for row in rows])


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _shown(cell: object) -> str:
    return f"{cell:.3g}" if isinstance(cell, float) else str(cell)
