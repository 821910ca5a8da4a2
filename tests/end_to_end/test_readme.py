"""The README's transcripts, typed into a real shell beside a real server.

A new user's way: README.md's `console` blocks must work as they stand.
"""

from pathlib import Path

import pytest

from tests.end_to_end.serve_process import ServeProcess
from tests.end_to_end.typed_in import ROOT, type_in

pytestmark = [pytest.mark.integration, pytest.mark.slow]


def test_the_readme_can_be_typed_in(server: ServeProcess, tmp_path: Path) -> None:
    type_in(ROOT / "README.md", server, tmp_path)
