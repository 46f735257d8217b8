"""Small pieces of SVG and HTML."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

Attribute = str | float | int | None


def element(tag: str, content: str = "", **attributes: Attribute) -> str:
    """An element; `stroke_width` becomes `stroke-width`, `class_` `class`, None is left out."""
    written = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{_text(value)}"'
        for name, value in attributes.items()
        if value is not None
    )
    return f"<{tag}{written}>{content}</{tag}>" if content else f"<{tag}{written}></{tag}>"


def title(text: str) -> str:
    """A tooltip."""
    return f"<title>{escape(text)}</title>"


def row(cells: Iterable[str], cell: str = "td", **attributes: Attribute) -> str:
    """A table row of ready-made HTML."""
    return element("tr", "".join(f"<{cell}>{content}</{cell}>" for content in cells), **attributes)


def clock(time_s: float | None) -> str:
    """`m:ss` of a time in seconds, a dash for none."""
    if time_s is None:
        return "–"
    minutes, seconds = divmod(round(time_s), 60)
    return f"{minutes}:{seconds:02d}"


def _text(value: Attribute) -> str:
    if isinstance(value, float):
        return f"{value:.2f}".rstrip("0").rstrip(".")
    return escape(str(value))
