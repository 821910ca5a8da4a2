import pytest
from hypothesis import given
from hypothesis import strategies as st

from jobs.estimate import retry_after_s, start_in_s

counts = st.integers(0, 200)
slots = st.integers(1, 50)
seconds = st.floats(0.1, 4000.0)


@given(counts, counts, slots, seconds)
def test_more_work_never_starts_sooner_and_more_workers_never_later(
    ahead: int, running: int, slots: int, runtime_s: float
) -> None:
    here = start_in_s(ahead, running, slots, runtime_s)
    assert here >= 0.0
    assert start_in_s(ahead + 1, running, slots, runtime_s) >= here
    assert start_in_s(ahead, running + 1, slots, runtime_s) >= here
    assert start_in_s(ahead, running, slots, 2.0 * runtime_s) >= here
    if running <= slots:
        assert start_in_s(ahead, running, slots + 1, runtime_s) <= here


@given(slots, seconds, st.data())
def test_a_free_slot_takes_a_job_at_once(slots: int, runtime_s: float, data: st.DataObject) -> None:
    running = data.draw(st.integers(0, slots - 1))
    ahead = data.draw(st.integers(0, slots - running - 1))
    assert start_in_s(ahead, running, slots, runtime_s) == 0.0


@pytest.mark.parametrize(
    ("ahead", "running", "slots", "expected_s"),
    [(0, 1, 1, 60.0), (9, 1, 1, 600.0), (0, 4, 4, 15.0), (7, 4, 4, 120.0), (0, 3, 4, 0.0)],
)
def test_closed_forms(ahead: int, running: int, slots: int, expected_s: float) -> None:
    assert start_in_s(ahead, running, slots, 60.0) == expected_s


@pytest.mark.parametrize(
    ("estimate_s", "expected_s"),
    [(None, 7), (0.0, 1), (0.2, 1), (12.1, 13), (3600.0, 3600), (1e9, 3600)],
)
def test_a_retry_is_within_an_hour(estimate_s: float | None, expected_s: int) -> None:
    assert retry_after_s(estimate_s, otherwise_s=7) == expected_s
