"""Motions by OMPL: durations on open maps, gaps, a problem with 30 robots and targets."""

from math import inf, isfinite
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage
from time import perf_counter

import numpy as np

from scenarios.benchmarks.attachments.hospital import hospital_world
from scenarios.benchmarks.attachments.measuring import table
from semantic_attachments.lazy import solve_lazily
from semantic_attachments.motion import MotionCosts, MotionWorkers
from semantic_attachments.motion_parameters import MotionParameters
from semantic_attachments.motion_space import quiet_and_seeded
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.roadmap import Roadmap
from semantic_attachments.robot_class import GridParameters
from semantic_attachments.world import GridMap, Location, RobotModel, World

SEED = 5

DOMAIN = """
(define (domain visits)
  (:requirements :typing :durative-actions :negative-preconditions)
  (:types robot location - object target - location)
  (:modules (motionCost ?r - robot ?s ?g - location cost motionCost@libmotion.so))
  (:predicates (at ?r - robot ?x - location) (visited ?x - target))
  (:durative-action visit
    :parameters (?r - robot ?s - location ?g - target)
    :duration (= ?duration [motionCost ?r ?s ?g])
    :condition (and (at start (at ?r ?s)) (at start (not (visited ?g))))
    :effect (and (at start (not (at ?r ?s))) (at end (at ?r ?g)) (at start (visited ?g)))))
"""


def run(*, quick: bool) -> str:
    """Three tables."""
    quiet_and_seeded(SEED)
    return "\n\n".join([open_map(quick), gaps(quick), many_robots(quick)])


def car(kinematics: str, width_m: float) -> RobotModel:
    """A robot 0.9 m long."""
    x, y = 0.45, width_m / 2
    corners = ((-x, -y), (x, -y), (x, y), (-x, y))
    return RobotModel(
        kinematics, y, 1.0, kinematics=kinematics, footprint_m=corners, turning_radius_m=0.8
    )


def open_map(quick: bool) -> str:
    """Durations of a point robot over those of the grid."""
    rng = np.random.default_rng(SEED)
    grid = GridMap(np.zeros((200, 200), np.int8), resolution_m=0.1)
    positions = rng.uniform(1, 19, (4 if quick else 10, 2)).tolist()
    places = {f"place_{i}": Location((x, y)) for i, (x, y) in enumerate(positions)}
    point = RobotModel("point", radius_m=0.0, speed_m_s=1.0)
    calls = [("robot", a, b) for a in places for b in places if a < b]
    world = World(grid, places, {"robot": point})
    lines = np.array(PathCosts(world, GridParameters(any_angle=True)).many(calls))
    steps = np.array(PathCosts(world).many(calls))
    roadmap = Roadmap(point, grid, MotionParameters())
    motions = np.array(
        [
            roadmap.motions(places[a].position_m, [places[b].position_m], [])[0].duration_s
            for _, a, b in calls
        ]
    )
    rows = [
        [name, len(calls), float(ratio.min()), float(ratio.mean()), float(ratio.max())]
        for name, ratio in (("any angle", motions / lines), ("8-connected", motions / steps))
    ]
    columns = ["grid", "pairs", "least ratio", "mean ratio", "largest ratio"]
    return table("Point robot on an open map: motion / grid", columns, rows)


def gaps(quick: bool) -> str:
    """Reeds-Shepp robots before gaps of many widths."""
    rows = []
    for width_m in (0.5, 0.7):
        narrow, wide = [0, 0], [0, 0]
        for cells in range(3, 15, 4 if quick else 1):
            grid_cells = np.zeros((60, 80), np.int8)
            grid_cells[:, 40] = 100
            grid_cells[30 : 30 + cells, 40] = 0
            grid = GridMap(grid_cells, resolution_m=0.1)
            model = car("reeds-shepp", width_m)
            roadmap = Roadmap(model, grid, MotionParameters(seed=SEED, budget_s=0.5))
            (motion,) = roadmap.motions((1.0, 3.0), [(7.0, 3.0)], [])
            count = narrow if cells * 0.1 < width_m - 1e-9 else wide
            count[0] += 1
            count[1] += isfinite(motion.duration_s)
        rows.append([width_m, *narrow, *wide])
    columns = ["robot's width [m]", "narrower gaps", "passed", "wide enough", "passed"]
    return table("Reeds-Shepp robots and gaps", columns, rows)


