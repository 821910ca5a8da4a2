"""The grammar of event streams, however the bytes are cut."""

import pytest
from fastapi.sse import format_sse_event
from hypothesis import given
from hypothesis import strategies as st

from cli.event_source import ServerSentEvent, read_events


def read(*chunks: bytes) -> list[ServerSentEvent]:
    return list(read_events(chunks))


# A null is no part of an id, nor is a line's end part of any line.
words = st.text(st.characters(codec="utf-8", exclude_characters="\r\n\0"), max_size=12)
events = st.lists(st.tuples(words.filter(bool), words, words.filter(bool)), max_size=6)


@given(events, st.data())
def test_what_a_server_writes_is_read_however_it_is_cut(
    told: list[tuple[str, str, str]], data: st.DataObject
) -> None:
    text = b": hello\n\n".join(
        format_sse_event(event=event, data_str=said, id=id_) for event, said, id_ in told
    )
    ends = data.draw(st.sampled_from([b"\n", b"\r\n", b"\r"]))
    text = text.replace(b"\n", ends) + ends
    cuts = sorted(data.draw(st.lists(st.integers(0, len(text)), max_size=8)))
    chunks = [text[a:b] for a, b in zip([0, *cuts], [*cuts, len(text)], strict=True)]
    assert read(*chunks) == [ServerSentEvent(*one) for one in told]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("data: a\n\n", [("message", "a", "")]),
        ("data:a\ndata: b\n\n", [("message", "a\nb", "")]),
        ("event: state\ndata: a\nid: 1\n\n", [("state", "a", "1")]),
        ("id: 1\n\ndata: a\n\ndata: b\nid\n\n", [("message", "a", "1"), ("message", "b", "")]),
        ("id: 1\0\ndata: a\n\n", [("message", "a", "")]),
        ("event: lost\n\ndata: a\n\n", [("message", "a", "")]),
        (": comment\nretry: 10\nother: x\nnonsense\ndata\n\n", [("message", "", "")]),
        ("\ufeffdata: a\n\n", [("message", "a", "")]),
        ("data: \u2028\x0b\x85\n\n", [("message", "\u2028\x0b\x85", "")]),
        ("data: cut off\n", []),
        ("data: cut off", []),
        ("", []),
    ],
)
def test_by_the_standard(text: str, expected: list[tuple[str, str, str]]) -> None:
    assert read(text.encode()) == [ServerSentEvent(*one) for one in expected]
    assert read(*(bytes([byte]) for byte in text.encode())) == [
        ServerSentEvent(*one) for one in expected
    ]


@given(st.lists(st.binary(max_size=30), max_size=10))
def test_any_bytes_are_read_without_complaint(chunks: list[bytes]) -> None:
    read(*chunks)
