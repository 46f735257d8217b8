"""A queue in which higher priorities go first and clients of the same priority take turns."""

from collections import OrderedDict, deque
from collections.abc import Callable
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

    def take(self, accepts: Callable[[T], bool] = lambda _: True) -> T:
        """The next item that is acceptable.

        Raises:
            IndexError: there is none.
        """
        for priority in sorted(self._by_priority, reverse=True):
            for client, items in self._by_priority[priority].items():
                for item in items:
                    if accepts(item):
                        self._remove(priority, client, item)
                        if items:  # to the end of the turn
                            self._by_priority[priority].move_to_end(client)
                        return item
        raise IndexError("there is nothing acceptable in the queue")

    def remove(self, item: T) -> bool:
        """Takes an item out; false if it is not in the queue."""
        for priority, clients in self._by_priority.items():
            for client, items in clients.items():
                if item in items:
                    self._remove(priority, client, item)
                    return True
        return False

    def _remove(self, priority: int, client: str, item: T) -> None:
        clients = self._by_priority[priority]
        clients[client].remove(item)
        if not clients[client]:
            del clients[client]
        if not clients:
            del self._by_priority[priority]
