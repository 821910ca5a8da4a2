import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.accept import is_acceptable

EVENTS = "text/event-stream"


@pytest.mark.parametrize(
    "accept",
    [
        "",
        "*/*",
        "text/*",
        "text/event-stream",
        "TEXT/Event-Stream; charset=utf-8",
        "text/html, */*;q=0.1",
        "text/*;q=0, text/event-stream;q=0.5",
        "*/*;q=x",
    ],
)
def test_taken(accept: str) -> None:
    assert is_acceptable(accept, EVENTS)


@pytest.mark.parametrize(
    "accept",
    [
        "application/json",
        "text/html",
        "text/event-stream;q=0, */*",
        "text/*; q=0.0, */*",
        "*/*;q=0",
        ",;",
    ],
)
def test_excluded(accept: str) -> None:
    assert not is_acceptable(accept, EVENTS)


@given(st.text())
def test_any_header_has_an_answer(accept: str) -> None:
    assert is_acceptable(accept, EVENTS) in (True, False)
