"""Remarks are gathered by kind."""

from schemas.vocabulary import View
from worker.labelmaps.findings import Finding, as_warnings


def test_one_sentence_a_kind_and_view() -> None:
    found = [Finding(View.SAX, "odd", f"t{i}") for i in range(6)]
    found += [Finding(View.LAX_2CH, "odd", "t0"), Finding(View.SAX, "even", "t0")]
    assert as_warnings(found) == [
        "sax: odd (t0, t1, t2, t3 and 2 more).",
        "lax_2ch: odd (t0).",
        "sax: even (t0).",
    ]


def test_nothing_found_says_nothing() -> None:
    assert as_warnings([]) == []
