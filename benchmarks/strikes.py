"""What is done to a running service: who dies, stops, forgets or refuses, and for how long."""

import random
import signal
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum

from benchmarks.member import Member
from benchmarks.stack import Stack


class Strike(StrEnum):
    """One kind each."""

    API = "API killed"
    WORKER = "worker killed"
    CHILD = "computing process of a worker killed"
    REDIS = "Redis killed"
    WIPE = "Redis killed, its data removed"
    FREEZE = "worker stopped for longer than its lease, then woken"
    TERMINATE = "worker asked to end (SIGTERM)"
    NO_MEMORY = "Redis out of memory"
    READ_ONLY = "Redis read-only (a replica)"


_WEIGHTS = {
    Strike.API: 4,
    Strike.WORKER: 4,
    Strike.CHILD: 4,
    Strike.REDIS: 4,
    Strike.FREEZE: 1,
    Strike.TERMINATE: 2,
    Strike.NO_MEMORY: 1,
    Strike.READ_ONLY: 1,
}

_FROZEN_S = 5.0
"""Beyond the lease of `stack.IMPATIENT` and the time after which a job is taken to be lost."""


@dataclass(frozen=True)
class Struck:
    """at_s: when it began. over_s: when the process was started again, or let go. Unix time."""

    strike: Strike
    at_s: float
    over_s: float


def drawn(draw: random.Random, count: int, wipes: int) -> list[Strike]:
    """Every kind once where there is room for it, the rest by weight, `wipes` of them wipes."""
    kinds = list(_WEIGHTS)
    draw.shuffle(kinds)
    chosen = kinds[: max(0, count - wipes)]
    more = max(0, count - wipes - len(chosen))
    chosen += draw.choices(list(_WEIGHTS), weights=list(_WEIGHTS.values()), k=more)
    chosen += [Strike.WIPE] * wipes
    draw.shuffle(chosen)
    return chosen


class Striker:
    """Strikes one after the other. To be used by the thread that started the stack."""

    def __init__(self, stack: Stack, draw: random.Random) -> None:
        self._stack = stack
        self._draw = draw

    def strike(self, kind: Strike) -> Struck:
        """Do it, wait as a container engine would before it starts the process again, and start."""
        at_s = time.time()
        delay_s = self._draw.uniform(0.2, 2.0)
        worker = self._draw.choice(self._stack.workers)
        match kind:
            case Strike.API:
                _killed(self._stack.api, delay_s)
            case Strike.WORKER:
                _killed(worker, delay_s)
            case Strike.CHILD:
                # Its parent starts another by itself.
                for child in worker.children():
                    child.kill()
            case Strike.REDIS:
                self._redis_killed(delay_s)
            case Strike.WIPE:
                self._redis_killed(delay_s, self._stack.wipe_redis)
            case Strike.FREEZE:
                worker.send_to_all(signal.SIGSTOP)
                time.sleep(_FROZEN_S + delay_s)
                worker.send_to_all(signal.SIGCONT)
            case Strike.TERMINATE:
                worker.stop()
                time.sleep(delay_s)
                worker.start()
            case Strike.NO_MEMORY | Strike.READ_ONLY:
                self._refused(kind, delay_s)
        return Struck(kind, at_s, time.time())

    def _redis_killed(self, delay_s: float, then: Callable[[], None] = lambda: None) -> None:
        redis = self._stack.redis
        redis.kill()
        then()
        time.sleep(delay_s)
        redis.start()
        while not self._stack.redis_answers():
            if not redis.is_running:
                raise RuntimeError("Redis does not start again; see its log")
            time.sleep(0.02)

    def _refused(self, kind: Strike, delay_s: float) -> None:
        with self._stack.redis_client() as client:
            if kind is Strike.NO_MEMORY:
                client.config_set("maxmemory", "1")
            else:
                # Of a master that is not there: its data stay, and nobody may write.
                client.replicaof("127.0.0.1", 1)
            time.sleep(1.0 + delay_s)
            if kind is Strike.NO_MEMORY:
                client.config_set("maxmemory", "0")
            else:
                client.replicaof("NO", "ONE")


def gaps_s(draw: random.Random, mean_s: float) -> Iterator[float]:
    """Rests between strikes, without end: some so short that one falls into the other's mending."""
    while True:
        yield min(draw.expovariate(1.0 / mean_s), 3.0 * mean_s)


def _killed(member: Member, delay_s: float) -> None:
    member.kill()
    time.sleep(delay_s)
    member.start()
