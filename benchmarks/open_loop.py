"""Requests at a fixed rate, whatever becomes of the answers: a process of its own, on locust.

    python -m benchmarks.open_loop < plan.json > samples.json

Each request has its instant on a schedule, and is sent then though earlier ones are not answered.
Its latency runs from that instant, not from when it was sent, so that a server that stands still
for a second is seen by each of the requests that were due in it, and so is a client that is late.
"""

import sys
import time
from collections.abc import Iterator
from typing import Any

import gevent
from locust import FastHttpUser
from locust.env import Environment

from benchmarks.load_plan import Due, LoadPlan, Route, Sample, Samples

_GRACE_S = 15.0
"""How long after the last instant an answer may come; what is not there then is dropped."""


def main() -> None:
    """Plan in, samples out."""
    plan = LoadPlan.model_validate_json(sys.stdin.buffer.read())
    print(run(plan).model_dump_json())


def run(plan: LoadPlan) -> Samples:
    """Send all of it."""
    sending = _Sending(plan)
    gevent.joinall([gevent.spawn(sending.send, due) for due in _when_due(sending, plan.due)])
    return sending.samples()


def _when_due(sending: "_Sending", schedule: list[Due]) -> Iterator[Due]:
    """Each request at its instant."""
    for due in schedule:
        gevent.sleep(max(0.0, sending.instant(due) - time.perf_counter()))
        yield due
    # The requests that are under way are joined for no longer than this.
    sending.close_after(_GRACE_S)


class _Sending:
    def __init__(self, plan: LoadPlan) -> None:
        self._plan = plan
        self._body = plan.body.encode()
        self._done: list[Sample] = []
        # Never the one to wait: as many connections as requests may be unanswered.
        user = type("Caller", (FastHttpUser,), {"host": plan.url, "concurrency": 2000})
        self._environment = Environment(user_classes=[user])
        self._client = user(self._environment).client
        self._start_s = time.perf_counter() + 0.5
        self._environment.events.request.add_listener(self._noted)

    def instant(self, due: Due) -> float:
        """When the request is due, on the clock of this process."""
        return self._start_s + due.at_s

    def send(self, due: Due) -> None:
        context = {"due": due, "late_s": time.perf_counter() - self.instant(due)}
        if due.route is Route.SUBMIT:
            headers = {"Content-Type": "application/json"}
            self._client.post(due.path, data=self._body, headers=headers, context=context)
        else:
            self._client.get(due.path, context=context)

    def close_after(self, grace_s: float) -> None:
        gevent.spawn_later(grace_s, self._client.client.close)

    def samples(self) -> Samples:
        return Samples(done=self._done, dropped=len(self._plan.due) - len(self._done))

    def _noted(
        self, context: dict[str, Any], response_time: float, response: Any, **_: Any
    ) -> None:
        due: Due = context["due"]
        sample = Sample(
            route=due.route,
            latency_s=time.perf_counter() - self.instant(due),
            late_s=context["late_s"],
            served_s=response_time / 1000.0,
            status=response.status_code or 0,
        )
        self._done.append(sample)


if __name__ == "__main__":
    main()
