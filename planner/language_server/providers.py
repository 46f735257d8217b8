"""Which attachments are installed, found by entry points: this room imports none of them."""

from dataclasses import dataclass
from importlib.metadata import entry_points

GROUP = "marsupial.attachments"


@dataclass(frozen=True)
class Providers:
    """Names of the installed attachments, None where they are not known."""

    names: list[str] | None
    fault: str | None = None
    """Why they are not known, in one sentence."""


def providers_for(domain_text: bytes) -> Providers:
    """The attachments that a domain could call.

    Loading attachments can take a second, so they are loaded only for domains with modules. One
    that cannot be loaded is no reason to stop: then nobody is reported as missing.
    """
    if b":modules" not in domain_text.lower():
        return Providers(None)
    points = sorted(entry_points(group=GROUP), key=lambda point: point.name)
    names: set[str] = set()
    for point in points:
        try:
            names.update(attachment.name for attachment in point.load())
        except Exception as error:  # somebody else's code: whatever it raises
            reason = f"{type(error).__name__}: {error}"
            return Providers(None, f"attachments {point.value} cannot be loaded ({reason})")
    return Providers(sorted(names) if points else None)
