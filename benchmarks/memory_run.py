"""Many jobs that take no time, and what the service holds in memory after each so many."""

import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import httpx
import psutil

from benchmarks.measure import ROOT
from benchmarks.small_study import QUICK, small_request
from benchmarks.stack import Stack, running
from jobs.open_store import open_store
from jobs.queue import JobQueue
from jobs.reconcile import reconcile
from jobs.records import JobRecords
from jobs.settings import JobSettings
from jobs.settled import Settled

_CALLERS = 4
_WITHIN_S = 120.0


@dataclass(frozen=True)
class MemorySample:
    """After `jobs` have ended. Resident MiB of the API and of a worker's two processes, the
    largest; of Redis what its data take, and how many keys. round_s: one round of a reconciler that
    knows the jobs already. first_round_s: of one that does not.
    """

    jobs: int
    api_mib: float
    worker_mib: float
    computing_mib: float
    redis_mib: float
    keys: int
    first_round_s: float
    round_s: float


def memory_run(jobs: int, every: int) -> list[MemorySample]:
    """Send `jobs`, poll each once, and look after each `every`."""
    settings = {
        "PYTHONPATH": str(ROOT),
        # One process for all, or its end would hide what it gathers.
        "NEURALMRI_MAX_TASKS_PER_CHILD": "1000000",
        # One address sends them all, as fast as they are taken.
        "NEURALMRI_CALLS_PER_MINUTE": "0",
        "NEURALMRI_SUBMITS_PER_MINUTE": "0",
    }
    samples = []
    with ExitStack() as open_:
        folder = Path(open_.enter_context(tempfile.TemporaryDirectory(prefix="memory-")))
        stack = Stack(folder, settings, worker_app="benchmarks.stub_worker")
        open_.enter_context(running(stack))
        client = open_.enter_context(httpx.Client(base_url=stack.url, timeout=60, trust_env=False))
        callers = open_.enter_context(ThreadPoolExecutor(_CALLERS))
        for done in range(every, jobs + 1, every):
            for job_id in callers.map(lambda _: _submitted(client), range(every)):
                client.get(f"/v1/jobs/{job_id}").raise_for_status()
            _wait_for(client, done)
            samples.append(_sample(stack, done))
    return samples


def slope_mib(samples: Sequence[MemorySample], sizes_mib: Sequence[float]) -> float:
    """MiB more for each 1000 jobs, by least squares, without the first fifth: it warms up."""
    kept = list(zip(samples, sizes_mib, strict=True))[len(samples) // 5 :]
    mean_jobs = sum(s.jobs for s, _ in kept) / len(kept)
    mean_mib = sum(size for _, size in kept) / len(kept)
    spread = sum((s.jobs - mean_jobs) ** 2 for s, _ in kept)
    together = sum((s.jobs - mean_jobs) * (size - mean_mib) for s, size in kept)
    return 1000.0 * together / spread if spread else float("nan")


def _submitted(client: httpx.Client) -> str:
    body = small_request("memory", QUICK, points=8)
    job_id: str = client.post("/v1/jobs/contours", json=body).raise_for_status().json()["id"]
    return job_id


def _wait_for(client: httpx.Client, ended: int) -> None:
    """Until so many have succeeded, by the service's own count. Raises TimeoutError."""
    deadline = time.monotonic() + _WITHIN_S
    said = f'neuralmri_jobs{{state="succeeded"}} {float(ended)}'
    while said not in client.get("/metrics").text:
        if time.monotonic() > deadline:
            raise TimeoutError(f"{ended} jobs have not succeeded within {_WITHIN_S:g} s")
        time.sleep(0.2)


def _sample(stack: Stack, jobs: int) -> MemorySample:
    first_round_s, round_s = _rounds_s(stack)
    with stack.redis_client() as redis:
        redis_bytes = redis.info("memory")["used_memory"]
        keys = redis.dbsize()
    computing = [child.pid for worker in stack.workers for child in worker.children()]
    return MemorySample(
        jobs=jobs,
        api_mib=_rss_mib([stack.api.pid]),
        worker_mib=_rss_mib([worker.pid for worker in stack.workers]),
        computing_mib=_rss_mib(computing),
        redis_mib=redis_bytes / 2**20,
        keys=keys,
        first_round_s=first_round_s,
        round_s=round_s,
    )


def _rss_mib(pids: Sequence[int]) -> float:
    return max(psutil.Process(pid).memory_info().rss for pid in pids) / 2**20


def _rounds_s(stack: Stack) -> Iterator[float]:
    """A reconciler's first round over these folders, and its second."""
    settings = JobSettings(redis_url=stack.redis_url, data_dir=stack.data_dir)
    settled = Settled()
    with stack.redis_client() as redis:
        store, records = open_store(settings), JobRecords(redis)
        queue = JobQueue(settings, redis)
        for _ in range(2):
            begun_s = time.perf_counter()
            reconcile(store, records, queue, settings.lost_after_s, settled)
            yield time.perf_counter() - begun_s
