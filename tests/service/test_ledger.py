"""Latest events at hand, and a commit in doubt: the log decides."""

import pytest
from test_dispatch import events

from service.coordination.events import Event, MissionCreated, TargetRemoved
from service.coordination.history import created
from service.coordination.ledger import LATEST_KEPT, Ledger
from service.coordination.ports import StoreError

CREATED = next(events())
assert isinstance(CREATED, MissionCreated)


class Log:
    """Keeps events; may lose the answer to a commit that happened."""

    def __init__(self) -> None:
        self.kept: list[Event] = [CREATED]
        self.loses_answers = False

    async def append(self, _: str, first_number: int, events: list[Event]) -> None:
        assert first_number == len(self.kept)
        self.kept += events
        if self.loses_answers:
            raise StoreError("no answer")

    def events(self, _: str) -> list[Event]:
        return self.kept


def removed(time_s: float) -> TargetRemoved:
    return TargetRemoved(time_s=time_s, target="target_1")


@pytest.mark.asyncio
async def test_the_latest_events_are_at_hand_for_listeners_that_keep_up() -> None:
    ledger = Ledger(created(CREATED), Log())
    for time_s in range(LATEST_KEPT + 5):
        await ledger.record([removed(float(time_s))])
    number = ledger.mission.events
    assert ledger.latest(number) == []
    assert ledger.latest(number - 2) == [
        (number - 2, removed(LATEST_KEPT + 3.0)),
        (number - 1, removed(LATEST_KEPT + 4.0)),
    ]
    assert ledger.latest(0) == []


@pytest.mark.asyncio
async def test_a_commit_in_doubt_is_looked_up() -> None:
    log = Log()
    ledger = Ledger(created(CREATED), log)
    await ledger.record([removed(1.0)])
    log.loses_answers = True
    with pytest.raises(StoreError):
        await ledger.record([removed(2.0)])
    assert ledger.mission.events == 2
    log.loses_answers = False
    async with ledger.locked() as mission:
        assert mission.events == 3
    assert ledger.latest(1) == []  # the one in doubt is not at hand
    await ledger.record([removed(3.0)])
    assert ledger.latest(3) == [(3, removed(3.0))]
