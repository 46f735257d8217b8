"""Figures as SVG that are the same, to the byte, for the same numbers."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from scenarios.exit_codes import CommandError


@contextmanager
def figure(path: Path, panels: int = 1, width_in: float = 5.0) -> Iterator[Any]:
    """Axes to draw on, a list for several panels; written to `path` in the end."""
    try:
        import matplotlib as mpl
    except ImportError:
        raise CommandError("figures need matplotlib: pip install 'marsupial[results]'") from None
    mpl.use("Agg")
    from matplotlib import pyplot

    with mpl.rc_context({"svg.hashsalt": "marsupial", "font.size": 9, "svg.fonttype": "none"}):
        drawn, axes = pyplot.subplots(1, panels, figsize=(width_in * panels, 3.4))
        try:
            yield axes
            for axis in [axes] if panels == 1 else axes:
                axis.grid(visible=True, which="major", alpha=0.3)
                axis.spines[["top", "right"]].set_visible(False)
            drawn.tight_layout()
            path.parent.mkdir(parents=True, exist_ok=True)
            drawn.savefig(path, metadata={"Date": None})
        finally:
            pyplot.close(drawn)


def table(rows: list[list[str]]) -> str:
    """Rows, the first one the heads, as Markdown."""
    lines = [rows[0], ["---"] * len(rows[0]), *rows[1:]]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
