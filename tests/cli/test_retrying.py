"""When to ask again: real time in hundredths of seconds, real answers."""

import time
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime

import httpx
import pytest

from cli.retrying import TryAgain, persistently, retry_after_s
from schemas.problem import InputError, InternalError, ProblemType

BUSY = InternalError(ProblemType.UNAVAILABLE, "busy", status=503)


@pytest.fixture(autouse=True)
def _hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cli.retrying._FIRST_PAUSE_S", 0.02)
    monkeypatch.setattr("cli.retrying._LONGEST_PAUSE_S", 0.08)


class Attempts:
    """Raises what it is given, one after another, and then succeeds."""

    def __init__(self, *failures: Exception) -> None:
        self.failures: Iterator[Exception] = iter(failures)
        self.at_s: list[float] = []

    def __call__(self) -> str:
        self.at_s.append(time.monotonic())
        failure = next(self.failures, None)
        if failure is not None:
            raise failure
        return "done"


def test_what_passes_is_waited_for_and_told() -> None:
    told: list[str] = []
    attempt = Attempts(TryAgain(BUSY), TryAgain(BUSY))
    assert persistently(attempt, 5.0, told.append) == "done"
    assert len(attempt.at_s) == 3
    assert [sentence.partition(";")[0] for sentence in told] == ["busy", "busy"]


def test_pauses_grow() -> None:
    attempt = Attempts(*[TryAgain(BUSY)] * 4)
    persistently(attempt, 5.0, lambda _: None)
    pauses = [b - a for a, b in zip(attempt.at_s, attempt.at_s[1:], strict=False)]
    assert pauses[0] < 0.05 < sum(pauses[2:])


def test_a_pause_is_never_shorter_than_the_server_asks_for() -> None:
    attempt = Attempts(TryAgain(BUSY, after_s=0.3))
    persistently(attempt, 5.0, lambda _: None)
    assert attempt.at_s[1] - attempt.at_s[0] >= 0.3


def test_it_is_given_up_in_the_server_s_own_words() -> None:
    attempt = Attempts(*[TryAgain(BUSY)] * 1000)
    with pytest.raises(InternalError) as told:
        persistently(attempt, 0.2, lambda _: None)
    assert told.value is BUSY
    assert len(attempt.at_s) > 2


@pytest.mark.parametrize("within_s", [0.0, 5.0])
def test_who_is_asked_to_wait_longer_than_may_be_gives_up_at_once(within_s: float) -> None:
    attempt = Attempts(*[TryAgain(BUSY, after_s=60.0)] * 2)
    with pytest.raises(InternalError):
        persistently(attempt, within_s, lambda _: None)
    assert len(attempt.at_s) == 1


def test_progress_starts_the_clock_anew() -> None:
    attempt = Attempts(*[TryAgain(BUSY, after_s=0.1, progressed=True)] * 4)
    assert persistently(attempt, 0.15, lambda _: None) == "done"


def test_a_refusal_is_not_asked_again() -> None:
    attempt = Attempts(InputError(ProblemType.NOT_FOUND, "no such job"))
    with pytest.raises(InputError):
        persistently(attempt, 5.0, lambda _: None)
    assert len(attempt.at_s) == 1


def test_retry_after_is_seconds_or_a_date() -> None:
    def asks(text: str) -> float | None:
        return retry_after_s(httpx.Response(503, headers={"Retry-After": text}))

    soon = asks(format_datetime(datetime.now(tz=UTC) + timedelta(seconds=30), usegmt=True))
    assert asks("7") == 7.0
    assert soon is not None
    assert 28.0 < soon <= 30.0
    assert asks("Wed, 21 Oct 2015 07:28:00 GMT") == 0.0
    assert asks("soon") is asks("") is None
    assert retry_after_s(httpx.Response(503)) is None
