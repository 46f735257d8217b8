"""What a search has proved where attachments do not answer exactly.

An attachment may say how its values relate to the true ones by an attribute `quality`:

| quality | no plan | lower bound | best plan |
|---|---|---|---|
| `exact`, or none given | proved | holds | proved optimal |
| `lower bound`: never above the true value | proved | holds | not proved: it may take longer |
| `approximate` | not proved | unknown | not proved |
"""

from collections.abc import Iterable

from planner.attachments import Attachments
from planner.outcome import Outcome
from planner.reading import InputError

QUALITIES = ("exact", "lower bound", "approximate")
"""From what proves most to what proves least."""


def weakest_quality(attachments: Attachments | None, modules: Iterable[str]) -> str:
    """The quality of what a domain's modules are answered with.

    Raises:
        InputError: for one that there is not.
    """
    names = {name.lower() for name in modules}
    given = [
        str(getattr(attachment, "quality", QUALITIES[0]))
        for name, attachment in (attachments or {}).items()
        if name.lower() in names
    ]
    for quality in given:
        if quality not in QUALITIES:
            raise InputError(
                f"an attachment's quality is {quality!r}; it is one of {', '.join(QUALITIES)}"
            )
    return max(given, key=QUALITIES.index, default=QUALITIES[0])


def proved(outcome: Outcome, lower_bound: float, quality: str) -> tuple[Outcome, float]:
    """The outcome and the lower bound that values of a quality allow."""
    if outcome is Outcome.SOLVED_OPTIMALLY and quality != "exact":
        outcome = Outcome.SOLVED
    if quality == "approximate":
        lower_bound = 0.0
        if outcome is Outcome.PROVEN_UNSOLVABLE:
            outcome = Outcome.EXHAUSTED
    return outcome, lower_bound
