from datetime import UTC, datetime

import pytest

from service.webhooks.retry import retry_after_s, wait_s

NOW = datetime(2026, 3, 1, 12, 0, tzinfo=UTC)


def test_jitter_is_a_tenth_either_way() -> None:
    assert [wait_s(300.0, 0.0, draw) for draw in (0.0, 0.5, 1.0)] == pytest.approx([270, 300, 330])
    assert wait_s(0.0, 0.0, 0.9) == 0.0


def test_a_receiver_may_ask_for_longer_but_not_for_ever_and_not_for_less() -> None:
    assert wait_s(5.0, 60.0, 0.5) == 60.0
    assert wait_s(300.0, 1.0, 0.5) == 300.0
    assert wait_s(5.0, 1e9, 0.5) == 86400.0


@pytest.mark.parametrize(
    ("header", "asked_s"),
    [
        (None, 0.0),
        ("120", 120.0),
        (" 7 ", 7.0),
        ("Sun, 01 Mar 2026 12:01:30 GMT", 90.0),
        ("Sun, 01 Mar 2026 12:01:30 -0000", 90.0),
        ("Sun, 01 Mar 2026 11:00:00 GMT", 0.0),
        ("-5", 0.0),
        ("soon", 0.0),
        ("9" * 400, float("inf")),
        ("", 0.0),
    ],
)
def test_retry_after(header: str | None, asked_s: float) -> None:
    assert retry_after_s(header, NOW) == asked_s
