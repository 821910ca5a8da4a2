"""A real cycle's surfaces are read as closed ones."""

from pathlib import Path

import pytest

from benchmarks.beating.fitted_cycle import fitted_cycle
from benchmarks.beating.real_cycle import GUIDE_POINTS, MODEL, guide_point_request
from benchmarks.beating.volume_curve import pump
from schemas.options import Options
from schemas.vocabulary import Structure
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import is_watertight

DATA = Path(__file__).resolve().parents[4] / "shared/data"

pytestmark = pytest.mark.skipif(
    not (DATA / MODEL).is_file(), reason=f"no real cycle at {DATA / MODEL}"
)


def test_the_surfaces_of_a_real_cycle_are_closed_and_face_outward() -> None:
    frames = fitted_cycle(DATA / MODEL)
    assert len(frames) == 25
    for mesh in frames[0].values():
        assert is_watertight(mesh)
    volumes = [volume_ml(frame[Structure.LV_ENDO]) for frame in frames]
    found = pump(volumes)
    assert found is not None
    # It is largest in the last frame, just before it begins anew.
    assert found.edv_ml == volumes[-1] > volumes[0] == pytest.approx(174.5, abs=0.1)
    assert found.esv_ml == pytest.approx(72.0, abs=0.1)


def test_guide_points_become_a_request_of_three_surfaces_and_the_frames_wanted() -> None:
    request = guide_point_request(DATA / GUIDE_POINTS, 5, Options())
    assert len(request.study.frames) == 5
    assert request.options.surfaces == [Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO]
    times = [frame.time_ms for frame in request.study.frames if frame.time_ms is not None]
    assert times == sorted(times)
