"""The executor port, on processes of this machine and on Ray: limits, crashes, turns, warm workers.

Both implementations pass the same tests.
"""

import asyncio
import os
import signal
import time
from collections.abc import AsyncIterator, Iterator

import numpy as np
import pytest
import pytest_asyncio
from odd_work import OddWork

from semantic_attachments.world import GridMap
from service.jobs.executor import QueueFullError, Told
from service.jobs.process_pool import ProcessWorker, process_pool
from service.jobs.worker_pool import PooledRun, PoolParameters, WorkerPool

pytestmark = pytest.mark.asyncio
PARAMETERS = PoolParameters(workers=2, queue_limit=3, memory_limit_mb=1024)


@pytest.fixture(scope="module")
def ray() -> Iterator[None]:
    """A Ray of this machine for all tests of this file."""
    pytest.importorskip("ray", reason="Ray is not installed (extra marsupial[cluster])")
    from service.jobs.ray_pool import join, leave

    join(None, PARAMETERS.workers)
    yield
    leave()


@pytest_asyncio.fixture(params=["processes", pytest.param("ray", marks=pytest.mark.slow)])
async def pool(request: pytest.FixtureRequest) -> AsyncIterator[WorkerPool]:
    if request.param == "processes":
        started = process_pool(PARAMETERS)
    else:
        request.getfixturevalue("ray")
        from service.jobs.ray_pool import ray_pool

        started = ray_pool(PARAMETERS, None)
    yield started
    await started.close()


def submit(pool: WorkerPool, work: OddWork, client: str = "a", priority: int = 0) -> PooledRun:
    return pool.submit(work, client=client, priority=priority)


async def ending(run: PooledRun) -> Told:
    return [told async for told in run.told()][-1]


async def test_workers_that_die_hang_or_hoard_cost_their_work_alone(pool: WorkerPool) -> None:
    bystander = submit(pool, OddWork(name="bystander"))
    died = await ending(submit(pool, OddWork("die")))
    assert (died["kind"], died["outcome"]) == ("failed", "crashed")
    late = await ending(submit(pool, OddWork("hang", hard_limit_s=0.5)))
    assert (late["kind"], late["outcome"]) == ("failed", "timed_out")
    stubborn = await ending(submit(pool, OddWork("hang with the interpreter", hard_limit_s=0.5)))
    assert stubborn["outcome"] == "timed_out"
    greedy = await ending(submit(pool, OddWork("hoard", size_mb=2048)))
    assert greedy["outcome"] == "out_of_memory"
    assert (await ending(submit(pool, OddWork("hoard", size_mb=64))))["size"] == 64 * 2**20
    assert (await ending(bystander))["name"] == "bystander"
    assert pool.capacity().restarts == 3


async def test_canceling_frees_the_worker_at_once(pool: WorkerPool) -> None:
    run = submit(pool, OddWork("hang"))
    told = run.told()
    assert (await anext(told))["kind"] == "plan"
    begun_s = time.monotonic()
    run.cancel()
    assert (await anext(told))["kind"] == "canceled"
    assert time.monotonic() - begun_s < 1.0
    assert (await ending(submit(pool, OddWork())))["kind"] == "finished"


async def test_a_full_queue_refuses_and_a_draining_pool_finishes(pool: WorkerPool) -> None:
    first = submit(pool, OddWork())
    assert (await ending(first))["kind"] == "finished"
    hanging = [submit(pool, OddWork("hang", hard_limit_s=2.0)) for _ in range(2)]
    for run in hanging:
        await anext(run.told())
    waiting = [submit(pool, OddWork()) for _ in range(PARAMETERS.queue_limit)]
    assert pool.capacity().full
    with pytest.raises(QueueFullError, match="waiting"):
        submit(pool, OddWork())
    waiting[0].cancel()
    assert (await ending(waiting[0]))["kind"] == "canceled"
    await pool.drain(10.0)
    assert [(await ending(run))["outcome"] for run in hanging] == ["timed_out", "timed_out"]
    with pytest.raises(QueueFullError, match="shutting down"):
        submit(pool, OddWork())


async def test_work_comes_back_to_the_worker_that_is_warm_for_it(pool: WorkerPool) -> None:
    grid = GridMap(np.zeros((300, 300), dtype=np.int8), 0.1)
    seen: dict[str, set[int]] = {}
    for count in range(4):
        for mission in ("m1", "m2", "m3"):
            told = await ending(submit(pool, OddWork(affinity=mission, grid=grid)))
            assert told["before"] == count
            assert told["grid"] == grid.digest
            seen.setdefault(mission, set()).add(told["pid"])
    assert all(len(pids) == 1 for pids in seen.values())
    pool.forget("m1")
    assert (await ending(submit(pool, OddWork(affinity="m1"))))["before"] == 0
    assert (await ending(submit(pool, OddWork(affinity="m2"))))["before"] == 4


async def test_work_whose_worker_is_busy_does_not_wait_for_long(pool: WorkerPool) -> None:
    home = (await ending(submit(pool, OddWork(affinity="m"))))["pid"]
    hanging = submit(pool, OddWork("hang", affinity="m", hard_limit_s=20.0))
    await anext(hanging.told())
    elsewhere = await ending(submit(pool, OddWork(affinity="m")))
    assert elsewhere["pid"] != home
    assert elsewhere["before"] == 0
    hanging.cancel()


async def test_fleets_take_turns() -> None:
    pool = process_pool(PoolParameters(workers=1))
    blocking = submit(pool, OddWork("hang", hard_limit_s=0.5))
    await anext(blocking.told())
    order: list[str] = []

    async def note(run: PooledRun) -> None:
        order.append((await ending(run))["name"])

    runs = [submit(pool, OddWork(name=f"greedy {n}"), client="greedy") for n in range(3)]
    runs += [submit(pool, OddWork(name="modest"), client="modest")]
    runs += [submit(pool, OddWork(name="urgent"), client="greedy", priority=5)]
    await asyncio.gather(*(note(run) for run in runs))
    assert order == ["urgent", "greedy 0", "modest", "greedy 1", "greedy 2"]
    await pool.close()


async def test_an_idle_worker_that_dies_is_replaced_before_anybody_needs_it() -> None:
    pool = process_pool(PoolParameters(workers=1))
    pid = (await ending(submit(pool, OddWork())))["pid"]
    os.kill(pid, signal.SIGKILL)
    while pool.capacity().restarts == 0 or not pool.workers():
        await asyncio.sleep(0.01)
    (worker,) = pool.workers()
    assert isinstance(worker, ProcessWorker)
    assert worker.process.pid != pid
    assert (await ending(submit(pool, OddWork())))["kind"] == "finished"
    await pool.close()


async def test_a_warm_pool_has_its_workers_before_there_is_work() -> None:
    pool = process_pool(PoolParameters(workers=2))
    pool.warm_up()
    while len(pool.workers()) < 2:
        await asyncio.sleep(0.01)
    await pool.close()
