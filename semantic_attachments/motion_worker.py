"""A process of its own for the motions of one robot model: OMPL's binding holds the interpreter's
lock while it plans.

The parent sends pickled questions to the worker's standard input and reads pickled answers from its
standard output, each after its length. The worker ends with its input.
"""

import os
import pickle
import select
import struct
import subprocess
import sys
import weakref
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from time import monotonic
from typing import IO, Any

from semantic_attachments.contract import EvaluationError
from semantic_attachments.grid_map import GridMap, PositionM
from semantic_attachments.motion_parameters import MotionParameters
from semantic_attachments.motion_space import quiet_and_seeded
from semantic_attachments.roadmap import Roadmap
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.world import Blockade

_LENGTH = struct.Struct("<Q")
_MAPS = 2
"""Roadmaps that a worker keeps, the latest."""


@dataclass(frozen=True, slots=True)
class Query:
    """Durations wanted from one place, with some blockades closed, or whole motions."""

    start_m: PositionM
    goals_m: tuple[PositionM, ...]
    closed: tuple[Blockade, ...]
    whole: bool = False
    """Whether the poses of motions are wanted."""


class MotionWorker:
    """The parent's end. `ask` and `answer` come in pairs, so that several workers plan at once."""

    def __init__(self, model: RobotModel, parameters: MotionParameters) -> None:
        path = os.pathsep.join(entry for entry in sys.path if entry)
        self._process = subprocess.Popen(
            [sys.executable, "-m", "semantic_attachments.motion_worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": path},
        )
        self._known: str | None = None
        self.close = weakref.finalize(self, _stop, self._process)
        self._send((model, parameters))

    @property
    def alive(self) -> bool:
        """Whether it can be asked."""
        return self.close.alive and self._process.poll() is None

    def ask(self, grid: GridMap, queries: Sequence[Query]) -> None:
        """Starts planning."""
        self._send((None if grid.digest == self._known else grid, tuple(queries)))
        self._known = grid.digest

    def answer(self, deadline: float) -> list[list[Any]]:
        """The durations [s], or motions, asked for; one list a query.

        Raises:
            EvaluationError: if the worker failed, or did not answer before the monotonic deadline.
        """
        stdout = self._process.stdout
        assert stdout is not None
        ready, _, _ = select.select([stdout], [], [], max(deadline - monotonic(), 0.0))
        answer = _receive(stdout) if ready else None
        if answer is None:
            self.close()
            reason = "its worker process ended" if ready else "its worker process took too long"
            raise EvaluationError(f"motion planning failed: {reason}")
        if isinstance(answer, str):
            raise EvaluationError(f"motion planning failed: {answer}")
        found: list[list[Any]] = answer
        return found

    def _send(self, message: Any) -> None:
        stdin = self._process.stdin
        assert stdin is not None
        try:
            _write(stdin, message)
        except OSError as error:
            self.close()
            raise EvaluationError(f"motion planning failed: {error}") from error


def _stop(process: "subprocess.Popen[bytes]") -> None:
    process.kill()
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with suppress(OSError):  # what was not flushed is not wanted any more
                stream.close()
    process.wait()


def _write(stream: IO[bytes], message: Any) -> None:
    content = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(_LENGTH.pack(len(content)) + content)
    stream.flush()


def _receive(stream: IO[bytes]) -> Any:
    head = stream.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        return None
    content = stream.read(_LENGTH.unpack(head)[0])
    return pickle.loads(content)


def serve(questions: IO[bytes], answers: IO[bytes]) -> None:
    """The worker's end: answers until its input ends."""
    model, parameters = _receive(questions)
    quiet_and_seeded(parameters.seed)
    roadmaps: dict[str, Roadmap] = {}
    roadmap: Roadmap | None = None
    while (question := _receive(questions)) is not None:
        grid, queries = question
        try:
            if grid is not None:
                roadmap = roadmaps.pop(grid.digest, None) or Roadmap(model, grid, parameters)
                roadmaps[grid.digest] = roadmap
                for digest in list(roadmaps)[:-_MAPS]:
                    del roadmaps[digest]
            assert roadmap is not None
            found: Any = [_answer(roadmap, query) for query in queries]
        except Exception as error:
            found = f"{type(error).__name__}: {error}"
        _write(answers, found)


def _answer(roadmap: Roadmap, query: Query) -> Sequence[Any]:
    ask = roadmap.motions if query.whole else roadmap.durations_s
    return ask(query.start_m, query.goals_m, query.closed)


if __name__ == "__main__":
    # What libraries print must not get between the answers.
    with os.fdopen(os.dup(1), "wb") as channel:
        os.dup2(2, 1)
        serve(sys.stdin.buffer, channel)
        channel.flush()
    # The binding reports leaks at a regular exit; nothing is left to clean up.
    os._exit(0)
