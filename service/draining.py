"""The time between being asked to stop and stopping."""

from collections.abc import Callable


class Draining:
    """Whether the service has been asked to stop; streams end then: clients go elsewhere."""

    def __init__(self) -> None:
        self.begun = False
        self._wake: list[Callable[[], None]] = []

    def then(self, wake: Callable[[], None]) -> None:
        """Calls `wake` when draining begins."""
        self._wake.append(wake)

    def begin(self) -> None:
        """The service is to stop; may be called from a signal handler."""
        if not self.begun:
            self.begun = True
            for wake in self._wake:
                wake()
