import pytest

from benchmarks.fuzzing.barrage import barrage
from benchmarks.fuzzing.contour_uploads import contour_uploads
from benchmarks.fuzzing.label_uploads import label_uploads
from benchmarks.fuzzing.running_service import RunningService
from benchmarks.fuzzing.science import Science

pytestmark = [pytest.mark.integration, pytest.mark.slow]


def test_no_spoilt_study_breaks_the_service_or_its_worker(service: RunningService) -> None:
    science = Science(every=8)
    tally = barrage(service, contour_uploads(), examples=100, accepted=science)
    assert {"202 accepted", "400 malformed-json", "413 too-large"} <= set(tally.answers)
    assert science.outcomes["succeeded"] > 0


def test_no_spoilt_label_map_breaks_the_service_or_its_worker(service: RunningService) -> None:
    science = Science(every=3)
    tally = barrage(service, label_uploads(), examples=100, accepted=science)
    assert {"202 accepted", "400 invalid-request", "422 unreadable-label-map"} <= set(tally.answers)
    assert science.outcomes["succeeded"] > 0
