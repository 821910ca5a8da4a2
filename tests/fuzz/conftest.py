"""One service for all fuzzing, and for the table of attacks on uploads."""

from collections.abc import Iterator

import pytest

from benchmarks.fuzzing.described import SETTINGS
from benchmarks.fuzzing.running_service import RunningService, running_service


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    with running_service(tmp_path_factory.mktemp("fuzzed") / "data", SETTINGS) as running:
        yield running
