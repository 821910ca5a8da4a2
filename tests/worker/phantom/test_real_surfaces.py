"""Sections of fitted heart surfaces against contours that were cut from them independently."""

import json
from pathlib import Path

import numpy as np
import pytest

from schemas.study import ContourStudy
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.section import section
from worker.mesh_file import read_surface
from worker.phantom.outline import enclosed_mm2

CASES = Path(__file__).parents[4] / "shared" / "data" / "cases"
NAMES = sorted(path.parent.name for path in CASES.glob("*/contours.json"))


@pytest.mark.parametrize("name", NAMES or [pytest.param("", marks=pytest.mark.skip(f"no {CASES}"))])
def test_sections_are_the_contours_given(name):
    study = ContourStudy.model_validate_json((CASES / name / "contours.json").read_text())
    surfaces = {
        path.stem: read_surface(path) for path in (CASES / name / "reference").glob("*.ply")
    }
    shifts_file = CASES / name / "true_shifts_mm.json"
    shifts = json.loads(shifts_file.read_text()) if shifts_file.exists() else {}
    compared = 0
    for one in study.frames[0].slices:
        shift = np.array(shifts.get(one.id, [0.0, 0.0, 0.0]))
        for structure, mesh in surfaces.items():
            given = [np.array(c.points) - shift for c in one.contours if c.structure == structure]
            loops = section(mesh, np.array(one.origin) - shift, np.array(one.normal))
            for points in given:
                assert points_to_surface_mm(points, mesh).max() < 1e-3
            areas = sorted(enclosed_mm2(points) for points in given)
            # What has no more than a few mm2 was left out of the contours given.
            own = sorted(enclosed_mm2(loop) for loop in loops)[len(loops) - len(given) :]
            assert own == pytest.approx(areas, rel=0.01, abs=1.0)
            assert sum(enclosed_mm2(loop) for loop in loops) - sum(own) < 10.0
            compared += len(given)
    assert compared > 20
