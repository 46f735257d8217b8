"""How motions are sought."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MotionParameters:
    """Parameters of a roadmap and of the planners that help it."""

    seed: int = 0
    """Seed of all random numbers."""
    spacing_m: float = 1.5
    """Mean distance of random poses on free ground [m]."""
    most_samples: int = 2000
    """Limit of their number."""
    headings: int = 8
    """Headings tried at each place."""
    most_neighbours: int = 12
    """Limit of the number of neighbours of a vertex."""
    budget_s: float = 0.5
    """Time RRT-Connect has for a pair of places that the roadmap does not connect [s]."""
    improvement_s: float = 0.2
    """Time BIT* has to find a shorter motion than RRT-Connect did; 0 for none [s]."""
    unknown_is_free: bool = False
    """Whether robots are expected to get through unknown cells (optimistic)."""
