"""A mission in memory together with its log, which it never gets ahead of.

Events are stored first and applied then, under one lock, so that the mission in memory never knows
more than its log.
"""

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager

from service.coordination.events import Event, MissionClosed, TerminalStatus
from service.coordination.history import apply, rebuilt
from service.coordination.mission import Mission
from service.coordination.ports import EventLog, StoreError

LATEST_KEPT = 32
"""Events of a mission that are kept for its listeners."""


class Ledger:
    """Changes one mission, event by event."""

    def __init__(self, mission: Mission, log: EventLog) -> None:
        self.mission = mission
        self._log = log
        self._lock = asyncio.Lock()
        self._in_doubt = False
        self._news = asyncio.Event()
        self._hushed = False
        self._latest: deque[tuple[int, Event]] = deque(maxlen=LATEST_KEPT)

    @asynccontextmanager
    async def locked(self) -> AsyncIterator[Mission]:
        """The mission, which nobody else changes meanwhile."""
        async with self._lock:
            if self._in_doubt:
                self.mission = await asyncio.to_thread(rebuilt, self._log.events(self.mission.id))
                self._latest.clear()  # a commit in doubt may be missing there
                self._in_doubt = False
            yield self.mission

    async def record(self, events: Sequence[Event]) -> None:
        """Stores events, then lets them happen; to be called under the lock.

        Raises:
            StoreError: they could not be stored, and nothing has happened.
        """
        try:
            await self._log.append(self.mission.id, self.mission.events, events)
        except StoreError:
            # A commit whose answer was lost may have happened: the log decides.
            self._in_doubt = True
            raise
        for event in events:
            self._latest.append((self.mission.events, event))
            apply(self.mission, event)
        self._news.set()
        self._news = asyncio.Event()

    def latest(self, first_number: int) -> list[tuple[int, Event]]:
        """The events from `first_number` on with their numbers; empty if they are not at hand.

        Listeners that keep up need no database.
        """
        if not self._latest or first_number < self._latest[0][0]:
            return []
        return [(number, event) for number, event in self._latest if number >= first_number]

    async def close(self, status: TerminalStatus, reason: str) -> None:
        """Ends the mission; to be called under the lock."""
        await self.record([MissionClosed(time_s=self.mission.time_s, status=status, reason=reason)])

    async def news(self, after: int, timeout_s: float) -> bool:
        """Waits until the mission has more than `after` events; false if it has not in time.

        Once the ledger is hushed nobody waits any more.
        """
        deadline = asyncio.get_running_loop().time() + timeout_s
        while self.mission.events <= after and not self._hushed:
            left_s = deadline - asyncio.get_running_loop().time()
            try:
                await asyncio.wait_for(self._news.wait(), max(left_s, 0.0))
            except TimeoutError:
                return False
        return self.mission.events > after

    def hush(self) -> None:
        """Sends all listeners away."""
        self._hushed = True
        self._news.set()
