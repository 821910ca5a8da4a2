import pytest
from hypothesis import given
from hypothesis import strategies as st

from jobs.event_id import START, EventId

numbers = st.integers(0, 2**64 - 1)
ids = st.builds(EventId, numbers, numbers)


@given(ids)
def test_what_is_written_is_read(id_: EventId) -> None:
    assert EventId.of_text(str(id_)) == id_
    assert id_ >= START


@given(st.text())
def test_any_other_text_is_no_id(text: str) -> None:
    id_ = EventId.of_text(text)
    assert id_ is None or max(id_) < 2**64


@pytest.mark.parametrize(
    "text",
    [
        "",
        "1",
        "1-",
        "-1",
        "1-2-3",
        "1-2 ",
        "+1-2",
        "1_0-2",
        "٣-٤",
        "$",
        "0-*",
        f"{2**64}-0",
        "1-2\n",
    ],
)
def test_no_ids(text: str) -> None:
    assert EventId.of_text(text) is None


def test_order_is_that_of_time_and_then_number() -> None:
    assert EventId(9, 10) < EventId(10, 2) < EventId(10, 11)
