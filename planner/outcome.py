"""How a planning run ended: one table for exit codes, HTTP status codes and documentation.

Exit codes follow Fast Downward's decades: 0 plan found, 1-3 plan found and then a limit hit,
10-12 unsolvable or exhausted, 20-24 limits, 30-37 faults.
"""

from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import Final


class Outcome(StrEnum):
    """How a run ended. Outcomes are values; the faults at the end of the list are raised as
    exceptions.
    """

    SOLVED_OPTIMALLY = "solved_optimally"
    SOLVED = "solved"
    SOLVED_OUT_OF_MEMORY = "solved_out_of_memory"
    SOLVED_TIMED_OUT = "solved_timed_out"
    SOLVED_CANCELLED = "solved_cancelled"
    PROVEN_UNSOLVABLE = "proven_unsolvable"
    EXHAUSTED = "exhausted"
    OUT_OF_MEMORY = "out_of_memory"
    TIMED_OUT = "timed_out"
    OUT_OF_NODES = "out_of_nodes"
    CANCELLED = "cancelled"
    INTERNAL_ERROR = "internal_error"
    INPUT_ERROR = "input_error"
    UNSUPPORTED = "unsupported"
    ATTACHMENT_ERROR = "attachment_error"

    @property
    def row(self) -> "OutcomeRow":
        """Its row of the table."""
        return OUTCOMES[self]

    @property
    def solved(self) -> bool:
        """Whether there is a plan."""
        return self.row.exit_code <= 3


@dataclass(frozen=True, slots=True)
class OutcomeRow:
    """What an outcome means outside the planner."""

    exit_code: int
    """Of the `marsupial` command."""
    http_status: int
    """Of the service: 200 whenever the planner did its work, whatever it found."""
    meaning: str


OUTCOMES: Final = MappingProxyType(
    {
        Outcome.SOLVED_OPTIMALLY: OutcomeRow(0, 200, "the best plan found is proved optimal"),
        Outcome.SOLVED: OutcomeRow(0, 200, "a plan was found and the search ended by itself"),
        Outcome.SOLVED_OUT_OF_MEMORY: OutcomeRow(
            1, 200, "a plan was found, then the memory or node limit was hit"
        ),
        Outcome.SOLVED_TIMED_OUT: OutcomeRow(
            2, 200, "a plan was found, then the time limit was hit"
        ),
        Outcome.SOLVED_CANCELLED: OutcomeRow(
            3, 200, "a plan was found, then somebody stopped the search"
        ),
        Outcome.PROVEN_UNSOLVABLE: OutcomeRow(11, 200, "no plan exists"),
        Outcome.EXHAUSTED: OutcomeRow(
            12, 200, "the search space is exhausted without a plan, but it is not complete here"
        ),
        Outcome.OUT_OF_MEMORY: OutcomeRow(22, 200, "the memory limit was hit without a plan"),
        Outcome.TIMED_OUT: OutcomeRow(23, 200, "the time limit was hit without a plan"),
        Outcome.OUT_OF_NODES: OutcomeRow(24, 200, "the node limit was hit without a plan"),
        Outcome.CANCELLED: OutcomeRow(20, 200, "somebody stopped the search before a plan"),
        Outcome.INTERNAL_ERROR: OutcomeRow(30, 500, "the planner failed; please report it"),
        Outcome.INPUT_ERROR: OutcomeRow(31, 422, "domain, problem, plan or options are wrong"),
        Outcome.UNSUPPORTED: OutcomeRow(34, 422, "the problem uses what this planner does not do"),
        Outcome.ATTACHMENT_ERROR: OutcomeRow(33, 502, "an attachment is missing or failed"),
    }
)
