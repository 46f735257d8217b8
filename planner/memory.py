"""Memory of this process."""

import resource
import sys


def peak_mb() -> float:
    """The most memory that this process has held at once [MiB]."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(peak / (1 << 20 if sys.platform == "darwin" else 1 << 10), 1)
