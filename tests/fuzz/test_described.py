from pathlib import Path

import pytest

from benchmarks.fuzzing.described import run_schemathesis
from benchmarks.fuzzing.running_service import RunningService

pytestmark = [pytest.mark.integration, pytest.mark.slow, pytest.mark.timeout(1800)]


def test_the_service_does_what_its_description_says_and_nothing_else(
    service: RunningService, tmp_path: Path
) -> None:
    """Schemathesis, all checks, every phase; the long run is `python -m benchmarks.fuzzing`."""
    found = run_schemathesis(service, tmp_path, examples=3)
    assert found.is_clean, found.transcript
    statuses = {status for _, status in found.answers}
    assert not {status for status in statuses if status[0] == "5"}
    succeeded = {operation for (operation, status) in found.answers if status[0] == "2"}
    described = {operation for (operation, status) in found.answers if status != "405"}
    # Good label maps are sent in test_uploads.py, good contour files in the service's own tests;
    # the tool's forms are rarely whole.
    forms = {
        f"POST /v1/{what}/{kind}" for what in ("jobs", "validate") for kind in ("labels", "files")
    }
    undone = {"GET unmatched", *forms}
    assert described - succeeded <= undone, "every operation was done, not only refused"
