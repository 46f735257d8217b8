"""The figures of a mission: headline numbers, robots, targets, decisions."""

from __future__ import annotations

from html import escape

from scenarios.mission_record import MissionRecord
from scenarios.report.markup import clock, element, row


def headline(record: MissionRecord) -> str:
    """The numbers to see first."""
    visited = len(record.targets) - record.targets_left
    figures = [
        (
            clock(record.duration_s),
            "mission time",
            "min:s" + ("" if record.mission else ", simulated"),
        ),
        (f"{visited} / {len(record.targets)}", "targets visited", ""),
        (
            f"{record.blockades_seen} / {len(record.blockades)}",
            "blockades met",
            f"{record.blockades_cleared} cleared",
        ),
        (str(record.replans), "replans", f"{len(record.plans)} plans put in force"),
        (
            f"{record.plans_accepted} / {len(record.plans)}" if record.plans_accepted else "–",
            "plans accepted by the validator",
            f"{record.one_step_plans} one-step orders" if record.one_step_plans else "",
        ),
        (f"{record.distance_m:.0f} m", "driven by all robots", ""),
    ]
    if record.mission is None:
        touches = record.wall_collisions + record.robot_collisions
        figures.append((str(touches), "collisions", "walls and robots"))
    return element(
        "dl",
        "".join(
            f"<div><dd>{escape(value)}</dd><dt>{escape(name)}</dt>"
            + (f'<dd class="note">{escape(note)}</dd>' if note else "")
            + "</div>"
            for value, name, note in figures
        ),
        class_="headline",
    )


def robots(record: MissionRecord) -> str:
    """One row for each robot: how it spent its time."""
    rows = []
    for index, robot in enumerate(record.robots):
        driving = robot.spent_s("explore", "move")
        clearing = robot.spent_s("clear")
        other = robot.spent_s("dock", "undock", "docked")
        idle = max(0.0, record.duration_s - driving - clearing - other)
        visits = sum(target.visited_by == robot.id for target in record.targets)
        cleared = sum(blockade.cleared_by == robot.id for blockade in record.blockades)
        rows.append(
            row(
                [
                    f'<span class="swatch robot-{index % 8}"></span>{escape(robot.id)}',
                    escape(robot.type),
                    f"{robot.distance_m:.0f} m",
                    clock(driving),
                    clock(clearing),
                    clock(idle),
                    str(visits),
                    str(cleared),
                ]
            )
        )
    head = ["robot", "type", "driven", "driving", "clearing", "waiting", "targets", "cleared"]
    return _table(head, rows, "numbers-from-3")


def targets(record: MissionRecord) -> str:
    """Targets in the order of their visits."""
    ordered = sorted(
        record.targets, key=lambda t: (t.visited_at_s is None, t.visited_at_s or 0.0, t.id)
    )
    names = [robot.id for robot in record.robots]
    rows = [
        row(
            [
                escape(target.id),
                clock(target.visited_at_s),
                _robot(target.visited_by, names),
            ]
        )
        for target in ordered
    ]
    return _table(["target", "visited at", "by"], rows)


def blockades(record: MissionRecord) -> str:
    """Blockades in the order in which the fleet met them."""
    ordered = sorted(
        record.blockades, key=lambda b: (b.seen_at_s is None, b.seen_at_s or 0.0, b.id)
    )
    names = [robot.id for robot in record.robots]
    rows = [
        row(
            [
                escape(blockade.id),
                clock(blockade.seen_at_s),
                clock(blockade.cleared_at_s),
                _robot(blockade.cleared_by, names),
            ]
        )
        for blockade in ordered
    ]
    return _table(["blockade", "seen at", "cleared at", "by"], rows)


def decisions(record: MissionRecord) -> str:
    """Every replan with its reason, and the plan it led to."""
    plan_at = {plan.revision: plan for plan in record.plans}
    rows = []
    for decision in record.decisions:
        plan = plan_at.get(decision.revision)
        ends = clock(plan.makespan_s) if plan else "–"
        verdict = "–" if plan is None else ("accepted" if plan.validated else "one-step orders")
        rows.append(
            row(
                [
                    clock(decision.time_s),
                    escape(decision.kind),
                    escape(decision.reason),
                    str(decision.revision),
                    ends,
                    verdict,
                ]
            )
        )
    head = ["time", "decision", "reason", "revision", "planned end", "validator"]
    return _table(head, rows)


def _robot(name: str | None, names: list[str]) -> str:
    if name is None:
        return "–"
    index = names.index(name) % 8 if name in names else 0
    return f'<span class="swatch robot-{index}"></span>{escape(name)}'


def _table(head: list[str], rows: list[str], class_: str | None = None) -> str:
    body = f"<thead>{row(map(escape, head), 'th')}</thead><tbody>{''.join(rows)}</tbody>"
    return element("div", element("table", body, class_=class_), class_="scroll")
