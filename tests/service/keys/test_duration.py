from datetime import timedelta

import pytest

from schemas.problem import InputError
from service.keys.duration import duration


@pytest.mark.parametrize(
    ("text", "span"),
    [
        ("90d", timedelta(days=90)),
        ("12h", timedelta(hours=12)),
        ("30m", timedelta(minutes=30)),
        ("0s", timedelta()),
        (" 7d ", timedelta(days=7)),
        ("3650d", timedelta(days=3650)),
    ],
)
def test_spans(text: str, span: timedelta) -> None:
    assert duration(text) == span


@pytest.mark.parametrize("text", ["", "90", "d", "-1d", "1.5d", "1w", "1d2h", "3651d", "٣d", "1 d"])
def test_what_is_no_span_is_told_with_a_remedy(text: str) -> None:
    with pytest.raises(InputError, match="Remedy"):
        duration(text)
