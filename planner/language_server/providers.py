"""Which attachments are installed, found by entry points: this room imports none of them."""

from importlib.metadata import entry_points
from pathlib import Path

GROUP = "marsupial.attachments"


def installed_providers(domain: Path) -> list[str] | None:
    """Names of the installed attachments; None where the domain needs none or none are declared.

    Loading attachments can take a second, so they are loaded only for domains with modules.
    """
    try:
        needed = b":modules" in domain.read_bytes().lower()
    except OSError:
        return None
    return provider_names() if needed else None


def provider_names() -> list[str] | None:
    """Names of all installed attachments, None if no package declares any."""
    points = sorted(entry_points(group=GROUP), key=lambda point: point.name)
    if not points:
        return None
    return sorted({attachment.name for point in points for attachment in point.load()})