def many_robots(quick: bool) -> str:
    """10 robots of two models and 20 targets in the hospital, durations refined where plans need
    it."""
    quiet_and_seeded(SEED)
    grid = hospital_world().grid
    rng = np.random.default_rng(SEED)
    fitting = Roadmap(car("reeds-shepp", 0.6), grid, MotionParameters(seed=SEED))
    robots, targets = (2, 4) if quick else (10, 20)
    trials = [fitting.random_pose(rng)[:2] for _ in range(2 * (robots + targets))]
    motions = fitting.motions(trials[0], trials, [])
    reached = [
        spot for spot, motion in zip(trials, motions, strict=True) if motion.duration_s < inf
    ]
    places = {
        (f"start_{i}" if i < robots else f"target_{i - robots}"): Location(position_m)
        for i, position_m in enumerate(reached[: robots + targets])
    }
    models = {f"robot_{i}": car("reeds-shepp" if i % 2 else "se2", 0.6) for i in range(robots)}
    world = World(grid, places, models)
    problem = f"""
    (define (problem many) (:domain visits)
      (:objects {" ".join(models)} - robot {" ".join(p for p in places if p[0] == "s")} - location
                {" ".join(p for p in places if p[0] == "t")} - target)
      (:init {" ".join(f"(at robot_{i} start_{i})" for i in range(robots))})
      (:goal (and {" ".join(f"(visited {p})" for p in places if p[0] == "t")}))
      (:metric minimize (total-time)))"""
    workers, begun_cpu_s = MotionWorkers(MotionParameters()), _cpu_s()
    rows = []
    for name in ("cold", "roadmaps kept"):
        costs = MotionCosts(world, workers)
        begun_s = perf_counter()
        found = solve_lazily(DOMAIN, problem, {"motionCost": costs}, timeout_s=6.0, seed=SEED)
        wall_s = perf_counter() - begun_s
        plan = found.result.plan
        makespan_s = plan.makespan if plan else inf
        rows.append([name, wall_s, found.exact, found.rounds, found.refined, makespan_s])
    workers.close()
    lazy_cpu_s, begun_cpu_s, begun_s = _cpu_s() - begun_cpu_s, _cpu_s(), perf_counter()
    costs = MotionCosts(world, workers)
    targets_at = [place for place in places if place[0] == "t"]
    calls = [(robot, a, b) for robot in models for a in places for b in targets_at]
    durations_s = costs.many(calls)
    all_s = perf_counter() - begun_s
    some = calls[: len(targets_at)]
    again = MotionCosts(world, workers)
    begun_s = perf_counter()
    again.many(some)
    query_ms = (perf_counter() - begun_s) / len(some) * 1e3
    workers.close()
    columns = ["workers", "wall [s]", "true durations", "rounds", "motions planned", "makespan [s]"]
    title = f"Planning with OMPL's durations, hospital, {robots} robots and {targets} targets"
    finite = sum(duration_s < inf for duration_s in durations_s)
    return (
        f"{table(title, columns, rows)}\n\n"
        f"Anytime, 6 s each; CPU of both with their worker processes {lazy_cpu_s:.3g} s. "
        f"All {len(calls)} calls at once, cold ({finite} finite): {all_s:.3g} s, "
        f"{_cpu_s() - begun_cpu_s:.3g} s CPU. A query again: {query_ms:.1f} ms."
    )


def _cpu_s() -> float:
    """CPU time of this process and of those it waited for [s]."""
    own, others = getrusage(RUSAGE_SELF), getrusage(RUSAGE_CHILDREN)
    return own.ru_utime + own.ru_stime + others.ru_utime + others.ru_stime
