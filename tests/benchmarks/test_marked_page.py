"""A table lands between its marks, and nothing else moves."""

from pathlib import Path

import pytest

from benchmarks.marked_page import write_between_marks


def test_only_what_is_between_the_marks_changes(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- t -->\nold\n<!-- /t -->\nb\n<!-- u -->\n<!-- /u -->\n")
    for _ in range(2):
        write_between_marks(page, "t", r"new \1")
        assert page.read_text() == (
            "a\n<!-- t -->\n\nnew \\1\n\n<!-- /t -->\nb\n<!-- u -->\n<!-- /u -->\n"
        )


def test_a_page_without_the_marks_is_refused(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("a\n")
    with pytest.raises(ValueError, match="0 places for t"):
        write_between_marks(page, "t", "new")
