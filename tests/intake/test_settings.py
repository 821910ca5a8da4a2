"""One set of limits, read alike by whoever admits."""

import pytest
from pydantic import ValidationError

from intake.limits import Limits
from intake.settings import LimitSettings
from service.settings import ServiceSettings
from worker.settings import WorkerSettings


def test_unset_they_are_the_defaults() -> None:
    assert LimitSettings().limits() == Limits()


def test_every_one_of_them_reaches_service_and_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in LimitSettings.model_fields:
        monkeypatch.setenv(f"NEURALMRI_{name.upper()}", "1000" if name == "max_frames" else "4321")
    service, worker = ServiceSettings().limits(), WorkerSettings().limits()
    assert service == worker == LimitSettings().limits()
    assert (worker.max_points, worker.max_frames) == (4321, 1000)
    assert worker.max_slices == Limits.max_slices


def test_a_limit_of_nothing_is_refused() -> None:
    with pytest.raises(ValidationError, match="max_points"):
        LimitSettings(max_points=0)
