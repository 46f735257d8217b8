"""CPU times and Markdown tables."""

from collections.abc import Callable, Sequence
from time import process_time
from typing import TypeVar

T = TypeVar("T")


def cpu_s(function: Callable[[], T], repeats: int = 1) -> tuple[float, T]:
    """The least CPU time of some runs [s], and the last result."""
    best_s = float("inf")
    while True:
        begun_s = process_time()
        result = function()
        best_s = min(best_s, process_time() - begun_s)
        repeats -= 1
        if repeats <= 0:
            return best_s, result


def table(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A titled Markdown table; numbers with three significant digits."""
    lines = [f"### {title}", "", _row(columns), _row(["---"] * len(columns))]
    return "\n".join(lines + [_row([_shown(cell) for cell in row]) for row in rows])


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _shown(cell: object) -> str:
    return f"{cell:.3g}" if isinstance(cell, float) else str(cell)
