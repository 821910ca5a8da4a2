"""The code's name is the same in every process, and another for another thread count."""

import re

from worker.code_version import code_version


def test_it_names_code_and_threads() -> None:
    assert re.fullmatch("[0-9a-f]{64}", code_version(1))
    assert code_version(1) == code_version(1) != code_version(2)
