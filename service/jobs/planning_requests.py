"""Planning requests: accepted durably, run by the executor, followed by whoever asks."""

import asyncio
import logging
import uuid
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from opentelemetry.trace import Tracer
from pydantic import ValidationError

from service.coordination.ports import KeyReusedError
from service.jobs.executor import LAST, Executor, QueueFullError, Run, Told
from service.jobs.work import PlanningWork
from service.messages.planning import PlanOut, PlanRequest, PlanResult, PlanStatus
from service.store.plan_store import PlanStore
from service.tracing import traceparent

LOG = logging.getLogger(__name__)


@dataclass
class Following:
    """A request of this process's life: what was told, and who waits for more."""

    id: str
    client: str
    """Who handed it in."""
    run: Run | None = None
    status: PlanStatus = "queued"
    told: list[Told] = field(default_factory=list)
    news: asyncio.Event = field(default_factory=asyncio.Event)

    @property
    def is_over(self) -> bool:
        """Whether nothing more will be told."""
        return self.status in LAST

    def publish(self, told: Told) -> None:
        """Makes what was told known."""
        self.told.append(told)
        self.status = told["kind"] if told["kind"] in LAST else "running"
        self.news.set()
        self.news = asyncio.Event()


class PlanningRequests:
    """All planning requests of a service."""

    def __init__(self, store: PlanStore, executor: Executor, domains: Path, tracer: Tracer) -> None:
        self._store = store
        self._executor = executor
        self._domains = domains
        self._open: dict[str, Following] = {}
        self._tracer = tracer
        self._hushed = False
        self._tasks: set[asyncio.Task[None]] = set()

    async def restore(self) -> int:
        """Starts again what was accepted and had not ended."""
        stored = await asyncio.to_thread(self._store.unfinished)
        for request in stored:
            found = await asyncio.to_thread(self._store.find, request.id)
            told = list(found[1]) if found else []
            following = Following(request.id, request.client, told=told)
            try:
                body = PlanRequest.model_validate_json(request.body)
                self._start(following, body, request.client)
            except (ValidationError, QueueFullError) as error:
                await self._publish(following, {"kind": "failed", "message": str(error)})
        return len(stored)

    async def repeated(self, client: str, key: str, digest: str) -> Following | None:
        """The request that a client made under a key, if it made one.

        Raises:
            KeyReusedError: it was another one.
        """
        before = await asyncio.to_thread(self._store.created_under, client, key)
        if before is None:
            return None
        if before[1] != digest:
            raise KeyReusedError("this Idempotency-Key was used for another planning request")
        return await self.find(before[0])

    async def submit(
        self, request: PlanRequest, client: str, key: str | None = None, digest: str = ""
    ) -> Following:
        """Accepts a request; it is stored when this returns.

        Args:
            key: under which `repeated` finds it.
            digest: of what was sent.

        Raises:
            QueueFullError: too many are waiting.
            StoreError: it could not be stored.
        """
        following = Following(uuid.uuid4().hex, client)
        body = request.model_dump_json()
        if self._executor.capacity().full:
            raise QueueFullError("too many planning requests are waiting")
        await asyncio.to_thread(self._store.add, following.id, client, body, key, digest)
        try:
            self._start(following, request, client)
        except QueueFullError:
            await self._publish(following, {"kind": "failed", "message": "the queue was full"})
            raise
        return following

    async def find(self, identifier: str) -> Following | None:
        """A request, of this process's life or from the store."""
        if (following := self._open.get(identifier)) is not None:
            return following
        found = await asyncio.to_thread(self._store.find, identifier)
        if found is None:
            return None
        request, told = found
        following = Following(request.id, request.client, told=list(told))
        following.status = request.status  # type: ignore[assignment]
        return following

    async def cancel(self, following: Following) -> None:
        """Stops a request; one that has ended stays as it is."""
        if following.run is not None and not following.is_over:
            following.run.cancel()
            await self.wait(following, 2.0)

    async def wait(self, following: Following, timeout_s: float) -> None:
        """Waits until a request has ended, but not longer than that."""

        async def ended() -> None:
            while not following.is_over:
                await following.news.wait()

        try:
            await asyncio.wait_for(ended(), timeout_s)
        except TimeoutError:
            return

    async def follow(self, following: Following, first: int) -> AsyncIterator[tuple[int, Told]]:
        """What was and will be told, with numbers, from `first` on."""
        number = first
        while True:
            while number < len(following.told):
                yield number, following.told[number]
                number += 1
            if following.is_over or self._hushed:
                return
            await following.news.wait()

    def hush(self) -> None:
        """Sends all listeners away: the service is to stop."""
        self._hushed = True
        for following in self._open.values():
            following.news.set()
            following.news = asyncio.Event()

    async def close(self) -> None:
        """Lets go of everything; what has not ended starts again with the service."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _start(self, following: Following, request: PlanRequest, client: str) -> None:
        following.run = self._executor.submit(
            self._work(request), client=client, priority=request.priority
        )
        self._open[following.id] = following
        task = asyncio.get_running_loop().create_task(self._run(following, following.run))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _run(self, following: Following, run: Run) -> None:
        with self._tracer.start_as_current_span(
            "planning request", attributes={"request": following.id}
        ) as span:
            async for told in run.told():
                await self._publish(following, told)
            span.set_attribute("status", following.status)
        # Found in the store from now on.
        self._open.pop(following.id, None)

    async def _publish(self, following: Following, told: Told) -> None:
        number = len(following.told)
        try:
            await asyncio.to_thread(self._store.tell, following.id, number, told)
        except Exception:
            # Followers still hear of it; a restart would run the request again.
            LOG.exception("planning request %s: the database refused", following.id)
        following.publish(told)

    def _work(self, request: PlanRequest) -> PlanningWork:
        domain = (request.domain_text or "").encode()
        if request.domain is not None:
            domain = (self._domains / request.domain / "domain.pddl").read_bytes()
        return PlanningWork(
            domain=domain,
            problem=request.problem.encode(),
            time_limit_s=request.time_limit_s,
            seed=request.seed,
            node_limit=request.node_limit,
            memory_limit_mb=request.memory_limit_mb,
            first_plan_only=request.first_plan_only,
            map=None if request.map is None else request.map.model_dump(),
            traceparent=traceparent(),
            robot_types={name: kind.model_dump() for name, kind in request.robot_types.items()},
        )


def result(following: Following) -> PlanResult:
    """A request and what has come of it so far."""
    plans = [told for told in following.told if told["kind"] == "plan"]
    end = following.told[-1] if following.is_over and following.told else {}
    return PlanResult(
        id=following.id,
        status=following.status,
        outcome=end.get("outcome"),
        message=end.get("message"),
        plan=plan_out(plans) if plans else None,
        validated=bool(plans),
        plans_found=len(plans),
        lower_bound=end.get("lower_bound"),
        gap=end.get("gap"),
        statistics=end.get("statistics"),
    )


def plan_out(plans: Sequence[Told]) -> PlanOut:
    """The best of the plans that were told: the last."""
    return PlanOut.model_validate({k: v for k, v in plans[-1].items() if k != "kind"})
