import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.prefer import preferred_wait_s


@given(st.integers(0, 999_999_999))
def test_a_wait_is_read_wherever_it_stands(wait_s: int) -> None:
    for header in (
        [f"wait={wait_s}"],
        [f"respond-async, wait={wait_s}"],
        ["respond-async", f"Wait = {wait_s}; urgent=yes"],
        [f'wait="{wait_s}"'],
        [f'note="a, wait=7", wait={wait_s}'],
        [f"wait={wait_s}, wait=7"],
    ):
        assert preferred_wait_s(header) == wait_s


@pytest.mark.parametrize(
    "header",
    [
        "",
        "respond-async",
        "wait",
        "wait=",
        "wait=-1",
        "wait=1.5",
        "wait=ten",
        "await=5",
        'wait="5',
        "wait=1e3",
    ],
)
def test_what_cannot_be_read_is_ignored(header: str) -> None:
    assert preferred_wait_s([header]) is None


@given(st.text())
def test_any_header_has_an_answer(header: str) -> None:
    wait_s = preferred_wait_s([header])
    assert wait_s is None or wait_s >= 0


def test_a_hostile_header_costs_no_time() -> None:
    start = time.perf_counter()
    preferred_wait_s(['"' + r"\"" * 30_000])
    assert time.perf_counter() - start < 0.5
