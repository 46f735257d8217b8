"""What a server's processes use, as Linux counts it in /proc."""

import os
from contextlib import suppress
from pathlib import Path

PROC = Path("/proc")


def family(pid: int) -> list[int]:
    """A process and all that descend from it."""
    found = [pid]
    for parent in found:  # grows while it is walked
        with suppress(OSError):
            for task in (PROC / str(parent) / "task").iterdir():
                children = (task / "children").read_text(encoding="ascii").split()
                found += [int(child) for child in children]
    return found


def cpu_s(pid: int) -> float:
    """Processor time of a process [s]; 0 if it has ended."""
    with suppress(OSError):
        fields = (PROC / str(pid) / "stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return 0.0


def resident_mb(pid: int) -> float:
    """Memory of a process that is in RAM [MiB]; 0 if it has ended."""
    with suppress(OSError):
        pages = int((PROC / str(pid) / "statm").read_text(encoding="ascii").split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 2**20
    return 0.0
