"""Work for workers that misbehaves in every way; importable in a worker."""

import os
import signal
import time
from dataclasses import dataclass

from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap
from service.jobs.executor import Tell
from service.tracing import trace_id


@dataclass(frozen=True)
class OddWork:
    """What a test wants a worker to do."""

    what: str = "answer"
    affinity: str | None = None
    hard_limit_s: float = 30.0
    grid: GridMap | None = None
    size_mb: int = 0
    name: str = ""
    traceparent: str | None = None

    def answer(self, tell: Tell, memory: Memory) -> None:
        match self.what:
            case "die":
                os.kill(os.getpid(), signal.SIGKILL)
            case "hang":
                tell({"kind": "plan"})
                time.sleep(600)
            case "hang with the interpreter":
                tell({"kind": "plan"})
                sum(range(10**12))
            case "hoard":
                try:
                    hoard = bytearray(self.size_mb * 2**20)
                    tell({"kind": "finished", "size": len(hoard)})
                except MemoryError:
                    tell({"kind": "failed", "outcome": "out_of_memory"})
                return
        before = memory.get("count", int) or 0
        memory.keep("count", before + 1)
        tell(
            {
                "kind": "finished",
                "pid": os.getpid(),
                "before": before,
                "grid": None if self.grid is None else self.grid.digest,
                "name": self.name,
                "trace": trace_id(),
            }
        )
