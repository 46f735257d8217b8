"""A queue in which higher priorities go first and clients of the same priority take turns."""

from collections import OrderedDict, deque
from typing import Generic, TypeVar

T = TypeVar("T")


class FairQueue(Generic[T]):
    """Items by priority, then by the client that was served longest ago."""

    def __init__(self) -> None:
        self._by_priority: dict[int, OrderedDict[str, deque[T]]] = {}

    def __len__(self) -> int:
        return sum(
            len(items) for clients in self._by_priority.values() for items in clients.values()
        )

    def put(self, item: T, *, client: str, priority: int) -> None:
        """Appends an item to its client's line."""
        self._by_priority.setdefault(priority, OrderedDict()).setdefault(client, deque()).append(
            item
        )

    def take(self) -> T:
        """The next item.

        Raises:
            IndexError: the queue is empty.
        """
        if not self._by_priority:
            raise IndexError("the queue is empty")
        priority = max(self._by_priority)
        clients = self._by_priority[priority]
        client, items = next(iter(clients.items()))
        item = items.popleft()
        del clients[client]
        if items:
            clients[client] = items  # to the end of the turn
        elif not clients:
            del self._by_priority[priority]
        return item

    def remove(self, item: T) -> bool:
        """Takes an item out; false if it is not in the queue."""
        for priority, clients in self._by_priority.items():
            for client, items in clients.items():
                if item in items:
                    items.remove(item)
                    if not items:
                        del clients[client]
                    if not clients:
                        del self._by_priority[priority]
                    return True
        return False
