"""The closing table of a mission on the terminal."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from scenarios.mission_record import MissionRecord
from scenarios.report.markup import clock


def print_table(record: MissionRecord, console: Console | None = None) -> None:
    """Prints the mission's figures and one line for each robot."""
    console = console or Console()
    console.print()
    figures = Table(show_header=False, box=None, pad_edge=False)
    for name, value in figures_of(record):
        figures.add_row(name, value)
    console.print(figures)
    console.print()
    robots = Table(box=None, pad_edge=False, header_style="bold")
    robots.add_column("robot")
    for name in ("driven", "driving", "clearing", "targets", "cleared"):
        robots.add_column(name, justify="right")
    for robot in record.robots:
        robots.add_row(
            robot.id,
            f"{robot.distance_m:.0f} m",
            clock(robot.spent_s("explore", "move")),
            clock(robot.spent_s("clear")),
            str(sum(target.visited_by == robot.id for target in record.targets)),
            str(sum(blockade.cleared_by == robot.id for blockade in record.blockades)),
        )
    console.print(robots)
    console.print()


def figures_of(record: MissionRecord) -> list[tuple[str, str]]:
    """Name and value of what to know about a mission."""
    visited = len(record.targets) - record.targets_left
    return [
        ("mission", f"{record.scenario}: {record.status} ({record.strategy})"),
        ("mission time", f"{clock(record.duration_s)} simulated, {record.wall_s:.1f} s computed"),
        ("targets", f"{visited} of {len(record.targets)} visited")
        if record.known_share is None
        else ("map", f"{record.known_share:.1%} known, from {visited} frontiers"),
        (
            "blockades",
            f"{record.blockades_seen} of {len(record.blockades)} met, "
            f"{record.blockades_cleared} cleared; "
            f"{record.sealed_fraction:.0%} of the targets were sealed",
        ),
        (
            "replans",
            f"{record.replans}, {record.replans_for_blockades} of them for a blockade just seen",
        ),
        (
            "plans",
            f"{record.plans_accepted} of {len(record.plans)} accepted by the validator"
            if record.plans_accepted
            else "one-step orders, nothing to validate",
        ),
        (
            "collisions",
            f"{record.wall_collisions} with walls, {record.robot_collisions} between robots",
        ),
        ("driven", f"{record.distance_m:.0f} m by all robots"),
        *_beliefs(record),
    ]


def _beliefs(record: MissionRecord) -> list[tuple[str, str]]:
    if record.pose_error_m is None:
        return []
    mean_m, most_m = record.pose_error_m
    return [("beliefs", f"off by {mean_m:.3f} m on average, {most_m:.2f} m at most")]
