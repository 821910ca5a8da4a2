"""Slopes of known lines, and a small real run that leaves nothing to the reconciler."""

from dataclasses import replace

import pytest

from benchmarks.memory import growth, slopes
from benchmarks.memory_run import MemorySample, memory_run, slope_mib

SAMPLE = MemorySample(
    jobs=0,
    api_mib=100.0,
    worker_mib=60.0,
    computing_mib=70.0,
    redis_mib=5.0,
    keys=10,
    first_round_s=0.5,
    round_s=0.01,
)


def test_a_slope_is_that_of_the_line_once_it_is_warm() -> None:
    samples = [replace(SAMPLE, jobs=500 * k) for k in range(1, 11)]
    line = [100.0 + 0.002 * s.jobs for s in samples]
    assert slope_mib(samples, line) == pytest.approx(2.0)
    assert slope_mib(samples, [40.0, 80.0, *line[2:]]) == pytest.approx(2.0)
    assert "| API | 100.0 | +0.00 |" in slopes(samples)
    assert len(growth(samples).splitlines()) == 12


@pytest.mark.slow
@pytest.mark.integration
def test_every_job_of_a_stub_engine_succeeds_and_keys_grow_by_two_a_job() -> None:
    first, last = memory_run(jobs=80, every=40)
    assert (first.jobs, last.jobs) == (40, 80)
    assert last.keys - first.keys <= 2 * 40 + 5
