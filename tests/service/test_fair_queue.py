"""Priorities first, then clients in turn; nothing is lost."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.jobs.fair_queue import FairQueue


def test_clients_take_turns() -> None:
    queue: FairQueue[str] = FairQueue()
    for item in ("a1", "a2", "a3", "b1"):
        queue.put(item, client=item[0], priority=0)
    assert [queue.take() for _ in range(4)] == ["a1", "b1", "a2", "a3"]


def test_higher_priority_goes_first() -> None:
    queue: FairQueue[str] = FairQueue()
    queue.put("low", client="a", priority=0)
    queue.put("high", client="a", priority=5)
    assert queue.take() == "high"


def test_an_empty_queue_says_so() -> None:
    with pytest.raises(IndexError):
        FairQueue().take()


@given(
    st.lists(
        st.one_of(
            st.tuples(st.just("put"), st.sampled_from("abc"), st.integers(0, 2)),
            st.tuples(st.just("take"), st.just(""), st.just(0)),
            st.tuples(st.just("remove"), st.just(""), st.integers(0, 30)),
        ),
        max_size=60,
    )
)
def test_every_item_comes_out_once_and_lines_keep_their_order(
    operations: list[tuple[str, str, int]],
) -> None:
    queue: FairQueue[tuple[int, str, int]] = FairQueue()
    waiting: set[tuple[int, str, int]] = set()
    for number, (operation, client, value) in enumerate(operations):
        if operation == "put":
            item = (number, client, value)
            queue.put(item, client=client, priority=value)
            waiting.add(item)
        elif operation == "take" and waiting:
            item = queue.take()
            assert item[2] == max(priority for _, _, priority in waiting)
            assert item == min(i for i in waiting if i[1:] == item[1:])
            waiting.remove(item)
        elif operation == "remove":
            found = next((i for i in waiting if i[0] == value), (-1, "", 0))
            assert queue.remove(found) is (found in waiting)
            waiting.discard(found)
        assert len(queue) == len(waiting)
