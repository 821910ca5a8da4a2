"""A schedule that does not wait, and tables that say what it met."""

import math

import pytest

from benchmarks.load import round_table, route_table
from benchmarks.load_plan import SHARES, Route, Sample, Samples, schedule
from benchmarks.load_run import LoadRound


def test_requests_are_due_at_a_fixed_rate_whatever_their_kind() -> None:
    due = schedule(50.0, 60.0, ["a", "b"], ["b"], seed=1)
    assert len(due) == 3000
    assert [one.at_s for one in due] == pytest.approx([k / 50.0 for k in range(3000)])
    assert math.isclose(sum(SHARES.values()), 1.0)
    for route, share in SHARES.items():
        count = sum(one.route is route for one in due)
        assert count == pytest.approx(share * 3000, rel=0.25)
    assert {one.path for one in due if one.route is Route.EVENTS} == {"/v1/jobs/b/events"}
    assert due == schedule(50.0, 60.0, ["a", "b"], ["b"], seed=1)


def test_tables_have_latencies_by_route_errors_and_what_was_dropped() -> None:
    def answered(latency_s: float, status: int = 200) -> Sample:
        return Sample(
            route=Route.JOB, latency_s=latency_s, late_s=0.001, served_s=0.001, status=status
        )

    samples = [answered(k / 1000.0) for k in range(1, 100)] + [answered(0.1, 503)]
    done = LoadRound(
        samples=Samples(done=samples, dropped=2),
        load=2.0,
        api_cpu_s=0.2,
        rss_mib=120.0,
        body_bytes=100_000,
    )
    row = route_table(done).splitlines()[2]
    assert row == "| GET /v1/jobs/{job_id} | 100 | 50 | 95 | 99 | 100 | 1 |"
    assert round_table([done]).splitlines()[2] == "| 1 | 99 | 1.0 | 2.0 | 120 | 2 | 2.0 |"
