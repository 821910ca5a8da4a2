import pytest

from jobs.trace_context import TraceContext

TRACE, SPAN = "4bf92f3577b34da6a3ce929d0e0e4736", "00f067aa0ba902b7"


def test_a_header_is_read_and_written() -> None:
    """The example of the standard."""
    trace = TraceContext.parsed(f"00-{TRACE}-{SPAN}-01")
    assert trace == TraceContext(TRACE, SPAN, is_sampled=True)
    assert trace.header() == f"00-{TRACE}-{SPAN}-01"


def test_a_child_is_of_the_same_trace_and_a_place_of_its_own() -> None:
    parent = TraceContext(TRACE, SPAN, is_sampled=True)
    child = parent.child()
    assert (child.trace_id, child.is_sampled) == (TRACE, True)
    assert child.span_id != SPAN
    assert TraceContext.parsed(child.header()) == child


def test_what_was_begun_can_be_read() -> None:
    begun = TraceContext.begun()
    assert TraceContext.parsed(begun.header()) == begun
    assert begun.trace_id != TraceContext.begun().trace_id


def test_later_versions_are_read_as_far_as_ours_goes() -> None:
    assert TraceContext.parsed(f"01-{TRACE}-{SPAN}-03-more") == TraceContext(TRACE, SPAN, True)
    assert TraceContext.parsed(f"cc-{TRACE}-{SPAN}-08") == TraceContext(TRACE, SPAN, False)


@pytest.mark.parametrize(
    "header",
    [
        None,
        "",
        "nonsense",
        f"00-{TRACE}-{SPAN}",
        f"00-{TRACE}-{SPAN}-01-more",
        f"00-{TRACE.upper()}-{SPAN}-01",
        f"00-{'0' * 32}-{SPAN}-01",
        f"00-{TRACE}-{'0' * 16}-01",
        f"ff-{TRACE}-{SPAN}-01",
        f"01-{TRACE}-{SPAN}-01more",
        f"00-{TRACE}-{SPAN}-1",
        f"00-{TRACE}-{SPAN}-01\nx",
    ],
)
def test_what_the_standard_refuses_is_no_trace(header: str | None) -> None:
    assert TraceContext.parsed(header) is None
