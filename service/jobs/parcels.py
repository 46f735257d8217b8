"""What goes to a worker: pickled work, without the maps and memories that the worker has already.

Maps are sent once to a worker and by their digest afterwards. What attachments keep between the
problems of a mission (path costs, above all) never leaves its worker; the sender knows which
worker is warm for what, and tells the worker what to drop.
"""

import io
import pickle
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Any

from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap
from service.jobs.executor import Work

MAPS_KEPT = 32
MEMORIES_KEPT = 128
_MAP = "map"


@dataclass
class Dispatching:
    """The sender's side: what one worker has."""

    maps: "OrderedDict[str, None]" = field(default_factory=OrderedDict)
    memories: "OrderedDict[str, None]" = field(default_factory=OrderedDict)
    _dropped: list[str] = field(default_factory=list)

    def is_warm(self, affinity: str) -> bool:
        """Whether the worker keeps something of this affinity."""
        return affinity in self.memories

    def forget(self, affinity: str) -> None:
        """Has the worker drop a memory with the next work."""
        if affinity in self.memories:
            del self.memories[affinity]
            self._dropped.append(affinity)

    def pack(self, work: Work) -> bytes:
        """The work for this worker."""
        if work.affinity is not None:
            self.memories[work.affinity] = None
            self.memories.move_to_end(work.affinity)
            while len(self.memories) > MEMORIES_KEPT:
                self.forget(next(iter(self.memories)))
        body = io.BytesIO()
        packer = _Packer(body, self)
        packer.dump(work)
        while len(self.maps) > MAPS_KEPT:
            self.maps.popitem(last=False)
        dropped, self._dropped = self._dropped, []
        return pickle.dumps((tuple(dropped), packer.new_maps, tuple(self.maps), body.getvalue()))


class _Packer(pickle.Pickler):
    def __init__(self, file: io.BytesIO, sender: Dispatching) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._sender = sender
        self.new_maps: dict[str, GridMap] = {}

    def persistent_id(self, obj: Any) -> tuple[str, str] | None:
        if not isinstance(obj, GridMap):
            return None
        if obj.digest not in self._sender.maps:
            self.new_maps[obj.digest] = obj
        self._sender.maps[obj.digest] = None
        self._sender.maps.move_to_end(obj.digest)
        return _MAP, obj.digest


class Receiving:
    """The worker's side: the maps and memories that it keeps."""

    def __init__(self) -> None:
        self._maps: dict[str, GridMap] = {}
        self._memories: dict[str, Memory] = {}

    def unpack(self, parcel: bytes) -> tuple[Work, Memory]:
        """The work, and what its attachments kept; pickled by the service itself."""
        dropped, new_maps, maps, body = pickle.loads(parcel)
        for affinity in dropped:
            self._memories.pop(affinity, None)
        self._maps |= new_maps
        work: Work = _Unpacker(io.BytesIO(body), self._maps).load()
        self._maps = {digest: self._maps[digest] for digest in maps}
        if work.affinity is None:
            return work, Memory()
        return work, self._memories.setdefault(work.affinity, Memory())

    def relieve(self) -> None:
        """Drops what can be computed again."""
        self._memories.clear()


class _Unpacker(pickle.Unpickler):
    def __init__(self, file: io.BytesIO, maps: dict[str, GridMap]) -> None:
        super().__init__(file)
        self._maps = maps

    def persistent_load(self, pid: tuple[str, str]) -> GridMap:
        return self._maps[pid[1]]
