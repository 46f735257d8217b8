"""Sequential single-item auctions against the paper's rule, worked by hand and by recomputation."""

import itertools
from collections.abc import Sequence
from math import inf

import numpy as np
import pytest

from service.coordination.auction import auction


class Plane:
    """Travel at 1 m/s in a plane without obstacles."""

    def __init__(self, robots: np.ndarray, goals: np.ndarray, sealed: Sequence[int] = ()) -> None:
        self.robots, self.goals, self.sealed = robots, goals, set(sealed)
        self.going: dict[str, str] = {}

    def times_s(self, robots: Sequence[str], goals: Sequence[str]) -> list[list[float]]:
        return [[self._time_s(self.robots[int(r)], int(g)) for g in goals] for r in robots]

    def times_between_s(self, _robot: str, starts: Sequence[str], goal: str) -> list[float]:
        return [self._time_s(self.goals[int(start)], int(goal)) for start in starts]

    def _time_s(self, place: np.ndarray, goal: int) -> float:
        return inf if goal in self.sealed else float(np.linalg.norm(place - self.goals[goal]))


def first_goals(plane: Plane, *, share: bool = False) -> dict[int, int]:
    robots = [str(i) for i in range(len(plane.robots))]
    goals = [str(i) for i in range(len(plane.goals))]
    return auction(plane, robots, goals, share=share)  # type: ignore[arg-type]


def test_robots_part_where_greed_would_send_both_to_the_same_side() -> None:
    # Both robots are nearest to the goals on the right; the first to win them leaves the left.
    plane = Plane(np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([[4.0, 0.0], [5.0, 0.0], [-6.0, 0]]))
    assert first_goals(plane) == {1: 0, 0: 2}


def test_what_nobody_can_reach_is_nobodys() -> None:
    plane = Plane(np.zeros((2, 2)), np.array([[1.0, 0.0], [2.0, 0.0]]), sealed=[0, 1])
    assert first_goals(plane) == {}


def test_robots_left_over_share_a_goal() -> None:
    plane = Plane(np.array([[0.0, 0.0], [9.0, 0.0]]), np.array([[1.0, 0.0]]))
    assert first_goals(plane) == {0: 0}
    assert first_goals(plane, share=True) == {0: 0, 1: 0}


@pytest.mark.parametrize("seed", range(20))
def test_the_rule_of_the_paper(seed: int) -> None:
    """The same allocation from a plain transcription that remembers nothing between rounds."""
    random = np.random.default_rng(seed)
    plane = Plane(random.uniform(0, 50, (3, 2)), random.uniform(0, 50, (6, 2)))
    paths: list[list[int]] = [[], [], []]

    def length(robot: int, path: Sequence[int]) -> float:
        places = [plane.robots[robot], *(plane.goals[goal] for goal in path)]
        return sum(float(np.linalg.norm(a - b)) for a, b in itertools.pairwise(places))

    left = set(range(6))
    while left:
        _, robot, goal, place = min(
            (length(robot, [*path[:place], goal, *path[place:]]), robot, goal, place)
            for robot, path in enumerate(paths)
            for goal in left
            for place in range(len(path) + 1)
        )
        paths[robot].insert(place, goal)
        left.discard(goal)
    assert first_goals(plane) == {robot: path[0] for robot, path in enumerate(paths) if path}


@pytest.mark.parametrize("seed", range(40))
def test_robots_that_bid_anew_all_the_time_get_everywhere(seed: int) -> None:
    """An auction after every metre: nobody turns to and fro between two goals for ever."""
    random = np.random.default_rng(seed)
    plane = Plane(random.uniform(0, 50, (1, 2)), random.uniform(0, 50, (9, 2)))
    for _ in range(500):
        first = first_goals(plane)
        if not first:
            break
        plane.going = {str(robot): str(goal) for robot, goal in first.items()}
        for robot, goal in first.items():
            way = plane.goals[goal] - plane.robots[robot]
            far = float(np.linalg.norm(way))
            plane.robots[robot] += way * min(1.0, 1.0 / max(far, 1e-9))
            if far <= 1.0:
                plane.sealed.add(goal)
    assert plane.sealed == set(range(9))


def test_a_robot_keeps_the_goal_it_drives_to_unless_another_path_is_much_shorter() -> None:
    plane = Plane(np.array([[0.0, 0.0]]), np.array([[5.0, 0.0], [-4.8, 0.0]]))
    assert first_goals(plane) == {0: 1}
    plane.going = {"0": "0"}
    assert first_goals(plane) == {0: 0}  # 15.0 m, where the other order has 14.6 m
    plane.goals[1] = [-2.0, 0.0]
    assert first_goals(plane) == {0: 1}  # 9.0 m instead of 12.0 m


def test_of_two_that_drive_to_one_goal_the_nearer_keeps_it() -> None:
    goals = np.array([[9.0, 0.0], [-9.0, 0.0]])
    plane = Plane(np.array([[0.0, 0.0], [1.0, 0.0]]), goals)
    plane.going = {"0": "0", "1": "0"}
    assert first_goals(plane) == {0: 1, 1: 0}
